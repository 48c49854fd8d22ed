"""What a pile can carry: along its axis by summed friction and bearing, across it by pushing it over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.pushover import LoadedPile, push
from jackettwin.soil.piles.reaction_curves import PileCurves

FAILED_AT = 0.1
"""Head displacement in pile diameters that counts as failure: a tenth, as pile tests are read."""
_BISECTIONS = 12
"""Of the ultimate load between a load that stands and one that fails: 0.02 % of it."""


@dataclass(frozen=True)
class AxialCapacity:
    """Ultimate loads along a pile [N]: of its shaft, of its tip; what pulls it out has the shaft alone."""

    shaft_n: float
    tip_n: float

    @property
    def compression_n(self) -> float:
        """Shaft and tip."""
        return self.shaft_n + self.tip_n

    @property
    def tension_n(self) -> float:
        """The shaft; the pile's own weight is not counted."""
        return self.shaft_n


@dataclass(frozen=True)
class Pushover:
    """A pile pushed sideways at its head, step by step.

    Attributes
    ----------
    load_n : (n,) lateral load at the head, growing
    head_m : (n,) displacement of the head
    rotation_rad : (n,) of the head
    moment_nm : (n,) largest bending moment along the pile
    ultimate_n : load at which the head moves by ``FAILED_AT`` diameters, or beyond which nothing stands
    """

    load_n: FloatArray
    head_m: FloatArray
    rotation_rad: FloatArray
    moment_nm: FloatArray
    ultimate_n: float


def axial_capacity(curves: PileCurves) -> AxialCapacity:
    """Return the pile's capacity along its axis: ∫ t_max dz, and q_max."""
    t = np.array([curve.capacity for curve in curves.tz])
    return AxialCapacity(float(curves.at.weight @ t), float(curves.qz.capacity))


def pushover(pile: Pile, curves: PileCurves, *, arm_m: float = 0.0, steps: int = 20) -> Pushover:
    """Return a pile pushed to failure by a lateral load ``arm_m`` [m] above its free head.

    Raises
    ------
    InputError
        If the ground holds nothing, or fewer than two steps are asked for.
    """
    if not 2 <= steps <= 500:
        raise InputError("out of range", field="steps", value=steps, allowed="2 to 500")
    ultimate = _ultimate(pile, curves, arm_m)
    load = ultimate * np.arange(1, steps + 1) / steps
    stood = [push(pile, curves, _head_load(float(h), arm_m)) for h in load]
    u = np.array([one.displacement[0] for one in stood])
    moment = np.array([_largest_moment(pile, curves, one) for one in stood])
    return Pushover(load, u[:, 0], u[:, 4], moment, ultimate)


def _head_load(lateral_n: float, arm_m: float) -> FloatArray:
    return np.array([lateral_n, 0.0, 0.0, 0.0, lateral_n * arm_m, 0.0])


def _ultimate(pile: Pile, curves: PileCurves, arm_m: float) -> float:
    """Return the largest load that stands with less displacement than failure's, by doubling and halving."""
    limit = FAILED_AT * curves.diameter_m
    p = np.array([curve.capacity for curve in curves.py])
    total = float(curves.at.weight @ p)
    if total <= 0.0:
        raise InputError("the ground resists no lateral load", field="soil", remedy="check its strength")

    def stands(load: float) -> bool:
        try:
            return bool(abs(push(pile, curves, _head_load(load, arm_m)).displacement[0, 0]) <= limit)
        except NumericalError:
            return False

    # no load above the sum of all that resists can stand
    low = total
    while not stands(low):
        low *= 0.5
    high = 2.0 * low
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low


def _largest_moment(pile: Pile, curves: PileCurves, loaded: LoadedPile) -> float:
    """Return the largest bending moment [N·m]: EI times the curvature of the elements' ends."""
    z, u = curves.at.node_depth, loaded.displacement
    L = np.diff(z)
    section = pile.section
    D, d = section.outer_diameter_m, section.outer_diameter_m - 2.0 * section.thickness_m
    EI = pile.material.youngs_modulus_pa * np.pi / 64.0 * (D**4 - d**4)
    # slope dx/dz downwards is −θ_y; M = EI x'' at both ends of a cubic element
    x, slope = u[:, 0], -u[:, 4]
    chord = np.diff(x) / L
    first = EI * (6.0 * chord - 4.0 * slope[:-1] - 2.0 * slope[1:]) / L
    last = EI * (-6.0 * chord + 2.0 * slope[:-1] + 4.0 * slope[1:]) / L
    return float(np.abs(np.concatenate([first, last])).max())
