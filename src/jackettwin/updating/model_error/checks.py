r"""Data that a fitted model cannot explain, and errors of the model that would explain them.

About the best fit, residuals r of all measured data, whitened by the measurement uncertainty, follow

.. math:: r \sim N(0, K), \quad K = I + ΓΓ^T + J P^{-1} J^T, \qquad W = K^{-1}.

The prediction of a datum from all others has the error :math:`(Wr)_i/W_{ii}` with variance :math:`1/W_{ii}`
(Rasmussen & Williams 2006, 5.12), whether it was fitted or not. An error γ of unknown size reduces χ² by
:math:`(γ^T W r)^2/γ^T W γ`; for each suspect this is a separate test. The directions of pairs are data, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, sqrt

import numpy as np
from scipy.special import chdtrc, ndtri

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.updating.data.misfit import UNLIKELY
from jackettwin.updating.data.targets import Target
from jackettwin.updating.model_error.checked_data import CheckedData, Column, checked_data
from jackettwin.updating.model_error.directions import Direction, Tolerance
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.model_error.measured_axes import PairDirection
from jackettwin.updating.model_error.mode_checks import OrderCheck, ShapeCheck
from jackettwin.updating.problem import Problem

OBJECTED = 0.05
"""Probability with which the checks object to a correct model whose errors are as large as the tolerances."""
_BY_DATA = 0.2
"""Share of it by single data, whose own errors are seldom small; the rest is by suspects."""
_DRAWN = 4000
"""Draws for the largest of all checks: its limit is then within 0.05 standard deviations."""
_MOST = 3
"""Largest number of explanations that are named."""
_LARGEST = 8.0
"""Standard deviations of a tolerance above which it is no explanation, and the linearisation is not valid."""
_WORTH = 4.0
"""Smallest reduction of χ² by an explanation: two standard deviations."""
_SURELY = float(ndtri(0.9))
"""Standard deviations beyond the limit at which an error is revealed with a probability of 0.9."""
_TOLD = 1e-9
"""Relative precision of a prediction from other data below which these do not determine a datum."""


@dataclass(frozen=True)
class DatumCheck:
    """A measured value compared with its prediction from all other data.

    Attributes
    ----------
    datum : str
        ``f1``, ``ζ4``; ``α1`` for the direction in which the lower mode of a pair moves.
    miss : float
        Ratio of measured to predicted value, minus one; for a direction the difference [rad].
    std : float
        Standard deviation of ``miss``, from prediction and measurement.
    fitted : bool
    objects : bool
        Whether it exceeds chance, given the number of data.
    """

    datum: str
    miss: float
    std: float
    fitted: bool
    objects: bool

    @property
    def is_direction(self) -> bool:
        """Whether ``miss`` is an angle, not a ratio."""
        return self.datum.startswith("α")


@dataclass(frozen=True)
class Explanation:
    """An error of the model that would explain the deviations.

    Attributes
    ----------
    tolerance : Tolerance
    size : float
        Size of the error, in the tolerance's unit.
    stds : float
        The same in its standard deviations.
    gain : float
        Reduction of χ².
    """

    tolerance: Tolerance
    size: float
    stds: float
    gain: float


@dataclass(frozen=True, eq=False)
class UndetectedError:
    """A suspected error that the data would reveal with a probability below 0.9.

    Attributes
    ----------
    tolerance : Tolerance
    seen_from : float
        Size in its unit from which this probability is 0.9 or more, to first order; infinite if it changes
        no datum.
    effect : (n_parameters,)
        Difference of ln θ from its stated value if the error is present at its size.
    """

    tolerance: Tolerance
    seen_from: float
    effect: FloatArray


@dataclass(frozen=True)
class Objection:
    """Deviations that a fitted model does not explain.

    Attributes
    ----------
    checks : tuple of DatumCheck
        Checks of all measured values, fitted or not.
    chi2, freedom, probability : float
        χ² of all fitted values and of the frequencies and directions that are not fitted.
    explanations : tuple of Explanation
        The best first; empty if there is nothing to explain.
    unseen : tuple of UndetectedError
    suspected : tuple of Tolerance
        Suspects whose effect is in the data, beyond chance.
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
    unseen: tuple[UndetectedError, ...] = ()
    suspected: tuple[Tolerance, ...] = ()
    shapes: tuple[ShapeCheck, ...] = ()
    orders: tuple[OrderCheck, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether the deviations exceed chance."""
        each = [check.objects for checks in (self.checks, self.shapes, self.orders) for check in checks]
        return self.probability < UNLIKELY or any(each) or bool(self.suspected)


def objection(
    problem: Problem,
    z: FloatArray,
    beside: Sequence[Target] = (),
    suspects: Sequence[Direction] = (),
    pairs: Sequence[PairDirection] = (),
) -> Objection | None:
    """Return the unexplained deviations of a best fit (d,) of ln θ; None without standard deviations.

    Parameters
    ----------
    beside : modes that were measured but not fitted, whose frequencies are checked
    suspects : possible errors in addition to those of the error model
    pairs : measured directions of pairs of modes
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
    of_data, of_suspects = _limits(rows, W)
    unseen, suspected = _suspects(rows, precision, of_suspects)
    result = Objection(
        _checks(rows, set(problem.data_names), W, Wr, of_data),
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


def _limits(rows: CheckedData, W: FloatArray) -> tuple[float, float]:
    """Return the standard deviations that the largest check of data, and of suspects, seldom exceeds.

    A correct model exceeds each with its share of ``OBJECTED``. The checks are correlated, many data being
    explained by few errors, so that Bonferroni's limit is too high: it is drawn. Suspects of one sense are
    exceeded in that sense only.
    """
    values, vectors = np.linalg.eigh(W)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = np.random.default_rng(0).standard_normal((rows.r.size, _DRAWN))

    def limit(tests: FloatArray, one_sided: BoolArray, share: float) -> float:
        through = tests @ root
        size = np.linalg.norm(through, axis=1)
        seen = size > np.sqrt(_TOLD)
        if not seen.any():
            return float("inf")
        z = (through[seen] / size[seen, None]) @ draws
        z = np.where(one_sided[seen, None], z, np.abs(z))
        return float(np.quantile(z.max(axis=0), 1.0 - share * OBJECTED))

    data = np.eye(len(rows.names), rows.r.size)
    suspects = np.array([gamma for _, gamma in rows.asked]).reshape(-1, rows.r.size)
    one_sided = np.array([direction.tolerance.one_sided for direction, _ in rows.asked], dtype=np.bool_)
    two_sided = np.zeros(len(data), dtype=np.bool_)
    return limit(data, two_sided, _BY_DATA), limit(suspects, one_sided, 1.0 - _BY_DATA)


def _suspects(
    rows: CheckedData, precision: FloatArray, limit: float
) -> tuple[tuple[UndetectedError, ...], tuple[Tolerance, ...]]:
    """Return the suspected errors that would not be revealed at any place, and those to be explained."""
    unseen: dict[str, UndetectedError] = {}
    suspected: dict[str, Tolerance] = {}
    _, moved = _left(rows, precision)
    for direction, gamma in rows.asked:
        tolerance = direction.tolerance
        W, _ = _left(rows, precision, tolerance.beyond)
        power, pull = max(float(gamma @ W @ gamma), 0.0), -float(gamma @ W @ rows.r)
        possible = pull > 0.0 or not tolerance.one_sided
        if possible and pull**2 > limit**2 * max(power, _TOLD):
            suspected[tolerance.name] = tolerance
        size = tolerance.std * ((limit + _SURELY) / sqrt(power) if power > 0.0 else np.inf)
        known = unseen.get(tolerance.name)
        if size > tolerance.std and (known is None or size > known.seen_from):
            unseen[tolerance.name] = UndetectedError(tolerance, size, moved @ gamma)
    return tuple(unseen.values()), tuple(suspected.values())


def _checks(
    rows: CheckedData, fitted: set[str], W: FloatArray, Wr: FloatArray, limit: float
) -> tuple[DatumCheck, ...]:
    """Return each datum with its prediction from all others."""
    own = np.diag(W)
    judged = [i for i in range(len(rows.names)) if own[i] > _TOLD and np.isfinite(rows.scale[i])]
    stray = _strays(W, Wr, judged, limit)
    checks = []
    for i in judged:
        # residuals are of model over measured values
        miss, name = -float(Wr[i] / own[i] * rows.scale[i]), rows.names[i]
        by = miss if name.startswith("α") else exp(min(miss, 50.0)) - 1.0
        std = float(rows.scale[i] / np.sqrt(own[i]))
        checks.append(DatumCheck(name, by, std, name in fitted, i in stray))
    return tuple(checks)


def _strays(W: FloatArray, Wr: FloatArray, judged: Sequence[int], limit: float) -> set[int]:
    """Return the data that contradict the others: the worst, then the next worst without it, and so on.

    One outlier makes other data that were fitted with it appear wrong.
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
    """Return the single errors that reduce χ² most, each name once.

    A tolerance that allows for a part of a suspect is the same error, and is left out where that is named.
    """
    best: dict[str, Explanation] = {}
    for direction, gamma in columns:
        seen = float(gamma @ W @ gamma)
        if seen < 1e-9:
            continue
        tolerance, size = direction.tolerance, -float(gamma @ Wr) / seen
        if abs(size) > _LARGEST or (tolerance.one_sided and size < 0.0):
            continue
        one = Explanation(tolerance, size * tolerance.std, size, float(gamma @ Wr) ** 2 / seen)
        if one.gain >= max(_WORTH, best[tolerance.name].gain if tolerance.name in best else 0.0):
            best[tolerance.name] = one
    suspects = {one.tolerance.beyond for one in best.values()}
    named = [one for one in best.values() if one.tolerance.name not in suspects]
    return tuple(sorted(named, key=lambda one: -one.gain)[:_MOST])
