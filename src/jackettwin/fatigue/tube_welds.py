r"""Welds around tubes: butt welds where walls change, and details of the user's own.

.. math::

    K = 1 + \frac{6 (δ_t + δ_m - δ_0)}{t} \frac{e^{-α}}{1 + (T/t)^β}, \qquad
    α = \frac{1.82 L}{\sqrt{Dt}} \frac{1}{1 + (T/t)^β}, \qquad
    β = 1.5 - \frac{1}{\log_{10}(D/t)} + \frac{3}{(\log_{10}(D/t))^2}

of tubular butt welds with the walls t and T ≥ t, after DNV-RP-C203 section 3.3.7.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from math import exp, log10, sqrt
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import did_you_mean, require, require_between
from jackettwin.fatigue.weld_life import ModelsAtHeight
from jackettwin.structure import PILES, Assembly, Member, Section, SectionForces, Structure

TUBE_POSITIONS = ("0°", "45°", "90°", "135°", "180°", "225°", "270°", "315°")
"""Around a tube, from the y of its local axes to z."""
BUTT_WELD = "butt weld"
_IN_LINE = -np.cos(np.radians(5.0))
_THICKEST = 2.0
"""T/t up to which the formula holds."""
_FLUSH_M = 2e-3
"""Rounding of diameters of tubes that are flush outside or inside."""


@dataclass(frozen=True)
class Detail:
    """A detail that the user names.

    Attributes
    ----------
    name, member : str
    position : float
        Share of the member's length from its start, 0 to 1.
    scf : float
        Hot-spot stress over the tube's nominal stress.
    models : S-N curves by elevation
    """

    name: str
    member: str
    position: float
    scf: float
    models: ModelsAtHeight


@dataclass(frozen=True)
class TubeDetails:
    """Welds around tubes, other than tubular joints, that are assessed.

    Attributes
    ----------
    models : S-N curves of butt welds by elevation
    misalignment_m : float
        δ_m − δ_0: what the walls of butt welds are out of line beyond the tests of the curve.
    own : details of the user's own
    file : where they are named
    """

    models: ModelsAtHeight
    misalignment_m: float = 0.0
    own: tuple[Detail, ...] = ()
    file: Path | None = None

    def require_members(self, structure: Structure) -> None:
        """Refuse details of tubes that a structure does not have.

        Raises
        ------
        InputError
            Names the file, the detail and the member that is likely meant.
        """
        names = [member.name for member in structure.members]
        for i, one in enumerate(self.own):
            require(
                one.member in names, "is no member of the structure", file=self.file,
                field=f"details.{i}.member", value=one.member,
                remedy=did_you_mean(one.member, names) or "name one of its tubes",
            )  # fmt: skip


@dataclass(frozen=True)
class TubeWeld:
    """A weld around a tube.

    Attributes
    ----------
    name, kind, member : str
    position : share of the member's length from its start
    section : of the tube there, the thinner one of two
    z_m : elevation in the structure's frame
    scf : float
    models : S-N curves by elevation
    element, share : of the mesh, and how far along it
    warnings : what lies outside the range of the factor
    """

    name: str
    kind: str
    member: str
    position: float
    section: Section
    z_m: float
    scf: float
    models: ModelsAtHeight
    element: int
    share: float
    warnings: tuple[str, ...] = ()

    @property
    def doubts(self) -> tuple[str, ...]:
        """The warnings: outside its range a factor may be too small."""
        return self.warnings

    def stress(self, forces: SectionForces) -> FloatArray:
        """Return stresses (8 points, n) [Pa] under section forces (n, n_elements, 2), linear in them.

        σ = K (N/A + M_y z/I − M_z y/I) on the outer surface.
        """
        D, d = self.section.outer_diameter_m, self.section.outer_diameter_m - 2.0 * self.section.thickness_m
        area, modulus = 0.25 * np.pi * (D**2 - d**2), np.pi * (D**4 - d**4) / (32.0 * D)
        angle = np.arange(8) * 0.25 * np.pi
        per_force = np.stack(
            [np.full(8, 1.0 / area), np.sin(angle) / modulus, -np.cos(angle) / modulus], axis=1
        )
        ends = np.array([1.0 - self.share, self.share])
        there = [f[:, self.element] @ ends for f in (forces.axial, forces.bending_y, forces.bending_z)]
        return np.asarray(self.scf * per_force @ np.array(there))


def butt_weld_factor(
    diameter_m: float, t_m: float, T_m: float, offset_m: float, length_m: float = 0.0
) -> float:
    """Return the stress concentration of a tubular butt weld, on the side of the thinner wall.

    Parameters
    ----------
    t_m, T_m : the thinner and the thicker wall
    offset_m : δ_t + δ_m − δ_0 of the walls' middle surfaces
    length_m : L over which the thickness changes; zero is on the safe side

    Raises
    ------
    InputError
        If a wall is not positive, or t exceeds T.
    """
    require_between("t_m", t_m, 1e-4, T_m)
    require_between("diameter_m", diameter_m, 2.0 * t_m, 1e3)
    slender = log10(diameter_m / t_m)
    share = 1.0 / (1.0 + float((T_m / t_m) ** (1.5 - 1.0 / slender + 3.0 / slender**2)))
    alpha = 1.82 * length_m / sqrt(diameter_m * t_m) * share
    return 1.0 + 6.0 * max(offset_m, 0.0) / t_m * share * exp(-alpha)


def tube_welds(assembly: Assembly, details: TubeDetails) -> tuple[tuple[TubeWeld, ...], tuple[str, ...]]:
    """Return the welds around a structure's tubes, and the nodes where walls do not meet.

    Butt welds stand where two members in line have other sections at their node, and along piles that are
    members at each of their nodes, as a pile's girth welds may be at any depth. Where the walls there miss
    each other, plates or a cone that the model does not know must join them: such nodes are named instead.

    Raises
    ------
    InputError
        If a detail names no member.
    """
    structure = assembly.structure
    details.require_members(structure)
    found, apart = [], []
    for node, pair in _changes(structure):
        (thin, at), (thick, other) = sorted(pair, key=lambda end: _wall(*end))
        near, far = _section(thin, at), _section(thick, other)
        offset = abs(_middle_radius(near) - _middle_radius(far))
        if offset >= 0.5 * (near.thickness_m + far.thickness_m):
            apart.append(node)
            continue
        t, T = near.thickness_m, far.thickness_m
        factor = butt_weld_factor(near.outer_diameter_m, t, T, offset + details.misalignment_m)
        beyond = tuple(_beyond(t, T, offset))
        name = f"{thin.name} to {thick.name}"
        found.append(_weld(assembly, name, BUTT_WELD, thin, at, factor, details.models, beyond))
    for pile in (member for member in structure.members if member.part == PILES):
        diameter, t = pile.section_start.outer_diameter_m, pile.section_start.thickness_m
        factor = butt_weld_factor(diameter, t, t, details.misalignment_m)
        found.append(_weld(assembly, f"girth at {pile.start}", BUTT_WELD, pile, 0.0, factor, details.models))
    members = {member.name: member for member in structure.members}
    for one in details.own:
        member = members[one.member]
        found.append(_weld(assembly, one.name, "detail", member, one.position, one.scf, one.models))
    return tuple(found), tuple(apart)


def _weld(
    assembly: Assembly,
    name: str,
    kind: str,
    member: Member,
    position: float,
    scf: float,
    models: ModelsAtHeight,
    warnings: tuple[str, ...] = (),
) -> TubeWeld:
    structure = assembly.structure
    pieces = np.flatnonzero(assembly.mesh.member == structure.members.index(member))
    piece = min(int(position * pieces.size), pieces.size - 1)
    z = (1.0 - position) * structure.nodes[member.start][2] + position * structure.nodes[member.end][2]
    return TubeWeld(
        name, kind, member.name, position, _section(member, position), z, scf, models, int(pieces[piece]),
        position * pieces.size - piece, warnings,
    )  # fmt: skip


def _changes(structure: Structure) -> Iterator[tuple[str, tuple[tuple[Member, float], tuple[Member, float]]]]:
    """Yield the nodes where two members in line have other sections, with (member, position) of both."""
    ends: dict[str, list[tuple[Member, float]]] = {}
    for member in structure.members:
        ends.setdefault(member.start, []).append((member, 0.0))
        ends.setdefault(member.end, []).append((member, 1.0))
    for node, here in ends.items():
        for a, b in combinations(here, 2):
            in_line = float(_away(structure, *a) @ _away(structure, *b)) < _IN_LINE
            if in_line and _section(*a) != _section(*b):
                yield node, (a, b)


def _away(structure: Structure, member: Member, position: float) -> FloatArray:
    along = np.subtract(structure.nodes[member.end], structure.nodes[member.start])
    return np.asarray((1.0 - 2.0 * position) * along / np.linalg.norm(along))


def _section(member: Member, position: float) -> Section:
    a, b = member.section_start, member.section_end
    return Section(
        (1.0 - position) * a.outer_diameter_m + position * b.outer_diameter_m,
        (1.0 - position) * a.thickness_m + position * b.thickness_m,
    )


def _wall(member: Member, position: float) -> tuple[float, float]:
    section = _section(member, position)
    return section.thickness_m, section.outer_diameter_m


def _middle_radius(section: Section) -> float:
    return 0.5 * (section.outer_diameter_m - section.thickness_m)


def _beyond(t_m: float, T_m: float, offset_m: float) -> Iterator[str]:
    if T_m > _THICKEST * t_m:
        yield f"T/t = {T_m / t_m:.3g} above {_THICKEST:g}"
    if offset_m > 0.5 * (T_m - t_m) + _FLUSH_M:
        yield "neither outside nor inside is flush: too much if the step is a taper's in the model"
