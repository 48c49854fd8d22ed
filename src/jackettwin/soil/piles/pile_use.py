"""Utilisation of a pile by its foot's forces: axial and lateral capacity of the ground, and the steel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks import DesignBasis, MemberUse, frame_use
from jackettwin.errors import NumericalError
from jackettwin.soil.piles.capacity import AxialCapacity, axial_capacity, push, pushover
from jackettwin.soil.piles.impedance import pile_assembly
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised
from jackettwin.soil.support import Support

RESISTANCE = 1.25
"""γ_R of the axial capacity under extreme actions, ISO 19902 clause 17; 1.50 under permanent and variable."""

FARTHEST_M = 300.0
"""Arm of a head's moment beyond which it counts as a pure moment."""


@dataclass(frozen=True)
class PileUse:
    """Utilisation of a pile; the allowed maximum is 1.

    Attributes
    ----------
    foot : node that the pile carries
    force : (6,) on the head, global axes [N, N·m]
    capacity : along the axis
    axial : γ_R N over the capacity in compression or tension
    lateral : γ_R H over the load that moves a free head by a tenth of a diameter at the arm M/H, its steel
        plastic; infinite where the ground holds nothing sideways
    stands : whether ground and elastic steel find an equilibrium
    head_m, rotation_rad : displacement and rotation of the head; None if it does not stand
    steel : worst section of the pile and its use by ISO 19902 clause 13; None if it does not stand
    steel_depth_m : of that section's element, its upper end
    """

    foot: str
    force: FloatArray
    capacity: AxialCapacity
    axial: float
    lateral: float
    stands: bool
    head_m: float | None = None
    rotation_rad: float | None = None
    steel: MemberUse | None = None
    steel_depth_m: float | None = None
    case: str = ""
    """The combination of actions it is of."""

    @property
    def worst(self) -> float:
        """The largest of its uses; infinite where the pile does not stand."""
        steel = self.steel.utilisation if self.steel and self.stands else np.inf
        return max(self.axial, self.lateral, steel)


def head_forces(support: Support, displacement: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the force (6,) of each foot on the ground, from its displacement (6,) with relaxed supports."""
    found = {node: np.zeros(6) for node in displacement}
    for spring in support.springs:
        if spring.node in found:
            K = float(spring.law.static_stiffness) * spring.matrix
            found[spring.node] = found[spring.node] + K @ displacement[spring.node]
    return found


def pile_use(
    foot: str,
    pile: Pile,
    curves: PileCurves,
    force: FloatArray,
    *,
    basis: DesignBasis,
    resistance: float = RESISTANCE,
) -> PileUse:
    """Return the use of a pile under a force (6,) on its head, factored actions [N, N·m].

    The ground yields and the steel does not; ground holds the pile along its length, so that its sections are
    checked and no column. Its own weight is not counted.
    """
    capacity, downwards = axial_capacity(pile, curves), -float(force[2])
    limit = capacity.compression_n if downwards > 0.0 else capacity.tension_n
    axial = resistance * abs(downwards) / limit if limit > 0.0 else np.inf
    lateral = resistance * _lateral(pile, curves, force, basis.yield_strength_pa)
    try:
        u = push(pile, curves, force).displacement
    except NumericalError:
        return PileUse(foot, force, capacity, axial, lateral, stands=False)
    uses = frame_use(pile_assembly(pile, linearised(curves).node_depth), u.ravel(), basis).members
    at = int(np.argmax([one.utilisation for one in uses]))
    depth = float(curves.at.node_depth[at])
    moved, turned = float(np.hypot(*u[0, :2])), float(np.hypot(*u[0, 3:5]))
    return PileUse(foot, force, capacity, axial, lateral, True, moved, turned, uses[at], depth)


def _lateral(pile: Pile, curves: PileCurves, force: FloatArray, f_y: float) -> float:
    """Return the lateral force on a head over the one that its pile carries at the same arm."""
    H, moment = float(np.hypot(*force[:2])), float(np.hypot(*force[3:5]))
    demand = max(H, moment / FARTHEST_M)
    if demand == 0.0:
        return 0.0
    if not any(curve.capacity > 0.0 for curve in curves.py):
        return np.inf
    # a moment in the plane of the force; one across it turns the pile another way
    in_plane = (force[0] * force[4] - force[1] * force[3]) / H if H > 0.0 else moment
    arm = float(np.clip(in_plane / demand, -FARTHEST_M, FARTHEST_M))
    return demand / pushover(pile, curves, arm_m=arm, steps=2, yield_strength_pa=f_y).ultimate_n
