"""Modes of a structure as it stands, in the order of those it had before a change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.change.changed_structures import Standing
from jackettwin.errors import NumericalError
from jackettwin.response import (
    LOCAL,
    OnSprings,
    System,
    UndampedModes,
    aligned,
    build_system,
    mode_kinds,
    mode_labels,
    principal_direction,
    track_modes,
    undamped_modes,
)
from jackettwin.soil import Spring, Support
from jackettwin.structure import Assembly

MODES = 8
"""Number of modes of the model."""
COMPUTED = MODES + 6
"""Number of modes among which those are looked for after a change."""
NEAR = COMPUTED + 4
"""Number of shapes of a similar structure in a basis, of which the last ones are only guards."""
EXACT = 1e-7
"""Relative error of ω² up to which modes in a basis are taken: a share of energy is then known to about its
square root, 1e-4, a hundredth of the ground's share in bending."""


@dataclass(frozen=True)
class Modes:
    """Modes of a structure, in the order of another's.

    ``soil_share`` is the share of the strain energy in the ground, ``kept`` that of the kinetic energy in the
    other's modes of the whole structure; ``direction`` is the horizontal one of most motion [rad], from x
    towards y. Modes with members of their own begin with ``local``.
    """

    labels: tuple[str, ...]
    modes: UndampedModes
    mass: Any
    soil_share: FloatArray
    kept: FloatArray
    direction: FloatArray

    @classmethod
    def of(cls, standing: Standing, assembly: Assembly, like: Modes | None = None) -> Modes:
        """Return the modes of an assembled structure on its feet, named by kind, or in another's order."""
        system = on_feet(standing, assembly)
        if like is not None:
            return cls._followed(standing, assembly, undamped_modes(system, COMPUTED), like)
        modes = undamped_modes(system, MODES)
        labels = mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))
        return cls._named(standing, assembly, modes, labels, np.ones(MODES))

    @classmethod
    def of_each(
        cls, stands: Sequence[Standing], assembly: Assembly, like: Sequence[Modes], near: FloatArray
    ) -> list[Modes]:
        """Return the modes on feet of several stiffnesses, each in its own other's order.

        Parameters
        ----------
        near : (n_dof, k) shapes of a similar structure on similar feet; where they are too far from those
            to be found, every modes are solved by themselves
        """
        try:
            return cls._of_each(stands, assembly, like, near)
        except NumericalError:
            return [cls.of(s, assembly, before) for s, before in zip(stands, like, strict=True)]

    @classmethod
    def _of_each(
        cls, stands: Sequence[Standing], assembly: Assembly, like: Sequence[Modes], near: FloatArray
    ) -> list[Modes]:
        springs = np.stack([feet_stiffness(standing) for standing in stands])
        dofs = feet_dofs(stands[0], assembly)
        whole = OnSprings(assembly.stiffness, assembly.mass, dofs, springs, near)
        found = []
        for standing, stiffness, before in zip(stands, springs, like, strict=True):
            omega, shapes = whole.modes(stiffness, COMPUTED)
            one = cls._followed(
                standing, assembly, UndampedModes(omega, aligned(assembly, omega, shapes)), before
            )
            if np.max(whole.error(stiffness, one.modes.omega, one.modes.shapes)) > EXACT:
                one = cls.of(standing, assembly, before)
            found.append(one)
        return found

    @classmethod
    def _followed(cls, standing: Standing, assembly: Assembly, modes: UndampedModes, like: Modes) -> Modes:
        order = track_modes(like.mass, like.modes.omega, like.modes.shapes, modes.shapes)
        order = np.where(order < 0, np.arange(MODES), order)
        modes = UndampedModes(modes.omega[order], modes.shapes[:, order])
        return cls._named(standing, assembly, modes, like.labels, kept_share(like, modes.shapes))

    @classmethod
    def _named(
        cls,
        standing: Standing,
        assembly: Assembly,
        modes: UndampedModes,
        labels: tuple[str, ...],
        kept: FloatArray,
    ) -> Modes:
        at_feet = modes.shapes[feet_dofs(standing, assembly)]
        share = feet_stiffness(standing) @ at_feet**2 / modes.omega**2
        moved = (assembly.expand @ modes.shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
        ways = np.array([principal_direction(moved[:, :2, q])[0] for q in range(len(modes.omega))])
        return cls(labels, modes, assembly.mass, share, kept, ways)


def on_feet(standing: Standing, assembly: Assembly) -> System:
    """Return an assembled structure on its feet."""
    feet = zip(standing.structure.reaction_nodes, _by_foot(standing), strict=True)
    return build_system(assembly, Support(tuple(Spring(node, np.diag(k)) for node, k in feet)))


def feet_dofs(standing: Standing, assembly: Assembly) -> IntArray:
    """Return the DOFs of the feet on which there is stiffness, (n_springs,)."""
    dofs = np.stack([assembly.dofs(node) for node in standing.structure.reaction_nodes])
    return np.asarray(dofs[_by_foot(standing) > 0.0])


def feet_stiffness(standing: Standing) -> FloatArray:
    """Return the stiffness on those [N/m, Nm/rad]."""
    every = _by_foot(standing)
    return every[every > 0.0]


def _by_foot(standing: Standing) -> FloatArray:
    """Return the stiffness of every foot along and about x, y and z, (n_feet, 6)."""
    h, v, turned = standing.horizontal, standing.vertical, standing.rocking
    return np.stack([h, h, v, turned, turned, turned], axis=1)


def kept_share(like: Modes, shapes: FloatArray) -> FloatArray:
    """Return the share of each shape's kinetic energy in another's modes of the whole structure, (n,)."""
    whole = like.modes.shapes[:, [not name.startswith(LOCAL) for name in like.labels]]
    moving = like.mass @ shapes
    return np.asarray(np.sum((whole.T @ moving) ** 2, axis=0) / np.einsum("im,im->m", shapes, moving))
