r"""Cyclic response of a pile: forces on its head along any path, in ground that unloads and reloads.

Steel is linear and its own inertia is left to the head (``lumped_head``); the ground is sliders at every
station, p-y in both horizontal directions, t-z and q-z. At each step the head
moves as it is told, and the nodes below find equilibrium by Newton's method. What a linear law says of
stiffness and loss can be judged against the loop this gives.

Soil curves unload and reload by Masing's rule, through Iwan's parallel sliders. A concave backbone cut at
displacements :math:`y_j` is the sum of elasto-plastic springs that yield there:
:math:`p(y) = \sum_j k_j \min(y, y_j)`. Each spring remembers where its slider stands, and nothing else is
needed for loops of any amplitude (Iwan 1967, J. Appl. Mech. 34:612): unloading starts with the initial
stiffness, and a closed loop of amplitude Y loses 8 (∫₀^Y p dy − ½ p(Y) Y).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import NumericalError
from jackettwin.soil.ground.curves import Curve
from jackettwin.soil.piles.impedance import pile_matrices
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised

_BANDS = 12
"""Six DOFs a node, coupled with the next node's."""
_REACH = {"py": 0.1, "tz": 0.02, "qz": 0.1}
"""Displacement over the diameter at which the last slider of a curve yields."""
_ITERATIONS = 60
_TOLERANCE = 1e-9
"""Of the forces out of balance, over those that a millimetre of the steel's stiffness gives."""


@dataclass(frozen=True)
class Sliders:
    """Elasto-plastic springs: (n_springs, n_sliders) stiffness [N/m] and displacement at yield [m]."""

    stiffness: FloatArray
    yield_m: FloatArray

    def at_rest(self) -> FloatArray:
        """Return the state of virgin ground: sliders (n_springs, n_sliders) where the pile stands [m]."""
        return np.zeros_like(self.stiffness)


class SliderStep(NamedTuple):
    """Force (n_springs,) [N], tangent [N/m] and the new state."""

    force: FloatArray
    tangent: FloatArray
    state: FloatArray


def sliders(curves: tuple[Curve, ...], weight: FloatArray, *, largest_m: float, number: int = 24) -> Sliders:
    """Return the sliders of reaction curves, each times the pile length it stands for [m].

    The curves are sampled at ``number`` displacements in geometric progression up to ``largest_m``. Softening
    beyond a peak cannot be had from springs in parallel: the peak is held.
    """
    y = np.concatenate([[0.0], np.geomspace(1e-4 * largest_m, largest_m, number)])
    p = np.array([np.maximum.accumulate(curve.force(y)) for curve in curves]) * weight[:, None]
    slope = np.diff(p, axis=1) / np.diff(y)
    # a backbone that stiffens has no sliders either: the smallest slope so far is held
    slope = np.minimum.accumulate(slope, axis=1)
    stiffness = slope - np.concatenate([slope[:, 1:], np.zeros((len(curves), 1))], axis=1)
    return Sliders(stiffness, np.broadcast_to(y[1:], stiffness.shape))


def move(springs: Sliders, state: FloatArray, y: FloatArray) -> SliderStep:
    """Return forces at displacements ``y`` (n_springs,) [m] coming from ``state``."""
    stretch = y[:, None] - state
    slipped = np.clip(stretch, -springs.yield_m, springs.yield_m)
    sticking = np.abs(stretch) < springs.yield_m
    force = (springs.stiffness * slipped).sum(axis=1)
    tangent = (springs.stiffness * sticking).sum(axis=1)
    return SliderStep(force, tangent, y[:, None] - slipped)


@dataclass(frozen=True)
class CyclicPile:
    """A pile and its sliders.

    Attributes
    ----------
    linear : (6n, 6n) sparse
        Steel, and the ground's resistance to torsion, which stays linear.
    bands : (12, 6n − 6) lower bands of it below the head
    springs : Sliders
    dof : (n_springs,) the pile's DOF each spring acts on
    """

    linear: sp.csr_array
    bands: FloatArray
    springs: Sliders
    dof: IntArray

    def at_rest(self) -> CyclicState:
        """Return the pile in virgin ground."""
        return CyclicState(np.zeros(self.linear.shape[0]), self.springs.at_rest())


class CyclicState(NamedTuple):
    """Displacements (6n,) [m, rad] and the sliders' state."""

    u: FloatArray
    sliders: FloatArray


class Loop(NamedTuple):
    """A closed cycle along one direction of motion: secant stiffness at its ends, and loss factor.

    η = ΔW/(2πW) with the loop's area ΔW and W = ½kA².
    """

    stiffness: float
    loss_factor: float


def cyclic_pile(pile: Pile, curves: PileCurves) -> CyclicPile:
    """Return a pile whose ground follows ``curves`` when first loaded and Masing's rule thereafter."""
    at, D = curves.at, curves.diameter_m
    lateral, shaft = (
        sliders(family, at.weight, largest_m=_REACH[kind] * D)
        for kind, family in (("py", curves.py), ("tz", curves.tz))
    )
    tip = sliders((curves.qz,), np.ones(1), largest_m=_REACH["qz"] * D)
    every = (lateral, lateral, shaft, tip)
    springs = Sliders(
        np.concatenate([s.stiffness for s in every]), np.concatenate([s.yield_m for s in every])
    )
    last = at.node_depth.size - 1
    dof = np.concatenate([6 * at.node, 6 * at.node + 1, 6 * at.node + 2, [6 * last + 2]])
    initial = linearised(curves)
    torsion = np.zeros((last + 1, 6))
    torsion[:, 5] = initial.torsional
    linear = sp.csr_array(pile_matrices(pile, initial).steel + sp.diags_array(torsion.ravel()))
    inner = linear[6:, 6:]
    bands = np.zeros((_BANDS, inner.shape[0]))
    for k in range(_BANDS):
        bands[k, : inner.shape[0] - k] = inner.diagonal(-k)
    return CyclicPile(linear, bands, springs, dof.astype(np.intp))


def advance(pile: CyclicPile, held: CyclicState, head: FloatArray) -> tuple[FloatArray, CyclicState]:
    """Return the force (6,) that moves the head to ``head`` (6,), and the state there.

    Raises
    ------
    NumericalError
        If the pile finds no equilibrium.
    """
    u = held.u.copy()
    u[:6] = head
    n = u.size
    # loads that a millimetre of the steel's own stiffness gives: what is small against them is nothing
    scale = 1e-3 * float(np.abs(pile.bands[0]).max()) + float(np.abs(pile.linear[:6] @ u).max())
    for _ in range(_ITERATIONS):
        ground = move(pile.springs, held.sliders, u[pile.dof])
        force = pile.linear @ u + np.bincount(pile.dof, ground.force, minlength=n)
        if np.abs(force[6:]).max() <= _TOLERANCE * scale:
            return np.asarray(force[:6], dtype=np.float64), CyclicState(u, ground.state)
        bands = pile.bands.copy()
        bands[0] += np.bincount(pile.dof, ground.tangent, minlength=n)[6:]
        try:
            u[6:] -= la.solveh_banded(bands, force[6:], lower=True, check_finite=False)
        except la.LinAlgError:
            break
    raise NumericalError("the pile finds no equilibrium: its ground has failed")


def drive(pile: CyclicPile, motion: FloatArray) -> FloatArray:
    """Return the head's forces (n_times, 6) along a path of its displacements, from virgin ground."""
    held, forces = pile.at_rest(), np.empty_like(motion)
    for k, head in enumerate(motion):
        forces[k], held = advance(pile, held, head)
    return forces


def loop(pile: CyclicPile, motion: FloatArray, *, steps: int = 40) -> Loop:
    """Return the loop of a cycle with amplitude ``motion`` (6,) [m, rad], after one that opens it.

    Stiffness is force along the motion over |motion|², both as work: Σ F·motion/|motion|².
    """
    phase = 2.0 * np.pi * np.arange(2 * steps + steps // 4 + 1) / steps
    share = np.sin(phase)
    along = drive(pile, share[:, None] * motion) @ motion
    top = steps + steps // 4
    cycle = slice(top, top + steps + 1)
    loss = float(np.trapezoid(along[cycle], share[cycle]))
    # share and along/|motion|² are in units of the amplitude: W = ½k
    return Loop(float(along[top] / (motion @ motion)), loss / (np.pi * float(along[top])))
