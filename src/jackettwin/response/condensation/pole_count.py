r"""All oscillating modes inside a disc, with a certificate that the list is complete.

Newton iterations on the condensed F(λ) start from the eigenvalues of a small state matrix. The number of
poles inside the disc is then counted independently of how they were found: the argument principle on det F
gives their total number, Sylvester's law of inertia on the real axis the number of those that do not
oscillate,

.. math:: 2 N_{osc} + N_{real} = \frac{1}{2π} Δ\arg\det F + N_{law poles}.

The list is certified only if it agrees with the count: no pole is missing, duplicated or spurious. A
springpot has a branch cut instead of real poles; the contour goes around it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response.condensation.condensed import Condensed
from jackettwin.response.condensation.newton import kernels, refined
from jackettwin.response.state import state_matrix
from jackettwin.soil import BRANCHES, K0, K_ALPHA, MASS, OMEGA0, C, Prony, Springpot, one_branch, prony_fit
from jackettwin.soil.laws.coefficients import ALPHA
from jackettwin.structure import Rayleigh

_INNER = 0.9
"""The radius of the disc lies between this share of the band's limit and the limit, as far as possible from
poles."""
_FAR = 1e-4
"""In the initial eigenvalue problem a branch whose τ times the band's radius is below this is a dashpot, and
one above its inverse a spring."""
_NEARLY_REAL = 1e-5
"""Rounding may split a multiple real pole into pairs with this share of |λ| in Im λ; the count decides."""
_ARC_POINTS = 48
"""Points of the half circle to begin with; pieces on which the phase turns far are halved."""
_EDGE = 1e-10
"""Relative distance from a pole of a law at which the inertia is evaluated on either side of it."""
REAL = 1e-9
"""A pole with |Im λ| below this share of |λ| is real."""
SAME = 1e-8
"""Poles nearer than this (relative) with parallel shapes are one."""
_TOGETHER = 1e-3
"""If the count does not agree, initial poles nearer than this (relative) are refined together, as two may
have converged to one pole."""


@dataclass(frozen=True)
class AllModes:
    """Every oscillating mode of one parameter set inside a disc.

    Attributes
    ----------
    poles : (n_modes,) λ with Im λ > 0 [rad/s], by |λ|
    shapes : (n_modes, n) condensed coordinates
    radius : float
        Radius of the disc [rad/s].
    n_real : int or None
        Number of poles inside that do not oscillate; None for a springpot, whose relaxation is a continuum.
    certified : bool
    """

    poles: ComplexArray
    shapes: ComplexArray
    radius: float
    n_real: int | None
    certified: bool


def all_modes(model: Condensed, rows: FloatArray, rayleigh: FloatArray) -> AllModes:
    """Return all oscillating modes of one parameter set, and whether an independent count confirms them.

    Parameters
    ----------
    rows : (n_groups, width) law rows
    rayleigh : (2,) Rayleigh coefficients a, b
    """
    found = _attempt(model, rows, rayleigh, exact=False)
    for together in (False, True):
        if not found.certified:
            found = _attempt(model, rows, rayleigh, exact=True, together=together)
    return found


def real_poles(model: Condensed, rows: FloatArray, rayleigh: FloatArray, found: AllModes) -> FloatArray:
    """Return the poles that do not oscillate, by bisection of the inertia, multiple ones repeated.

    Parameters
    ----------
    found : AllModes
        Modes of the same set, whose disc is searched. The result is empty for a springpot.
    """
    if found.n_real is None:
        return np.zeros(0)
    breaks = _real_breaks(rows, np.zeros(0), found.radius)
    count = kernels().inertia(model.arrays(), rows, *rayleigh, breaks)
    poles = _law_poles(rows, found.radius)
    result: list[float] = []
    for right, left, n_right, n_left in zip(breaks[:-1], breaks[1:], count[:-1], count[1:], strict=True):
        across = np.any((poles > left) & (poles < right))
        if n_right != n_left and not across:
            result += _bisect(model, rows, rayleigh, right, left, int(n_right), int(n_left))
    return np.array(sorted(result, key=abs))


def _attempt(
    model: Condensed, rows: FloatArray, rayleigh: FloatArray, *, exact: bool, together: bool = False
) -> AllModes:
    values, vectors = _starts(model, rows, rayleigh, exact=exact)
    starts = np.ascontiguousarray(vectors.T)
    oscillating = (values.imag > REAL * np.abs(values)) & (np.abs(values) <= 1.3 * model.radius)
    poles, shapes = values[oscillating], starts[oscillating]
    family = np.zeros(poles.size, dtype=np.intp) if together else np.arange(poles.size)
    start = (rows[None], np.ascontiguousarray(rayleigh)[None], family, poles[None], shapes[None])
    done = refined(model, *start, _TOGETHER)[0]
    done &= poles.imag > REAL * np.abs(poles)
    poles, shapes = _distinct(poles[done], shapes[done])
    real = values[np.abs(values.imag) <= _NEARLY_REAL * np.abs(values)].real
    law_poles = _law_poles(rows, 2.0 * model.radius)
    radius = _roomy(np.concatenate([np.abs(poles), np.abs(real), np.abs(law_poles)]), model.radius)
    total, n_real = _counted(model, rows, rayleigh, real, radius, poles)
    inside = np.abs(poles) < radius
    poles, shapes = poles[inside], shapes[inside]
    found = AllModes(poles, shapes, radius, n_real, _agrees(total, 2.0 * poles.size))
    sure = poles.imag > _NEARLY_REAL * np.abs(poles)
    if not found.certified and _agrees(total, 2.0 * sure.sum()):
        return AllModes(poles[sure], shapes[sure], radius, n_real, True)
    return found


def _counted(
    model: Condensed,
    rows: FloatArray,
    rayleigh: FloatArray,
    real: FloatArray,
    radius: float,
    known: ComplexArray,
) -> tuple[float, int | None]:
    """Return twice the number of oscillating modes in the disc by the contour, and that of real poles."""
    cut = bool((rows[:, K_ALPHA] > 0.0).any())
    total = float(kernels().winding(model.arrays(), rows, *rayleigh, radius, cut, _ARC_POINTS, known))
    if cut:
        return total, None
    n_real = _count_real(model, rows, rayleigh, real, radius)
    return total + _n_law_poles(model, rows, radius) - n_real, n_real


def _agrees(total: float, count: float) -> bool:
    """Tell whether the winding number equals the counted integer, apart from rounding."""
    return bool(abs(total - count) < 1e-3)


def _starts(
    model: Condensed, rows: FloatArray, rayleigh: FloatArray, *, exact: bool
) -> tuple[ComplexArray, ComplexArray]:
    """Return eigenvalues and vectors (n, n_values) of the coordinates with approximations of the laws."""
    laws = [_finite_law(row, model, exact=exact) for row in rows]
    steel = Rayleigh(float(rayleigh[0]), float(rayleigh[1]))
    mass = model.pencil.M + sum(row[MASS] * g.S for row, g in zip(rows, model.pencil.groups, strict=True))
    pencil = replace(model.pencil.with_laws(laws), rayleigh=steel, M=mass)
    values, vectors = np.linalg.eig(state_matrix(pencil))
    return values.astype(np.complex128), vectors[: model.n].astype(np.complex128)


def _finite_law(row: FloatArray, model: Condensed, *, exact: bool) -> Prony:
    """Return a law with few states: that of the row, or one branch that approximates it in the band."""
    k, tau = row[BRANCHES::2], row[BRANCHES + 1 :: 2]
    live = (k > 0.0) & (tau > 0.0)
    if live.sum() > 1 and not exact or row[K_ALPHA] > 0.0 and not exact:
        return one_branch(row, model.radius)
    k0, c = float(row[K0]), float(row[C])
    # branches far above the band become dashpots, far below it springs: their states would impair the scaling
    fast, slow = live & (tau * model.radius < _FAR), live & (tau * model.radius > 1.0 / _FAR)
    k0, c = k0 + float(k[slow].sum()), c + float((k * tau)[fast].sum())
    live &= ~(fast | slow)
    k_all, tau_all = tuple(k[live]), tuple(tau[live])
    if row[K_ALPHA] > 0.0:
        springpot, band_hz = Springpot(row[K_ALPHA], row[ALPHA], row[OMEGA0]), model.radius / (2.0 * pi)
        fit = prony_fit(springpot, 0.001 * band_hz, 10.0 * band_hz, per_decade=2)
        k0, c, k_all, tau_all = k0 + fit.k0, c + fit.c, k_all + fit.k, tau_all + fit.tau
    return Prony(k0, c, k_all, tau_all)


def _distinct(poles: ComplexArray, shapes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the poles by |λ| without duplicates; equal poles with independent shapes are distinct."""
    order = np.argsort(np.abs(poles))
    kept: list[int] = []
    for m in order:
        twins = [j for j in kept if abs(poles[j] - poles[m]) <= SAME * abs(poles[m])]
        if not any(abs(np.vdot(shapes[j], shapes[m])) > 1.0 - 1e-6 for j in twins):
            kept.append(int(m))
    return poles[kept], shapes[kept]


def _roomy(sizes: FloatArray, radius: float) -> float:
    """Return a radius in the last part of the band, as far as possible from every known pole."""
    candidates = radius * np.linspace(_INNER, 1.0, 21)
    if sizes.size == 0:
        return float(candidates[-1])
    return float(candidates[np.argmax(np.abs(candidates[:, None] - sizes).min(axis=1))])


def _law_poles(rows: FloatArray, radius: float) -> FloatArray:
    """Return the distinct −1/τ of branches of non-zero stiffness inside a disc, from the origin outwards."""
    k, tau = rows[:, BRANCHES::2].ravel(), rows[:, BRANCHES + 1 :: 2].ravel()
    tau = tau[(k > 0.0) & (tau * radius > 1.0)]
    return np.sort(np.unique(-1.0 / tau))[::-1]


def _n_law_poles(model: Condensed, rows: FloatArray, radius: float) -> int:
    """Return the number of poles of det F inside the disc, with multiplicity."""
    live = (rows[:, BRANCHES::2] > 0.0) & (rows[:, BRANCHES + 1 :: 2] * radius > 1.0)
    return int(sum(rank * n for rank, n in zip(model.ranks, live.sum(axis=1), strict=True)))


def _real_breaks(rows: FloatArray, real: FloatArray, radius: float) -> FloatArray:
    """Return points on the real axis from 0 to −radius, two of which closely enclose every pole of a law."""
    poles = _law_poles(rows, radius)
    real = np.unique(real[(real < 0.0) & (real > -radius)])
    between = -np.sqrt(real[1:] * real[:-1])
    grid = -radius * np.logspace(-3, 0, 13)
    around = np.concatenate([poles * (1.0 - _EDGE), poles * (1.0 + _EDGE)])
    return np.unique(np.concatenate([[0.0], between, grid, around]))[::-1]


def _count_real(
    model: Condensed, rows: FloatArray, rayleigh: FloatArray, real: FloatArray, radius: float
) -> int:
    """Return a lower bound of the number of real poles in (−radius, 0), from changes of the inertia."""
    breaks = _real_breaks(rows, real, radius)
    count = kernels().inertia(model.arrays(), rows, *rayleigh, breaks)
    across = np.zeros(breaks.size - 1, dtype=np.bool_)
    for pole in _law_poles(rows, radius):
        across |= (breaks[1:] < pole) & (pole < breaks[:-1])
    return int(np.abs(np.diff(count))[~across].sum())


def _bisect(
    model: Condensed, rows: FloatArray, rayleigh: FloatArray, right: float, left: float, n_r: int, n_l: int
) -> list[float]:
    if n_r == n_l:
        return []
    middle = 0.5 * (right + left)
    if abs(right - left) <= 1e-13 * abs(left) or not left < middle < right:
        return [middle] * abs(n_l - n_r)
    n_m = int(kernels().inertia(model.arrays(), rows, *rayleigh, np.array([middle]))[0])
    return _bisect(model, rows, rayleigh, right, middle, n_r, n_m) + _bisect(
        model, rows, rayleigh, middle, left, n_m, n_l
    )
