"""Static response of a pile to a head load in yielding ground, and its capacity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError, require
from jackettwin.soil.ground.curves import Curve, force_and_tangent
from jackettwin.soil.piles.group import ClayBlock
from jackettwin.soil.piles.impedance import pile_matrices
from jackettwin.soil.piles.piles import Pile, PileSprings
from jackettwin.soil.piles.plastic_steel import PlasticSteel
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised

FAILED_AT = 0.1
"""Head displacement in pile diameters that counts as failure: a tenth, as pile tests are read."""
_BALANCED = 1e-8
"""Largest load out of balance, as a share of the largest load."""
_LEAST_STEPS = 20
"""Of the head on its way to failure."""


@dataclass(frozen=True)
class LoadedPile:
    """Displacements (n_nodes, 6) [m, rad] of a pile in equilibrium with the load on its head."""

    displacement: FloatArray

    def secant(self, curves: PileCurves) -> PileSprings:
        """Return the springs that carry the same load at the same displacements."""
        u = self.displacement
        return linearised(curves, lateral_m=np.hypot(u[:, 0], u[:, 1]), axial_m=u[:, 2])


def push(pile: Pile, curves: PileCurves, head_load: FloatArray, *, steps: int = 10) -> LoadedPile:
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
        u = _newton(steel, curves, initial.torsional, u, load)
    return LoadedPile(u)


def _newton(
    steel: sp.csc_array,
    curves: PileCurves,
    torsional: FloatArray,
    u: FloatArray,
    load: FloatArray,
) -> FloatArray:
    scale = float(np.abs(load).max()) or 1.0
    for _ in range(60):
        force, tangent = soil_reaction(curves, torsional, u)
        residual = load - force - (steel @ u.ravel()).reshape(u.shape)
        if np.abs(residual).max() <= _BALANCED * scale:
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
    along_shaft = p.copy()
    _add_base(p, dp, curves.base_shear, r)
    t, dt = _nodal(curves, "tz", u[:, 2])
    _add_base(t, dt, curves.qz, u[:, 2])
    force = np.zeros_like(u)
    force[:, :2] = p[:, None] * direction
    force[:, 2] = t
    force[:, 5] = torsional * u[:, 5]
    blocks = np.zeros((at.node_depth.size, 6, 6))
    along = direction[:, :, None] * direction[:, None, :]
    secant = np.where(r > 0.0, p / radial, dp)[:, None, None]
    blocks[:, :2, :2] = dp[:, None, None] * along + secant * (np.eye(2) - along)
    blocks[:, 2, 2], blocks[:, 5, 5] = dt, torsional
    if curves.sides:
        turned, stiffness = _turning(curves, along_shaft, u[:, 3:5])
        force[:, 3:5], blocks[:, 3:5, 3:5] = turned, stiffness
    n = len(blocks)
    return force, sp.csc_array(sp.bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(6 * n, 6 * n)))


def _turning(curves: PileCurves, p: FloatArray, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return moments (n, 2) of shaft and base against rotations (n, 2), and their slopes (n, 2, 2).

    In sand they grow with the nodal lateral force ``p``, which counts as known: Newton's method
    converges a little slower for it, and to the same.
    """
    at = curves.at
    theta = np.hypot(rotation[:, 0], rotation[:, 1])
    safe = np.where(theta > 0.0, theta, 1.0)
    direction = np.where((theta > 0.0)[:, None], rotation / safe[:, None], [0.0, 1.0])
    moved = theta[at.node]
    force, slope = _of_curves([side.curve for side in curves.sides], moved)
    by_force = np.array([side.by_force for side in curves.sides])
    length = at.at_nodes(np.ones_like(at.weight))
    with_p = np.abs(p / length)[at.node]
    m, dm = (at.at_nodes(np.where(by_force, with_p, 1.0) * one) for one in (force, slope))
    _add_base(m, dm, curves.base_moment, theta)
    along = direction[:, :, None] * direction[:, None, :]
    secant = np.where(theta > 0.0, m / safe, dm)[:, None, None]
    return m[:, None] * direction, dm[:, None, None] * along + secant * (np.eye(2) - along)


def _nodal(curves: PileCurves, kind: str, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return reaction and tangent at the nodes from the curves at their stations."""
    at = curves.at
    p, dp = _of_curves(curves.py if kind == "py" else curves.tz, y[at.node])
    return at.at_nodes(p), at.at_nodes(dp)


def _of_curves(family: Sequence[Curve], moved: FloatArray) -> FloatArray:
    """Return force and tangent of each curve at its displacement, (2, n)."""
    found = [force_and_tangent(curve, float(v)) for curve, v in zip(family, moved, strict=True)]
    return np.array(found).reshape(-1, 2).T


def _add_base(force: FloatArray, tangent: FloatArray, base: Curve, moved: FloatArray) -> None:
    """Add what the base does to the reaction of the lowest node."""
    p, dp = force_and_tangent(base, float(moved[-1]))
    force[-1] += p
    tangent[-1] += dp


@dataclass(frozen=True)
class AxialCapacity:
    """Ultimate loads along an open pile [N], plugged or not, whichever carries less (API RP 2GEO, 8.1).

    Attributes
    ----------
    shaft_n : friction outside
    inner_n : friction inside, of the soil that stays behind as the pile goes on; none if it plugs
    tip_n : of the whole base if it plugs, else of the steel
    plugged : whether the soil inside goes with the pile
    block : share of the clay that the pile's group encloses, which may fail as one; None of a single pile
    """

    shaft_n: float
    inner_n: float
    tip_n: float
    plugged: bool
    block: ClayBlock | None = None

    @property
    def alone_n(self) -> float:
        """Of a single pile: shaft, outside and inside, and tip."""
        return self.shaft_n + self.inner_n + self.tip_n

    @property
    def compression_n(self) -> float:
        """Of the pile, or its share of the block, whichever carries less."""
        return (
            self.alone_n if self.block is None else min(self.alone_n, self.block.shaft_n + self.block.base_n)
        )

    @property
    def tension_n(self) -> float:
        """The shaft outside or the block's sides; neither weight nor friction inside is counted."""
        return self.shaft_n if self.block is None else min(self.shaft_n, self.block.shaft_n)


@dataclass(frozen=True)
class Pushover:
    """A pile pushed sideways at its head, step by step.

    Attributes
    ----------
    load_n : (n,) lateral load at the head; it falls where the ground softens
    head_m : (n,) displacement of the head, in equal steps to ``FAILED_AT`` diameters
    rotation_rad : (n,) of the head
    moment_nm : (n,) largest bending moment along the pile
    ultimate_n : load with which the head has moved by ``FAILED_AT`` diameters
    highest_n : largest load on the way, at least that
    ductility : largest curvature at the end over that at first yield; None of elastic steel
    hinge_m : depth of that curvature
    """

    load_n: FloatArray
    head_m: FloatArray
    rotation_rad: FloatArray
    moment_nm: FloatArray
    ultimate_n: float
    highest_n: float
    ductility: float | None = None
    hinge_m: float | None = None

    def first_load_n(self, moment_nm: float) -> float | None:
        """Return the first load at which the largest moment reaches ``moment_nm``; None if it never does."""
        over = np.flatnonzero(self.moment_nm >= moment_nm)
        if not over.size:
            return None
        k = int(over[0])
        load, moment = np.append(0.0, self.load_n), np.append(0.0, self.moment_nm)
        return float(np.interp(moment_nm, moment[k : k + 2], load[k : k + 2]))


def axial_capacity(pile: Pile, curves: PileCurves) -> AxialCapacity:
    """Return the pile's capacity along its axis: ∫ t_max dz, and q_max on what the tip bears on."""
    t = np.array([curve.capacity for curve in curves.tz])
    shaft, D, d = float(curves.at.weight @ t), pile.outer_diameter_m, pile.inner_diameter_m
    bearing_pa = float(curves.qz.capacity) / pile.tip_area_m2
    whole, steel = 0.25 * np.pi * D**2, 0.25 * np.pi * (D**2 - d**2)
    plug = AxialCapacity(shaft, 0.0, bearing_pa * whole, True, curves.block)
    core = AxialCapacity(shaft, shaft * d / D, bearing_pa * steel, False, curves.block)
    return min(plug, core, key=lambda one: one.alone_n)


def pushover(
    pile: Pile,
    curves: PileCurves,
    *,
    arm_m: float = 0.0,
    steps: int = 20,
    yield_strength_pa: float | None = None,
) -> Pushover:
    """Return a pile pushed to failure by a lateral load ``arm_m`` [m] above its free head.

    The head is moved step by step, and the load that holds it there is found with it: ground that softens is
    followed beyond the largest load. Steel with a yield strength is elastic, then perfectly plastic in
    bending, fibre by fibre: hinges form where they will.

    Raises
    ------
    InputError
        If the ground holds nothing, or fewer than two steps are asked for.
    NumericalError
        If no equilibrium is found on the way.
    """
    require(2 <= steps <= 500, "out of range", field="steps", value=steps, allowed="2 to 500")
    require(
        any(curve.capacity > 0.0 for curve in curves.py),
        "the ground resists no lateral load",
        field="soil",
        remedy="check its strength",
    )
    path = _HeldHead(pile, curves, arm_m, yield_strength_pa)
    limit, fine = FAILED_AT * curves.diameter_m, -(-_LEAST_STEPS // steps)
    way = [path.move_to(limit * k / (steps * fine)) for k in range(1, steps * fine + 1)]
    # of two mirrored paths the one in which the load is positive
    forwards = 1.0 if way[-1][0] >= 0.0 else -1.0
    every = forwards * np.array([load for load, _ in way])
    u = forwards * np.array([u for _, u in way[fine - 1 :: fine]])
    load = every[fine - 1 :: fine]
    moment = np.array([_largest_moment(pile, curves, one, path.yielding) for one in u])
    found = Pushover(load, u[:, 0, 0], u[:, 0, 4], moment, float(load[-1]), float(every.max()))
    if path.yielding is None:
        return found
    kappa = np.abs(path.yielding.curvature(u[-1]))
    at = int(kappa.max(axis=0).argmax())
    ductility = float(kappa.max()) / path.yielding.tube.yield_curvature
    return replace(found, ductility=ductility, hinge_m=float(curves.at.node_depth[at : at + 2].mean()))


class _HeldHead:
    """A pile whose head is moved sideways, with the load that does it."""

    def __init__(self, pile: Pile, curves: PileCurves, arm_m: float, f_y: float | None) -> None:
        initial = linearised(curves)
        self.yielding = None if f_y is None else PlasticSteel(pile, initial.node_depth, f_y)
        self.curves, self.torsional = curves, initial.torsional
        self.steel = pile_matrices(pile, initial).steel
        self.unit = np.zeros((initial.node_depth.size, 6))
        self.unit[0] = [1.0, 0.0, 0.0, 0.0, arm_m, 0.0]
        self.u, self.load = np.zeros_like(self.unit), 0.0

    def move_to(self, head_m: float, halvings: int = 6) -> tuple[float, FloatArray]:
        """Return the load with which the head has moved by ``head_m``, and all displacements (n, 6)."""
        u, load = self.u, self.load
        try:
            self._settle(head_m)
        except NumericalError:
            self.u, self.load = u, load
            if halvings == 0:
                raise
            self.move_to(0.5 * (abs(float(u[0, 0])) + head_m), halvings - 1)
            self.move_to(head_m, halvings - 1)
        return self.load, self.u

    def _settle(self, head_m: float) -> None:
        """Newton's method on displacements and load together: the head is where it is asked to be."""
        for _ in range(60):
            inside, tangent = self._inside()
            residual = self.load * self.unit - inside
            scale = max(abs(self.load) * max(1.0, abs(self.unit[0, 4])), 1.0)
            if np.abs(residual).max() <= 1e-6 * scale and abs(self.u[0, 0] - head_m) <= 1e-9:
                return
            change = self._solve(residual, tangent, head_m - self.u[0, 0])
            self.u, self.load = self.u + change[:-1].reshape(self.u.shape), self.load + float(change[-1])
            if not np.isfinite(self.u).all() or np.abs(self.u[:, :3]).max() > 100.0:
                break
        raise NumericalError("the pile finds no equilibrium with its head held there")

    def _inside(self) -> tuple[FloatArray, sp.csc_array]:
        """Return forces (n, 6) of ground and steel, and their tangent."""
        force, tangent = soil_reaction(self.curves, self.torsional, self.u)
        force, tangent = force + (self.steel @ self.u.ravel()).reshape(force.shape), tangent + self.steel
        if self.yielding is not None:
            lost, slope = self.yielding.lost(self.u)
            force, tangent = force - lost, tangent - slope
        return force, tangent

    def _solve(self, residual: FloatArray, tangent: sp.csc_array, head_m: float) -> FloatArray:
        """Return the changes of displacements and load, (6n + 1,), even where all ground is plastic."""
        held = np.zeros((1, residual.size))
        held[0, 0] = scale = float(np.abs(self.steel.diagonal()).max())
        load = sp.csc_array(-scale * self.unit.reshape(-1, 1))
        blocks: list[list[Any]] = [[tangent, load], [sp.csc_array(held), None]]
        bordered = sp.bmat(blocks)
        try:
            factors = spla.splu(sp.csc_matrix(bordered))
        except RuntimeError:
            raise NumericalError("nothing holds the pile any more") from None
        change = np.asarray(factors.solve(np.append(residual.ravel(), scale * head_m)))
        change[-1] *= scale
        return change


def _largest_moment(pile: Pile, curves: PileCurves, u: FloatArray, yielding: PlasticSteel | None) -> float:
    """Return the largest bending moment [N·m], of the curvature of the elements' ends."""
    z = curves.at.node_depth
    L = np.diff(z)
    D, d = pile.outer_diameter_m, pile.outer_diameter_m - 2.0 * pile.thickness_m
    EI = pile.youngs_modulus_pa * np.pi / 64.0 * (D**4 - d**4)
    # slope dx/dz downwards is −θ_y; M = EI x'' at both ends of a cubic element
    x, slope = u[:, 0], -u[:, 4]
    chord = np.diff(x) / L
    first = (6.0 * chord - 4.0 * slope[:-1] - 2.0 * slope[1:]) / L
    last = (-6.0 * chord + 2.0 * slope[:-1] + 4.0 * slope[1:]) / L
    kappa = np.abs(np.concatenate([first, last])).max(keepdims=True)
    moment = EI * kappa if yielding is None else yielding.tube.moment(kappa)[0]
    return float(moment[0])
