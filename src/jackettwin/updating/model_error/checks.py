r"""What a fitted model cannot explain, and which error would explain it.

About the best fit, residuals r of all measured data, whitened by what is measured, follow

.. math:: r \sim N(0, K), \quad K = I + ΓΓ^T + J P^{-1} J^T, \qquad W = K^{-1}.

A datum left out is missed by :math:`(Wr)_i/W_{ii}` with variance :math:`1/W_{ii}` (Rasmussen & Williams 2006,
5.12), whether it was fitted or not. An error γ of unknown size takes :math:`(γ^T W r)^2/γ^T W γ` off χ²; of
a suspect that is asked for by its name this is a test of its own. The directions of pairs are data, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, sqrt

import numpy as np
from scipy.special import chdtrc, ndtri

from jackettwin.arrays import FloatArray
from jackettwin.updating.data.misfit import UNLIKELY
from jackettwin.updating.data.targets import Target
from jackettwin.updating.model_error.checked_data import CheckedData, Column, checked_data
from jackettwin.updating.model_error.directions import Direction, Tolerance
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.model_error.mode_checks import OrderCheck, ShapeCheck
from jackettwin.updating.model_error.pair_directions import PairDirection
from jackettwin.updating.problem import Problem

_MOST = 3
"""Explanations that are named."""
_LARGEST = 8.0
"""Standard deviations of a tolerance beyond which it is no explanation: nor does the first order hold."""
_WORTH = 4.0
"""χ² that an explanation takes off to be one: two standard deviations."""
_SURELY = float(ndtri(0.9))
"""Standard deviations beyond the limit of what is objected to nine times in ten."""
_TOLD = 1e-9
"""Precision, in that of the measurement, below which the others say nothing of a datum."""


@dataclass(frozen=True)
class DatumCheck:
    """A measured value beside what all the others say of it.

    Attributes
    ----------
    datum : str
        ``f1``, ``ζ4``; ``α1`` of the direction in which the lower mode of a pair moves.
    miss : float
        Measured over predicted, less one; of a direction measured less predicted [rad].
    std : float
        Standard deviation of that: prediction and measurement.
    fitted : bool
    objects : bool
        Whether chance does not explain it, among so many data.
    """

    datum: str
    miss: float
    std: float
    fitted: bool
    objects: bool

    @property
    def is_direction(self) -> bool:
        """Whether it is an angle, not a share."""
        return self.datum.startswith("α")


@dataclass(frozen=True)
class Explanation:
    """An error that would explain what the model does not.

    Attributes
    ----------
    tolerance : Tolerance
    size : float
        In the tolerance's unit.
    stds : float
        The same in its standard deviations.
    gain : float
        χ² that it takes off.
    """

    tolerance: Tolerance
    size: float
    stds: float
    gain: float


@dataclass(frozen=True, eq=False)
class Unseen:
    """A suspect that at its size would be objected to less than nine times in ten.

    Attributes
    ----------
    tolerance : Tolerance
    seen_from : float
        Size in its unit from which it would be nine times in ten or more, as far as the first order holds;
        infinite if it moves nothing.
    effect : (n_parameters,)
        By how much ln θ is another than it is said to be, where the suspect is true at its size.
    """

    tolerance: Tolerance
    seen_from: float
    effect: FloatArray


@dataclass(frozen=True)
class Objection:
    """What a fitted model does not explain.

    Attributes
    ----------
    checks : tuple of DatumCheck
        Of every measured value, fitted or not.
    chi2, freedom, probability : float
        Of all values that are fitted, and of frequencies and directions that are not.
    explanations : tuple of Explanation
        The best first; empty where nothing is to be explained.
    unseen : tuple of Unseen
    suspected : tuple of Tolerance
        Suspects that the data ask for, beyond chance.
    shapes : tuple of ShapeCheck
        Of modes whose shape was measured.
    orders : tuple of OrderCheck
        Of neighbours among the measured modes.
    """

    checks: tuple[DatumCheck, ...]
    chi2: float
    freedom: int
    probability: float
    explanations: tuple[Explanation, ...] = ()
    unseen: tuple[Unseen, ...] = ()
    suspected: tuple[Tolerance, ...] = ()
    shapes: tuple[ShapeCheck, ...] = ()
    orders: tuple[OrderCheck, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether chance does not explain what was measured."""
        each = [check.objects for checks in (self.checks, self.shapes, self.orders) for check in checks]
        return self.probability < UNLIKELY or any(each) or bool(self.suspected)


def objection(
    problem: Problem,
    z: FloatArray,
    beside: Sequence[Target] = (),
    suspects: Sequence[Direction] = (),
    pairs: Sequence[PairDirection] = (),
) -> Objection | None:
    """Return what a problem's best fit (d,) of ln θ leaves unexplained; None without standard deviations.

    Parameters
    ----------
    beside : modes that were measured and not fitted; of these the frequencies are checked
    suspects : errors beside those of the error model that may explain it
    pairs : directions of pairs of modes that were measured
    """
    if not problem.weighted:
        return None
    rows = checked_data(problem, z, beside, suspects, pairs)
    if rows is None:
        return None
    flat = np.array([p.median is None for p in problem.parameters])
    precision = np.diag(np.where(flat, problem.prior.std**-2.0, 0.0))
    W, _ = _left(rows, precision)
    Wr = W @ rows.r
    chi2 = float(rows.r @ Wr)
    used = int((np.linalg.svd(rows.J * problem.prior.std, compute_uv=False) > 0.5).sum())
    freedom = max(rows.r.size - used, 1)
    limit = -float(ndtri(0.5 * UNLIKELY / max(len(rows.names) + len(rows.asked), 1)))
    unseen, suspected = _suspects(rows, precision, limit)
    result = Objection(
        _checks(rows, set(problem.data_names), W, Wr, limit),
        chi2,
        freedom,
        float(chdtrc(freedom, max(chi2, 0.0))),
        unseen=unseen,
        suspected=suspected,
    )
    if not result.objects:
        return result
    return replace(result, explanations=_explanations([*rows.known, *rows.asked], W, Wr))


def _left(rows: CheckedData, precision: FloatArray, without: str = "") -> tuple[FloatArray, FloatArray]:
    """Return W (n_data, n_data), and what residuals move ln θ by, (n_parameters, n_data).

    Parameters
    ----------
    without : tolerance that counts as settled
    """
    closed = [place for place, (one, _) in enumerate(rows.known) if one.tolerance.name == without]
    inverse = np.linalg.inv(covariance(np.delete(rows.gains, closed, axis=1)))
    information = rows.J.T @ inverse @ rows.J + precision
    moved = np.linalg.solve(information, rows.J.T @ inverse)
    return np.asarray(inverse - inverse @ rows.J @ moved), np.asarray(-moved)


def _suspects(
    rows: CheckedData, precision: FloatArray, limit: float
) -> tuple[tuple[Unseen, ...], tuple[Tolerance, ...]]:
    """Return the suspects that would not be seen at their size, wherever, and those that are asked for."""
    unseen: dict[str, Unseen] = {}
    suspected: dict[str, Tolerance] = {}
    _, moved = _left(rows, precision)
    for direction, gamma in rows.asked:
        tolerance = direction.tolerance
        W, _ = _left(rows, precision, tolerance.beyond)
        power = max(float(gamma @ W @ gamma), 0.0)
        if float(gamma @ W @ rows.r) ** 2 > limit**2 * max(power, _TOLD):
            suspected[tolerance.name] = tolerance
        size = tolerance.std * ((limit + _SURELY) / sqrt(power) if power > 0.0 else np.inf)
        known = unseen.get(tolerance.name)
        if size > tolerance.std and (known is None or size > known.seen_from):
            unseen[tolerance.name] = Unseen(tolerance, size, moved @ gamma)
    return tuple(unseen.values()), tuple(suspected.values())


def _checks(
    rows: CheckedData, fitted: set[str], W: FloatArray, Wr: FloatArray, limit: float
) -> tuple[DatumCheck, ...]:
    """Return each datum beside what all the others say of it."""
    own = np.diag(W)
    judged = [i for i in range(len(rows.names)) if own[i] > _TOLD and np.isfinite(rows.scale[i])]
    stray = _strays(W, Wr, judged, limit)
    checks = []
    for i in judged:
        # residuals are of the model over the measured
        miss, name = -float(Wr[i] / own[i] * rows.scale[i]), rows.names[i]
        by = miss if name.startswith("α") else exp(min(miss, 50.0)) - 1.0
        std = float(rows.scale[i] / np.sqrt(own[i]))
        checks.append(DatumCheck(name, by, std, name in fitted, i in stray))
    return tuple(checks)


def _strays(W: FloatArray, Wr: FloatArray, judged: Sequence[int], limit: float) -> set[int]:
    """Return the data that the others do not allow: the worst first, without it the next.

    One datum far off makes others look wrong that were fitted together with it.
    """
    stray: set[int] = set()
    while left := [i for i in judged if i not in stray and W[i, i] > _TOLD]:
        worst = max(left, key=lambda i: abs(Wr[i]) / np.sqrt(W[i, i]))
        if abs(Wr[worst]) <= limit * np.sqrt(W[worst, worst]):
            break
        stray.add(worst)
        column, size = W[:, worst].copy(), W[worst, worst]
        Wr = Wr - column * (Wr[worst] / size)
        W = W - np.outer(column, column) / size
    return stray


def _explanations(columns: list[Column], W: FloatArray, Wr: FloatArray) -> tuple[Explanation, ...]:
    """Return the single errors that take most off χ², each name once."""
    best: dict[str, Explanation] = {}
    for direction, gamma in columns:
        seen = float(gamma @ W @ gamma)
        if seen < 1e-9:
            continue
        tolerance, size = direction.tolerance, -float(gamma @ Wr) / seen
        if abs(size) > _LARGEST:
            continue
        one = Explanation(tolerance, size * tolerance.std, size, float(gamma @ Wr) ** 2 / seen)
        if one.gain >= max(_WORTH, best[tolerance.name].gain if tolerance.name in best else 0.0):
            best[tolerance.name] = one
    return tuple(sorted(best.values(), key=lambda one: -one.gain)[:_MOST])
