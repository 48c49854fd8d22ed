"""Appurtenances on the legs of a jacket, which have mass but carry no load: boat landings, anodes.

The class is what a structure file gives under ``jacket.appurtenances``, key by key.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from jackettwin.errors import require
from jackettwin.structure.model import PointMass, Structure

FURTHEST_M = 20.0
"""Largest distance of an appurtenance beyond the legs' ends [m], enough for a boat landing."""


@dataclass(frozen=True)
class Appurtenance:
    """A mass that carries nothing, even along the height between two levels: boat landing, anodes, growth.

    ``legs`` on which it hangs count from 1; empty is all.
    """

    mass_kg: Annotated[float, Field(ge=0.0, le=1e9)]
    bottom_z_m: float
    top_z_m: float
    legs: tuple[Annotated[int, Field(ge=1)], ...] = ()

    def __post_init__(self) -> None:
        low, high = self.bottom_z_m, f"up to top_z_m = {self.top_z_m:g}"
        require(low <= self.top_z_m, "levels are reversed", field="bottom_z_m", value=low, allowed=high)

    def on(self, structure: Structure, name: str) -> list[PointMass]:
        """Return its masses on the leg nodes of a jacket.

        Every leg's share goes to its nodes so that mass and centre of gravity are kept where the span lies
        between the leg's ends: each slice is carried by the nodes above and below it, as by a lever.

        Raises
        ------
        InputError
            If the span is far from the legs, or there is no such leg.
        """
        every = _legs(structure)
        unknown = next((leg for leg in self.legs if leg > len(every)), None)
        require(unknown is None, "no such leg", field="legs", value=unknown, allowed=f"1 to {len(every)}")
        chosen = [every[leg - 1] for leg in self.legs] or every
        masses: list[PointMass] = []
        for nodes in chosen:
            z = np.array([structure.nodes[node][2] for node in nodes])
            require(
                self.bottom_z_m <= z[-1] + FURTHEST_M and self.top_z_m >= z[0] - FURTHEST_M,
                "lies beyond the legs",
                field="bottom_z_m",
                value=(self.bottom_z_m, self.top_z_m),
                allowed=f"levels from {z[0]:g} to {z[-1]:g} m",
                remedy="give z in the structure's own frame",
            )
            slices = np.clip(np.linspace(self.bottom_z_m, self.top_z_m, 201), z[0], z[-1])
            # a linear hat on each node: the lever rule
            shares = np.array([np.interp(slices, z, row).mean() for row in np.eye(len(z))])
            masses += [
                PointMass(node, float(share) * self.mass_kg / len(chosen), part=name)
                for node, share in zip(nodes, shares, strict=True)
                if share > 0.0
            ]
        return masses


def _legs(structure: Structure) -> list[list[str]]:
    """Return the nodes of every leg from the foot up."""
    feet = [node for node in structure.nodes if node.startswith("foot_")]
    return [
        [foot, *(node for node in structure.nodes if node.startswith(f"leg_{foot.removeprefix('foot_')}_"))]
        for foot in feet
    ]
