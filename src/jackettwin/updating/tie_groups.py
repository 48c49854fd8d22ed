"""Tie groups: DOFs of feet that share parameters of the law, and their proportions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError, require
from jackettwin.soil import (
    MUDLINE,
    MUDLINE_PATTERNS,
    MUDLINE_SUFFIXES,
    Family,
    Law,
    Parameter,
    Spring,
    Support,
    moved_to_mudline,
    mudline_exponents,
    mudline_parameters,
    on_mudline,
    pinned,
    standing,
    sway_and_rocking,
)
from jackettwin.structure import Structure

Group = tuple[tuple[int, ...], tuple[str, ...]]
"""The DOFs and the feet that share parameters."""

SPLIT_LEGS = "per-leg-horizontal-vertical"
TIES = ("all", "horizontal-vertical", "per-leg", SPLIT_LEGS, MUDLINE)
_HORIZONTAL, _VERTICAL = (0, 1, 3, 4, 5), (2,)
"""Groups of a pile head's motions: horizontal translations with rotations, and vertical translation."""
SIDES = {"_horizontal": _HORIZONTAL, "_vertical": _VERTICAL}
_EVERY = (0, 1, 2, 3, 4, 5)
_TRANSLATIONS = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


_STIFFNESS_LOG_STD, _LOSS_LOG_STD = 0.7, 1.0
"""Uncertainty of the design's stiffness and loss factor: standard deviations of ln θ."""


@dataclass(frozen=True)
class TieGroups:
    """Patterns of the tie groups: the stiffness of a foot is D of a group times the pattern.

    Attributes
    ----------
    suffixes : suffix of each group's parameters
    patterns : (group, node, 6×6) pattern of every foot
    sides : ``_horizontal`` or ``_vertical`` for each group if every leg is split into both; else empty
    stiffness : (n_groups,) storage stiffness [N/m] of each group in the support that defines the patterns;
        None for plain translations
    loss_factor : loss factor of that support at the reference frequency
    masses : (node, 6×6) masses that move with the feet
    one_loss : whether each group has its own stiffness and the law's other parameters are common, as for the
        two groups at the mudline, sway and rocking
    """

    suffixes: tuple[str, ...]
    patterns: tuple[tuple[int, str, FloatArray], ...]
    sides: tuple[str, ...]
    stiffness: tuple[float, ...] | None = None
    loss_factor: tuple[float, ...] | None = None
    masses: tuple[tuple[str, FloatArray], ...] = ()
    one_loss: bool = False

    def parameters(self, family: Family) -> dict[Parameter, tuple[str, str]]:
        """Return the parameters of a law on all groups, with the law's own name of each and the side."""
        if self.one_loss:
            sway, rocking, *others = mudline_parameters(family)
            return {p: (family.names[0], "") for p in (sway, rocking)} | {p: (p.name, "") for p in others}
        pairs = zip(self.suffixes, self.sides, strict=True)
        return {
            replace(p, name=p.name + suffix): (p.name, side)
            for suffix, side in pairs
            for p in family.parameters
        }

    def exponents(self, family: Family) -> FloatArray:
        """Return the exponents of the parameters in the laws' coefficients, (n_groups · p, n_parameters)."""
        return (
            mudline_exponents(family)
            if self.one_loss
            else np.eye(len(self.suffixes) * len(family.parameters))
        )

    def support(self, laws: list[Law]) -> Support:
        """Return the support with one law per group."""
        if self.one_loss and self.stiffness is None:
            return on_mudline(self.patterns[0][1], laws)
        springs = tuple(Spring(node, pattern, laws[g]) for g, node, pattern in self.patterns)
        return Support(springs=springs, masses=self.masses)


def tie_groups(
    structure: Structure, tie: str, *, heads: Support | None = None, reference_hz: float | None = None
) -> TieGroups:
    """Return the tie groups of a structure's feet.

    Parameters
    ----------
    tie : one of ``TIES``
    heads : Support, optional
        Pile heads whose 6×6 storage stiffness at ``reference_hz`` the laws scale: a law's stiffness is then
        that of the head along its axis (horizontal for ``_horizontal``), with all entries in proportion. By
        default the laws act on the three translations.

    Raises
    ------
    InputError
        If the tie is unknown, there are no reaction nodes, the heads fix a foot or leave it free, or there
        are none for a structure that would be unstable.
    """
    require(tie in TIES, "unknown tie", field="support.tie", value=tie, allowed=", ".join(TIES))
    require(structure.reactions, "no reaction nodes to support", field="structure.reaction_nodes", value=[])
    if tie == MUDLINE:
        return _at_mudline(structure, heads, reference_hz or 1.0)
    if heads is None and standing(structure) != pinned(structure):
        raise InputError(
            "a structure on one foot, or on feet in a line, is unstable on springs without rotational "
            "stiffness",
            field="support.stiffness",
            remedy="give a foundation or a support file whose 6×6 stiffness the laws scale",
        )
    nodes = structure.reaction_nodes
    groups: dict[str, Group] = {"": (_EVERY, nodes)}
    if tie == "per-leg":
        groups = {f"_{node}": (_EVERY, (node,)) for node in nodes}
    elif tie == "horizontal-vertical":
        groups = {suffix: (dofs, nodes) for suffix, dofs in SIDES.items()}
    elif tie == SPLIT_LEGS:
        groups = {f"_{node}{side}": (dofs, (node,)) for node in nodes for side, dofs in SIDES.items()}
    plain = TieGroups(
        tuple(groups),
        tuple(
            (g, node, _part(_TRANSLATIONS, dofs))
            for g, (dofs, members) in enumerate(groups.values())
            for node in members
        ),
        sides=tuple(side for _ in nodes for side in SIDES) if tie == SPLIT_LEGS else ("",) * len(groups),
    )
    return plain if heads is None else _on_heads(plain, list(groups.values()), heads, reference_hz or 1.0)


def priors_of(groups: TieGroups, reference_hz: float) -> dict[str, tuple[float, float]]:
    """Return lognormal priors (median, standard deviation of ln θ) from the heads that define the patterns.

    Linearised p-y and t-z curves differ from the small-strain stiffness by a factor of two or three, and from
    the loss by more.
    """
    priors: dict[str, tuple[float, float]] = {}
    if groups.stiffness is None or groups.loss_factor is None:
        return priors
    for suffix, k, loss in zip(groups.suffixes, groups.stiffness, groups.loss_factor, strict=True):
        priors |= {f"{name}{suffix}": (k, _STIFFNESS_LOG_STD) for name in ("k", "k0")}
        if groups.one_loss and suffix:
            if suffix != groups.suffixes[0]:
                continue  # the loss factor of sway is used for both
            suffix = ""
        if loss > 0.0:
            alpha = 2.0 / pi * float(np.arctan(loss))
            c = loss * k / (2.0 * pi * reference_hz)
            lossy = {"loss_factor": loss, "alpha": alpha, "c": c}
            priors |= {f"{name}{suffix}": (value, _LOSS_LOG_STD) for name, value in lossy.items()}
    return priors


def _at_mudline(structure: Structure, heads: Support | None, reference_hz: float) -> TieGroups:
    """Return the groups for sway and rocking of the one node at the mudline.

    Raises
    ------
    InputError
        If the structure has several feet, or the heads do not support the node.
    """
    nodes = structure.reaction_nodes
    require(
        len(nodes) == 1,
        "one matrix at the mudline supports one node",
        field="structure.reaction_nodes",
        value=list(nodes),
        remedy="jackettwin.soil.tied_at_mudline ties the feet to one",
    )
    plain = TieGroups(
        MUDLINE_SUFFIXES,
        tuple((g, nodes[0], pattern) for g, pattern in enumerate(MUDLINE_PATTERNS)),
        sides=("", ""),
        one_loss=True,
    )
    if heads is None:
        return plain
    heads = moved_to_mudline(structure, heads)
    parts = sway_and_rocking(_impedance(plain, heads, reference_hz)[nodes[0]])
    sizes = [complex(np.mean(np.diag(part)[i : i + 2])) for part, i in zip(parts, (0, 3), strict=True)]
    require(
        sizes[1].real > 0.0,
        "this support has no rotational stiffness at the mudline",
        field="support.stiffness",
        value=sizes[1].real,
        allowed="a rocking stiffness above 0",
        remedy="a foundation, or a support file with 6×6 stiffness",
    )
    real = (part.real / size.real for part, size in zip(parts, sizes, strict=True))
    return replace(
        plain,
        patterns=tuple((g, nodes[0], pattern) for g, pattern in enumerate(real)),
        stiffness=tuple(size.real for size in sizes),
        loss_factor=tuple(size.imag / size.real for size in sizes),
        masses=heads.masses,
    )


def _on_heads(plain: TieGroups, groups: list[Group], heads: Support, reference_hz: float) -> TieGroups:
    K = _impedance(plain, heads, reference_hz)
    stiffness, loss, patterns = [], [], []
    for g, (dofs, members) in enumerate(groups):
        along = [2] if 2 in dofs else [0, 1]
        mean = np.mean([K[node][i, i] for node in members for i in along])
        stiffness.append(float(mean.real))
        loss.append(float(mean.imag / mean.real))
        patterns += [(g, node, _part(K[node].real, dofs) / mean.real) for node in members]
    return replace(
        plain,
        patterns=tuple(patterns),
        stiffness=tuple(stiffness),
        loss_factor=tuple(loss),
        masses=heads.masses,
    )


def _impedance(plain: TieGroups, heads: Support, reference_hz: float) -> dict[str, ComplexArray]:
    """Return the 6×6 complex stiffness of every foot at a frequency."""
    nodes = {node for _, node, _ in plain.patterns}
    K = {node: np.zeros((6, 6), complex) for node in nodes}
    for spring in heads.springs:
        if spring.node in K:
            K[spring.node] += spring.law.stiffness(2j * np.pi * reference_hz) * spring.matrix
    for node in sorted(nodes):
        if not (np.diag(K[node])[:3].real > 0.0).all():
            raise InputError(
                "this support has no stiffness that a law could scale",
                field="support.stiffness",
                value=node,
                allowed="springs on the translations of every reaction node",
                remedy="a foundation, or a support file with 6×6 stiffness",
            )
    return K


def _part(K: FloatArray, dofs: tuple[int, ...]) -> FloatArray:
    part = np.zeros((6, 6))
    part[np.ix_(dofs, dofs)] = K[np.ix_(dofs, dofs)]
    return part
