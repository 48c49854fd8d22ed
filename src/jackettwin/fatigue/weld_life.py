"""The worst point of every weld: from the cycles at each of its points to damage and life."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.fatigue.curves import Environment
from jackettwin.fatigue.cycles import Cycles
from jackettwin.fatigue.hot_spots import POSITIONS, SIDES
from jackettwin.fatigue.joint_life import HotSpot
from jackettwin.fatigue.life import LifeModel, SpotLife
from jackettwin.structure import Structure

ModelsAtHeight = Callable[[float], tuple[Environment, LifeModel]]
"""From an elevation above the sea [m] to what corrodes a weld there, and its curve."""


@dataclass(frozen=True)
class WeldLife:
    """The worst of the eight points on one side of a weld.

    Attributes
    ----------
    weld : HotSpot
    side : str
        Chord or brace.
    position : str
        The point, counted from the crown.
    z_m : float
        Elevation of the node in the structure's frame.
    environment : str
    damage_by_point : (8,) by the design curve
    largest_range_pa : float
    life : SpotLife
    """

    weld: HotSpot
    side: str
    position: str
    z_m: float
    environment: Environment
    damage_by_point: FloatArray
    largest_range_pa: float
    life: SpotLife

    @property
    def place(self) -> tuple[str, str, str]:
        """Node, brace and side of the weld."""
        return self.weld.node, self.weld.brace, self.side


def weld_lives(
    structure: Structure,
    welds: Sequence[HotSpot],
    cycles: Sequence[Sequence[Sequence[Cycles]]],
    duration_s: float,
    models: ModelsAtHeight,
    *,
    times: int = 1,
    others: Sequence[dict[str, FloatArray]] | None = None,
) -> tuple[WeldLife, ...]:
    """Return the life of both sides of every weld, shortest first.

    Parameters
    ----------
    cycles : for every weld, (2 sides, 8 points) cycles
    times : how often the cycles tell the time over
    others : for every weld, {source: variance of ln D (2, 8)}
    """
    found = []
    for i, (weld, counted) in enumerate(zip(welds, cycles, strict=True)):
        z = structure.nodes[weld.node][2]
        environment, model = models(z - structure.sea_level_z_m)
        for k, (side, points, thickness) in enumerate(zip(SIDES, counted, weld.thickness_m, strict=True)):
            beside = [
                {} if others is None else {n: float(v[k, p]) for n, v in others[i].items()} for p in range(8)
            ]
            worst, damage, largest, life = worst_point(
                model, points, duration_s, thickness, beside, times=times
            )
            found.append(WeldLife(weld, side, POSITIONS[worst], z, environment, damage, largest, life))
    return tuple(sorted(found, key=lambda one: one.life.life_years))


def worst_point(
    model: LifeModel,
    points: Sequence[Cycles],
    duration_s: float,
    thickness_m: float,
    others: Sequence[dict[str, float]],
    *,
    times: int = 1,
) -> tuple[int, FloatArray, float, SpotLife]:
    """Return the point with most damage, the damage of all, its largest range [Pa] and its life.

    Parameters
    ----------
    others : for every point, {source: variance of ln D}
    """
    lives = [
        model.life(c, duration_s, thickness_m, times=times, others=more)
        for c, more in zip(points, others, strict=True)
    ]
    damage = np.array([life.damage for life in lives])
    worst = int(np.argmax(damage))
    return worst, damage, float(points[worst].ranges.max(initial=0.0)), lives[worst]
