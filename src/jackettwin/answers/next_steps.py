"""Ranking of further measurements by how far each would narrow the intervals of the ground.

The data's information JᵀJ is computed again with the standard deviations that the further measurement would
have, at draws from the posterior. The model's own error stays: no number of records takes it away.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import exp, log, sqrt

import numpy as np

from jackettwin.answers.result import NextStep
from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90
from jackettwin.response import damping_ratio
from jackettwin.study import MeasuredMode
from jackettwin.updating import DASHPOTS, USABLE, Problem, Residuals, State, Target, Update, information

_POINTS = 6
"""Draws of the posterior at which the information is computed: their mean is of interest, not their tails."""
_CALM = 0.1
"""Share of its damping that a parked rotor keeps in a calm: it is proportional to the wind."""
_DECAY = 0.03
"""Relative standard deviation of a damping ratio from a few free decays after a stop of the rotor."""
_MOST = 4096
"""Times as many records up to which their number is sought."""
_FIRST_PAIR = (1, 2)
_MORE_MODES = {"torsion": ("torsion_1",), "second_bending": ("fore_aft_2", "side_side_2")}
"""Modes that more sensors would show."""
_FOOT_AMPLITUDE, _FOOT_PHASE_RAD = 0.1, 0.01
"""Accuracy of a foot's motion relative to the tower's by synchronous accelerometers: 10 % and 0.6°."""


def next_steps(
    u: Update, measured: Sequence[MeasuredMode], names: Sequence[str], labels: Sequence[str], *, days: float
) -> tuple[NextStep, ...]:
    """Return what could be measured for parameters that are not identified, the most telling first.

    Before all of it comes what needs no measurement: to fit frequencies that were measured and not fitted.

    Parameters
    ----------
    names : of the parameters that are to become known
    labels : of the model's modes, by number
    days : of records that there are; 0 without any
    """
    known = u.uncertainty
    if known is None or not names or not u.problem.weighted:
        return ()
    problem, all_names = u.problem, [p.name for p in u.problem.parameters]
    draws = known.log_theta[:: max(1, len(known.log_theta) // _POINTS)][:_POINTS]
    own = {m.mode: m for m in measured}
    now = {v.name: v.interval_factor for v in known.verdicts}
    base = _stds(problem, draws)
    if base is None:
        return ()

    def factors(changed: Problem) -> dict[str, float] | None:
        after = _stds(changed, draws)
        if after is None:
            return None
        ratio = dict(zip(all_names, np.minimum(after / base, 1.0), strict=True))
        return {name: exp(log(max(now[name], 1.0)) * ratio[name]) for name in names}

    steps = [
        NextStep(what, found)
        for what, changed in _candidates(problem, own, labels, draws.mean(axis=0)).items()
        if (found := factors(changed)) is not None
    ]
    unfitted, more = _with_unfitted(problem, own)
    free = factors(more) if unfitted else None
    steps.append(NextStep("feet", _at_the_feet(u, names, now)))
    if days > 0.0:
        steps.append(_more_records(lambda k: factors(_repeated(problem, own, k)), days))
    steps.sort(key=lambda step: _left(step.factors))
    return (*([] if free is None else [NextStep("modes", free, modes=unfitted)]), *steps)


def _at_the_feet(u: Update, names: Sequence[str], now: Mapping[str, float]) -> dict[str, float]:
    """Return what motion measured at the feet leaves open.

    A foot moves by force over D = k(1 + iη): its amplitude beside the tower's gives k, its lag η.
    """
    known, found = u.uncertainty, {}
    for j, p in enumerate(u.problem.parameters):
        if p.name not in names or known is None:
            continue
        suffixes = u.model.tie_groups.suffixes
        suffix = next((s for s in suffixes if s and p.name.endswith(s)), suffixes[0])
        loss = known.predictive.support.get(f"loss_factor{suffix}", np.ones(1))
        stiff = p.name.startswith("k") and not p.name.startswith("k1")
        std = _FOOT_AMPLITUDE if stiff else _FOOT_PHASE_RAD / float(np.median(loss))
        own = max(float(known.log_std[j]), 1e-9)
        found[p.name] = exp(log(max(now[p.name], 1.0)) / sqrt(1.0 + (own / std) ** 2))
    return found


def _left(factors: Mapping[str, float]) -> float:
    """Return what stays unknown, as the mean logarithm of the factors."""
    return sum(map(log, factors.values())) / len(factors)


def _more_records(factors: Callable[[float], dict[str, float] | None], days: float) -> NextStep:
    """Return the least number of records, as a multiple, that makes everything known; else the most tried."""
    k, found = 1, factors(1.0) or {}
    while k < _MOST and max(found.values()) > USABLE:
        k *= 4
        found = factors(float(k)) or found
    return NextStep("records", found, days * k)


def _candidates(
    problem: Problem, own: Mapping[int, MeasuredMode], labels: Sequence[str], z: FloatArray
) -> dict[str, Problem]:
    """Return the problem after each further measurement."""
    first = problem.states[0]
    found = {"model": _without_model_error(problem, own)}
    rotor = [i for i, p in enumerate(problem.model.parameters) if p.name in DASHPOTS]
    pair = [own[mode] for mode in _FIRST_PAIR if mode in own and own[mode].damping_ratio]
    if pair and not first.errors.any():
        decays = tuple(Target(m.mode, None, None, m.damping_ratio, _DECAY * _ratio(m)) for m in pair)
        found["decays"] = _with_state(problem, decays, rotor)
    for what, wanted in _MORE_MODES.items():
        modes = tuple(n for n, label in enumerate(labels, 1) if label in wanted and n not in own)
        if modes:
            found[what] = _with_modes(problem, modes, z)
    if "model" in found and _same(found["model"], problem):
        del found["model"]
    return found


def _with_modes(problem: Problem, modes: tuple[int, ...], z: FloatArray) -> Problem:
    """Return a problem with more modes, known as well as those that are measured are on average."""
    first = problem.states[0]
    reaching = problem.on(problem.model.reaching(max(modes)))
    pole = reaching.model.predict_many(reaching.vectors(z[None], first), modes).poles[0]
    f, zeta = np.abs(pole) / (2.0 * np.pi), damping_ratio(pole)
    known = first.residuals.targets
    of_f = [_share(t.frequency_std_hz, t.frequency_hz) for t in known if t.frequency_hz]
    of_zeta = [_share(t.damping_ratio_std, t.damping_ratio) for t in known if t.damping_ratio]
    targets = tuple(
        Target(
            mode,
            *(float(f[i]), float(f[i] * np.mean(of_f))) if of_f else (None, None),
            *(float(zeta[i]), float(zeta[i] * np.mean(of_zeta))) if of_zeta else (None, None),
        )
        for i, mode in enumerate(modes)
        if np.isfinite(pole[i])
    )
    return _with_state(reaching, targets, []) if targets else problem


def _with_unfitted(problem: Problem, own: Mapping[int, MeasuredMode]) -> tuple[tuple[int, ...], Problem]:
    """Return the measured modes whose frequency is not fitted, and the problem with their frequencies."""
    fitted = {t.mode for t in problem.states[0].residuals.targets if t.frequency_hz is not None}
    targets = tuple(
        Target(mode, m.frequency_hz, m.frequency_std_hz)
        for mode, m in sorted(own.items())
        if mode not in fitted and m.frequency_hz and m.frequency_std_hz
    )
    modes = tuple(t.mode for t in targets)
    if not modes:
        return (), problem
    return modes, _with_state(problem.on(problem.model.reaching(max(modes))), targets, [])


def _share(std: float | None, value: float) -> float:
    return (std or 0.0) / value


def _ratio(m: MeasuredMode) -> float:
    return m.damping_ratio or 0.0


def _same(a: Problem, b: Problem) -> bool:
    same = all(s.residuals == t.residuals for s, t in zip(a.states, b.states, strict=True))
    return same and a.error_model is b.error_model


def _with_state(problem: Problem, targets: tuple[Target, ...], rotor: list[int]) -> Problem:
    """Return a problem with one more state, in which these dashpots do as little as in a calm."""
    first = problem.states[0]
    residuals = Residuals(targets, relative=False)
    shifts = first.shifts.copy()
    shifts[rotor] += log(_CALM)
    more = State("more", residuals, first.weights, shifts, np.zeros((residuals.count, first.errors.shape[1])))
    return replace(problem, states=(*problem.states, more))


def _without_model_error(problem: Problem, own: Mapping[int, MeasuredMode]) -> Problem:
    return _changed(problem, own, records=1.0, error=0.0).plain


def _repeated(problem: Problem, own: Mapping[int, MeasuredMode], times: float) -> Problem:
    """Return the problem with so many times as many records."""
    return _changed(problem, own, records=times, error=1.0)


def _changed(problem: Problem, own: Mapping[int, MeasuredMode], *, records: float, error: float) -> Problem:
    """Return the problem with other standard deviations; the model's error is in the first state."""
    states = []
    for i, state in enumerate(problem.states):
        targets = tuple(
            _target(t, own.get(t.mode) if i == 0 else None, records, error) for t in state.residuals.targets
        )
        states.append(replace(state, residuals=Residuals(targets, relative=False)))
    return replace(problem, states=tuple(states))


def _target(t: Target, m: MeasuredMode | None, records: float, error: float) -> Target:
    own_f = None if m is None else m.frequency_std_hz
    own_zeta = None if m is None else m.damping_ratio_std
    return replace(
        t,
        frequency_std_hz=_std(t.frequency_std_hz, own_f, records, error),
        damping_ratio_std=_std(t.damping_ratio_std, own_zeta, records, error),
    )


def _std(total: float | None, own: float | None, records: float, error: float) -> float | None:
    """Return the standard deviation of the measurement's part (all, if not known) and the model's."""
    if total is None:
        return None
    measured = total if own is None else min(own, total)
    return sqrt(measured**2 / records + error**2 * max(total**2 - measured**2, 0.0))


def _stds(problem: Problem, draws: FloatArray) -> FloatArray | None:
    """Return the standard deviation (d,) of ln θ to expect, its mean square over the draws."""
    precision = np.diag(problem.prior.std**-2.0)
    near = problem.anchor(draws.mean(axis=0))
    known = [m for m in (information(problem, z, near) for z in draws) if m is not None]
    if not known:
        return None
    variances = [np.diag(np.linalg.inv(m + precision)) for m in known]
    return np.asarray(np.sqrt(np.mean(variances, axis=0)))


def records_for(measured: Sequence[MeasuredMode], records: int, precision: float) -> dict[str, int]:
    """Return how many records each mode's damping needs to be known to ± ``precision`` (90 %).

    Its standard deviation falls with the root of their number, as the records' scatter does. Only of modes
    that are not known as well already.
    """
    wanted = precision / NORMAL_90
    found = {}
    for m in measured:
        if m.damping_ratio and m.damping_ratio_std and records:
            times = (m.damping_ratio_std / m.damping_ratio / wanted) ** 2
            if times > 1.0:
                found[m.label] = int(np.ceil(records * times))
    return found
