"""A pile under a static head load: non-linear curves, and the secant springs they leave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError
from jackettwin.soil.ground.curves import tangent_stiffness
from jackettwin.soil.piles.impedance import pile_matrices
from jackettwin.soil.piles.piles import Pile, PileSprings
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised


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
