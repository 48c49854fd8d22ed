r"""What a fitted model cannot explain, and which error would explain it.

About the best fit, residuals r of all measured data, whitened by what is measured, follow

.. math:: r \sim N(0, K), \quad K = I + ΓΓ^T + J P^{-1} J^T, \qquad W = K^{-1}.

A datum left out is missed by :math:`(Wr)_i/W_{ii}` with variance :math:`1/W_{ii}` (Rasmussen & Williams 2006,
5.12), whether it was fitted or not. A direction γ of unknown size takes :math:`(γ^T W r)^2/γ^T W γ` off χ².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np
from scipy.special import chdtrc, ndtri

from jackettwin.arrays import FloatArray
from jackettwin.updating.data.misfit import UNLIKELY
from jackettwin.updating.data.targets import Residuals, Target
from jackettwin.updating.model_error.directions import Direction, Tolerance, ToleranceDirections
from jackettwin.updating.model_error.marginal import covariance
from jackettwin.updating.problem import Problem, State

_MOST = 3
"""Explanations that are named."""
_LARGEST = 8.0
"""Standard deviations of a tolerance beyond which it is no explanation: nor does the first order hold."""
_WORTH = 4.0
"""χ² that an explanation takes off to be one: two standard deviations."""
_TOLD = 1e-9
"""Precision, in that of the measurement, below which the others say nothing of a datum."""
_SEEN = 1.0
"""Standard deviations of the data by which a suspect at its size must move them to be seen."""


@dataclass(frozen=True)
class DatumCheck:
    """A measured value beside what all the others say of it.

    Attributes
    ----------
    datum : str
        ``f1``, ``ζ4``.
    miss : float
        Measured over predicted, less one.
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


@dataclass(frozen=True)
class Objection:
    """What a fitted model does not explain.

    Attributes
    ----------
    checks : tuple of DatumCheck
        Of every measured value, fitted or not.
    chi2, freedom, probability : float
        Of all values that are fitted and frequencies that are not.
    explanations : tuple of Explanation
        The best first; empty where nothing is to be explained.
    unseen : tuple of Tolerance
        Suspects that these data would not show.
    """

    checks: tuple[DatumCheck, ...]
    chi2: float
    freedom: int
    probability: float
    explanations: tuple[Explanation, ...] = ()
    unseen: tuple[Tolerance, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether chance does not explain what was measured."""
        return self.probability < UNLIKELY or any(check.objects for check in self.checks)


def objection(
    problem: Problem,
    z: FloatArray,
    beside: Sequence[Target] = (),
    suspects: Sequence[Direction] = (),
) -> Objection | None:
    """Return what a problem's best fit (d,) of ln θ leaves unexplained; None without standard deviations.

    Parameters
    ----------
    beside : modes that were measured and not fitted; of these the frequencies are checked
    suspects : directions beside those of the error model that may explain it
    """
    whole = _with_beside(problem, beside)
    if not problem.weighted:
        return None
    found = whole.anchor(z)
    if found is None:
        return None
    r, J = _own(whole, z)
    gains = whole.gains(found)[0]
    flat = np.array([p.median is None for p in problem.parameters])
    precision = np.diag(np.where(flat, problem.prior.std**-2.0, 0.0))
    pulls, pull_rows = problem.prior.rows(z)
    # priors that are not flat are data of their own
    r, J = np.concatenate([r, pulls]), np.concatenate([J, pull_rows])
    gains = np.concatenate([gains, np.zeros((pulls.size, gains.shape[1]))])
    inverse = np.linalg.inv(covariance(gains))
    information = J.T @ inverse @ J + precision
    W = inverse - inverse @ J @ np.linalg.solve(information, J.T @ inverse)
    Wr = W @ r
    chi2 = float(r @ Wr)
    used = int((np.linalg.svd(J * problem.prior.std, compute_uv=False) > 0.5).sum())
    freedom = max(r.size - used, 1)
    checks = _checks(problem, whole, W, Wr)
    result = Objection(checks, chi2, freedom, float(chdtrc(freedom, max(chi2, 0.0))))
    columns = _columns(whole, found, suspects, pulls.size)
    unseen = {c.tolerance.name: c.tolerance for c, _ in columns[1]}
    for c, gamma in columns[1]:
        if gamma @ W @ gamma >= _SEEN**2:
            unseen.pop(c.tolerance.name, None)
    result = replace(result, unseen=tuple(unseen.values()))
    if not result.objects:
        return result
    return replace(result, explanations=_explanations([*columns[0], *columns[1]], W, Wr))


def _with_beside(problem: Problem, beside: Sequence[Target]) -> Problem:
    """Return the problem with the frequencies of modes that were not fitted."""
    first = problem.states[0]
    known = {t.mode: t for t in first.residuals.targets}
    for t in beside:
        own = known.get(t.mode, Target(t.mode))
        if own.frequency_hz is None and t.frequency_hz is not None and t.frequency_std_hz is not None:
            known[t.mode] = replace(own, frequency_hz=t.frequency_hz, frequency_std_hz=t.frequency_std_hz)
    targets = tuple(known[mode] for mode in sorted(known))
    if targets == tuple(sorted(first.residuals.targets, key=lambda t: t.mode)):
        return problem
    model = problem.model.reaching(max(known))
    residuals = Residuals(targets, relative=False)
    errors = problem.error_model
    place = {name: row for row, name in enumerate(first.residuals.names)}
    own_errors = np.zeros((residuals.count, first.errors.shape[1]))
    for row, name in enumerate(residuals.names):
        if name in place:
            own_errors[row] = first.errors[place[name]]
    state: State = replace(first, residuals=residuals, errors=own_errors)
    return replace(
        problem,
        model=model,
        states=(state, *problem.states[1:]),
        error_model=None if errors is None else errors.on(model.condensed),
    )


def _own(problem: Problem, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return residuals and Jacobian of the data alone, whitened by what is measured alone."""
    r, J, _ = problem.plain.evaluate(z, None)
    return r[: problem.n_data], J[: problem.n_data]


def _checks(problem: Problem, whole: Problem, W: FloatArray, Wr: FloatArray) -> tuple[DatumCheck, ...]:
    """Return each datum beside what all the others say of it."""
    names, fitted = whole.data_names, set(problem.data_names)
    limit = -float(ndtri(0.5 * UNLIKELY / max(len(names), 1)))
    scale = np.concatenate([_log_std(state) for state in whole.states])
    own = np.diag(W)
    judged = [i for i in range(len(names)) if own[i] > _TOLD and np.isfinite(scale[i])]
    stray = _strays(W, Wr, judged, limit)
    # residuals are of the model over the measured
    return tuple(
        DatumCheck(
            names[i],
            exp(min(-Wr[i] / own[i] * scale[i], 50.0)) - 1.0,
            float(scale[i] / np.sqrt(own[i])),
            names[i] in fitted,
            i in stray,
        )
        for i in judged
    )


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


def _log_std(state: State) -> FloatArray:
    """Return the measured standard deviation of each datum's logarithm; NaN of shapes and relaxations."""
    of = {}
    for t in state.residuals.used:
        of[f"f{t.mode}"], of[f"ζ{t.mode}"] = t.log_stds
    return np.array([of.get(name) or np.nan for name in state.names], dtype=np.float64)


_Column = tuple[Direction, FloatArray]


def _columns(
    whole: Problem, found: tuple[object, ...], suspects: Sequence[Direction], n_pulls: int
) -> tuple[list[_Column], list[_Column]]:
    """Return the directions of the error model and of suspects with what they do to the residuals."""
    errors = whole.error_model
    if errors is None:
        return [], []
    both = (errors.directions.each, tuple(suspects))
    result: list[list[_Column]] = []
    for each in both:
        directions = ToleranceDirections(
            errors.directions.assembly, whole.model.condensed, each, errors.directions.n_soil
        )
        model = replace(errors, directions=directions)
        gains = replace(whole, error_model=model).gains(found)[0][:, : len(each)]  # type: ignore[arg-type]
        gains = np.concatenate([gains, np.zeros((n_pulls, len(each)))])
        result.append(list(zip(each, gains.T, strict=True)))
    return result[0], result[1]


def _explanations(columns: list[_Column], W: FloatArray, Wr: FloatArray) -> tuple[Explanation, ...]:
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
