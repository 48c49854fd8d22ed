"""A pile under a static head load in ground that yields, and the most that it carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError, require
from jackettwin.soil.ground.curves import tangent_stiffness
from jackettwin.soil.piles.impedance import pile_matrices
from jackettwin.soil.piles.piles import Pile, PileSprings
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised

FAILED_AT = 0.1
"""Head displacement in pile diameters that counts as failure: a tenth, as pile tests are read."""
_BISECTIONS = 12
"""Of the ultimate load between a load that stands and one that fails: 0.02 % of it."""


@dataclass(frozen=True)
class LoadedPile:
    """Displacements (n_nodes, 6) [m, rad] of a pile in equilibrium with the load on its head."""

    displacement: FloatArray

    def secant(self, curves: PileCurves) -> PileSprings:
        """Return the springs that carry the same load at the same displacements."""
        u = self.displacement
        return linearised(curves, lateral_m=np.hypot(u[:, 0], u[:, 1]), axial_m=u[:, 2])


def push(
    pile: Pile, curves: PileCurves, head_load: FloatArray, *, tolerance: float = 1e-8, steps: int = 10
) -> LoadedPile:
    """Return the pile under ``head_load`` (6,) [N, N·m], by Newton's method in ``steps`` equal increments.

    Lateral springs act along the resultant displacement (both directions share one curve); torsion keeps its
    initial stiffness.

    Raises
    ------
    NumericalError
        If an increment finds no equilibrium: the load is beyond the pile's capacity.
    """
    initial = linearised(curves)
    steel = pile_matrices(pile, initial).steel
    n = initial.node_depth.size
    u = np.zeros((n, 6))
    for step in range(1, steps + 1):
        load = np.zeros((n, 6))
        load[0] = head_load * (step / steps)
        u = _newton(steel, curves, initial.torsional, u, load, tolerance)
    return LoadedPile(u)


def _newton(
    steel: sp.csc_array,
    curves: PileCurves,
    torsional: FloatArray,
    u: FloatArray,
    load: FloatArray,
    tolerance: float,
) -> FloatArray:
    scale = float(np.abs(load).max()) or 1.0
    for _ in range(60):
        force, tangent = soil_reaction(curves, torsional, u)
        residual = load - force - (steel @ u.ravel()).reshape(u.shape)
        if np.abs(residual).max() <= tolerance * scale:
            return u
        try:
            change = spla.splu(sp.csc_matrix(steel + tangent)).solve(residual.ravel())
        except RuntimeError:  # nothing holds the pile any more
            break
        u = u + change.reshape(u.shape)
        if not np.isfinite(u).all() or np.abs(u[:, :3]).max() > 100.0:
            break
    raise NumericalError("the pile finds no equilibrium: the head load is beyond its capacity")


def soil_reaction(
    curves: PileCurves, torsional: FloatArray, u: FloatArray
) -> tuple[FloatArray, sp.csc_array]:
    """Return nodal soil forces (n, 6) on the soil side and their tangent (6n, 6n) at displacements ``u``."""
    at = curves.at
    r = np.hypot(u[:, 0], u[:, 1])
    radial = np.where(r > 0.0, r, 1.0)
    direction = np.where((r > 0.0)[:, None], u[:, :2] / radial[:, None], [1.0, 0.0])
    p, dp = _nodal(curves, "py", r)
    t, dt = _nodal(curves, "tz", u[:, 2])
    t[-1] += float(curves.qz.force(u[-1, 2]))
    dt[-1] += float(tangent_stiffness(curves.qz, u[-1, 2]))
    force = np.zeros_like(u)
    force[:, :2] = p[:, None] * direction
    force[:, 2] = t
    force[:, 5] = torsional * u[:, 5]
    blocks = np.zeros((at.node_depth.size, 6, 6))
    along = direction[:, :, None] * direction[:, None, :]
    secant = np.where(r > 0.0, p / radial, dp)[:, None, None]
    blocks[:, :2, :2] = dp[:, None, None] * along + secant * (np.eye(2) - along)
    blocks[:, 2, 2], blocks[:, 5, 5] = dt, torsional
    return force, sp.csc_array(sp.block_diag(list(blocks)))


def _nodal(curves: PileCurves, kind: str, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return reaction and tangent at the nodes from the curves at their stations."""
    at, family = curves.at, curves.py if kind == "py" else curves.tz
    moved = y[at.node]
    p = np.array([float(curve.force(v)) for curve, v in zip(family, moved, strict=True)])
    dp = np.array([float(tangent_stiffness(curve, v)) for curve, v in zip(family, moved, strict=True)])
    return at.at_nodes(p), at.at_nodes(dp)


@dataclass(frozen=True)
class AxialCapacity:
    """Ultimate loads along an open pile [N], plugged or not, whichever carries less (API RP 2GEO, 8.1).

    Attributes
    ----------
    shaft_n : friction outside
    inner_n : friction inside, of the soil that stays behind as the pile goes on; none if it plugs
    tip_n : of the whole base if it plugs, else of the steel
    plugged : whether the soil inside goes with the pile
    """

    shaft_n: float
    inner_n: float
    tip_n: float
    plugged: bool

    @property
    def compression_n(self) -> float:
        """Shaft, outside and inside, and tip."""
        return self.shaft_n + self.inner_n + self.tip_n

    @property
    def tension_n(self) -> float:
        """The shaft outside; neither weight nor friction inside is counted."""
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


def axial_capacity(pile: Pile, curves: PileCurves) -> AxialCapacity:
    """Return the pile's capacity along its axis: ∫ t_max dz, and q_max on what the tip bears on."""
    t = np.array([curve.capacity for curve in curves.tz])
    shaft, D, d = float(curves.at.weight @ t), pile.outer_diameter_m, pile.inner_diameter_m
    bearing_pa = float(curves.qz.capacity) / pile.tip_area_m2
    whole, steel = 0.25 * np.pi * D**2, 0.25 * np.pi * (D**2 - d**2)
    plug = AxialCapacity(shaft, 0.0, bearing_pa * whole, plugged=True)
    core = AxialCapacity(shaft, shaft * d / D, bearing_pa * steel, plugged=False)
    return min(plug, core, key=lambda one: one.compression_n)


def pushover(pile: Pile, curves: PileCurves, *, arm_m: float = 0.0, steps: int = 20) -> Pushover:
    """Return a pile pushed to failure by a lateral load ``arm_m`` [m] above its free head.

    Raises
    ------
    InputError
        If the ground holds nothing, or fewer than two steps are asked for.
    """
    require(2 <= steps <= 500, "out of range", field="steps", value=steps, allowed="2 to 500")
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
    require(total > 0.0, "the ground resists no lateral load", field="soil", remedy="check its strength")

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
    D, d = pile.outer_diameter_m, pile.outer_diameter_m - 2.0 * pile.thickness_m
    EI = pile.youngs_modulus_pa * np.pi / 64.0 * (D**4 - d**4)
    # slope dx/dz downwards is −θ_y; M = EI x'' at both ends of a cubic element
    x, slope = u[:, 0], -u[:, 4]
    chord = np.diff(x) / L
    first = EI * (6.0 * chord - 4.0 * slope[:-1] - 2.0 * slope[1:]) / L
    last = EI * (-6.0 * chord + 2.0 * slope[:-1] + 4.0 * slope[1:]) / L
    return float(np.abs(np.concatenate([first, last])).max())
