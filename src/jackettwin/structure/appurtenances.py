"""What hangs on the legs of a parametric jacket and carries nothing, as point masses on its leg nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.errors import InputError
from jackettwin.structure.model import PointMass, Structure

FURTHEST_M = 20.0
"""How far beyond the legs' ends an appurtenance may lie [m]: a boat landing, not a slip of the pen."""


def hung_on_legs(
    structure: Structure, name: str, mass_kg: float, bottom_z_m: float, top_z_m: float, legs: Sequence[int]
) -> tuple[PointMass, ...]:
    """Return a mass spread evenly along the height between two levels, and over some legs.

    Every leg's share goes to its nodes so that mass and centre of gravity are kept where the span lies
    between the leg's ends: each slice is carried by the nodes above and below it, as by a lever.

    Parameters
    ----------
    legs : sequence of int
        From 1; empty is all.

    Raises
    ------
    InputError
        If the span is reversed or far from the legs, or there is no such leg.
    """
    if not bottom_z_m <= top_z_m:
        raise InputError(
            "levels are reversed",
            field="bottom_z_m",
            value=bottom_z_m,
            allowed=f"up to top_z_m = {top_z_m:g}",
        )
    every = _legs(structure)
    unknown = [leg for leg in legs if leg > len(every)]
    if unknown:
        raise InputError("no such leg", field="legs", value=unknown[0], allowed=f"1 to {len(every)}")
    chosen = [every[leg - 1] for leg in legs] or every
    masses: list[PointMass] = []
    for nodes in chosen:
        z = np.array([structure.nodes[node][2] for node in nodes])
        if bottom_z_m > z[-1] + FURTHEST_M or top_z_m < z[0] - FURTHEST_M:
            raise InputError(
                "lies beyond the legs",
                field="bottom_z_m",
                value=(bottom_z_m, top_z_m),
                allowed=f"levels from {z[0]:g} to {z[-1]:g} m",
                remedy="give z in the structure's own frame",
            )
        slices = np.clip(np.linspace(bottom_z_m, top_z_m, 201), z[0], z[-1])
        # a linear hat on each node: the lever rule
        shares = np.array([np.interp(slices, z, row).mean() for row in np.eye(len(z))])
        masses += [
            PointMass(node, float(share) * mass_kg / len(chosen), part=name)
            for node, share in zip(nodes, shares, strict=True)
            if share > 0.0
        ]
    return tuple(masses)


def _legs(structure: Structure) -> list[list[str]]:
    """Return the nodes of every leg from the foot up."""
    feet = [node for node in structure.nodes if node.startswith("foot_")]
    return [
        [foot, *(node for node in structure.nodes if node.startswith(f"leg_{foot.removeprefix('foot_')}_"))]
        for foot in feet
    ]
