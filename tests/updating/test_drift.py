"""Drift over days: a closed form, false alarms at their rate, a planted drift found."""

import numpy as np
import pytest
from calibration import are_standard, is_calibrated
from scipy.stats import norm

from jackettwin.errors import InputError
from jackettwin.updating import Problem, Residuals, SupportModel, Target, joint
from jackettwin.updating.drift import find_drift
from jackettwin.updating.joint import Growth

MODES, DAYS, TRUTH = (1, 2, 4), 6, np.array([3e9, 0.1])
ERRORS = {f"f{mode}": 0.005 for mode in MODES}
F_STD, ZETA_STD = 5e-4, 0.1


def followed(model: SupportModel, growth: float, seed: int) -> Problem:
    """Return six days of stiffness that grows, seen through a model whose frequencies are 0.5 % off."""
    rng = np.random.default_rng(seed)
    off = 0.005 * rng.standard_normal(len(MODES))
    states = {}
    for day in range(DAYS):
        poles = model.predict(TRUTH * np.array([np.exp(growth * day), 1.0]), MODES).poles
        targets = []
        for mode, pole, error in zip(MODES, poles, off, strict=True):
            f = abs(pole) / (2 * np.pi) * np.exp(error + F_STD * rng.standard_normal())
            zeta = -pole.real / abs(pole) * np.exp(ZETA_STD * rng.standard_normal())
            targets.append(Target(mode, f, F_STD * f, zeta, ZETA_STD * zeta))
        states[str(day)] = (Residuals(tuple(targets), relative=False), {})
    days = {name: float(name) for name in states}
    return joint(model, states, errors=ERRORS, growth=Growth(("k",), days, 0.4))


START = np.log([*TRUTH, *(1.0 for _ in ERRORS)])


def test_the_interval_is_that_of_a_weighted_regression(models: dict[str, SupportModel]) -> None:
    """With one frequency a day and its slope s by ln k: σ/(s √Σ(t − t̄)²), whatever the model's error is."""
    model = models["maxwell-3"]
    f = abs(model.predict(TRUTH, (1,)).poles[0]) / (2 * np.pi)
    day = (Residuals((Target(1, f, F_STD * f),), relative=False), {})
    days = {str(t): float(t) for t in range(DAYS)}
    problem = joint(model, dict.fromkeys(days, day), errors={"f1": 0.005}, growth=Growth(("k",), days, 5.0))
    found = find_drift(problem, np.log([*TRUTH, 1.0]))
    assert found.slope_per_day == pytest.approx(0.0, abs=1e-6)
    slope = problem.evaluate(found.z, None)[1][0, 0] * F_STD
    # Σ(t − t̄)² of six days is 17.5; flat priors of k and the loss factor leave a thousandth
    assert found.std_per_day == pytest.approx(F_STD / (abs(slope) * np.sqrt(17.5)), rel=1e-2)
    assert not found.detected


def test_false_alarms_and_coverage(models: dict[str, SupportModel]) -> None:
    found = [find_drift(followed(models["maxwell-3"], 0.0, seed), START) for seed in range(16)]
    assert is_calibrated(sum(not drift.detected for drift in found), len(found), 0.95)
    covered = sum(drift.interval_90[0] < 0.0 < drift.interval_90[1] for drift in found)
    assert is_calibrated(covered, len(found), 0.9)
    assert are_standard(np.array([drift.slope_per_day / drift.std_per_day for drift in found]))
    low, high = found[0].interval_90  # as a normal distribution has it: 1.6449 deviations to either side
    assert (high - low) / found[0].std_per_day == pytest.approx(2.0 * norm.ppf(0.95), rel=1e-9)


def test_a_planted_drift_is_found_and_its_size_is_right(models: dict[str, SupportModel]) -> None:
    """Five per cent in five days: four standard deviations."""
    found = [find_drift(followed(models["maxwell-3"], -0.02, seed), START) for seed in range(4)]
    assert all(drift.detected and drift.slope_per_day < 0.0 for drift in found)
    errors = [(drift.slope_per_day + 0.02) / drift.std_per_day for drift in found]
    assert np.abs(errors).max() < 3.5  # one of two thousand
    median, low, high = found[0].line("k", np.array([0.0, 5.0])).T
    assert (low < median).all() and (median < high).all()
    assert median[1] / median[0] == pytest.approx(np.exp(5.0 * found[0].slope_per_day))


def test_days_that_scatter_more_than_they_say_widen_the_interval(models: dict[str, SupportModel]) -> None:
    model = models["maxwell-3"]
    f = abs(model.predict(TRUTH, (1,)).poles[0]) / (2 * np.pi)
    days = {str(t): float(t) for t in range(DAYS)}
    wild = f * np.exp(10 * F_STD * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))
    states = {
        day: (Residuals((Target(1, v, F_STD * v),), relative=False), {})
        for day, v in zip(days, wild, strict=True)
    }
    found = find_drift(joint(model, states, growth=Growth(("k",), days, 0.4)), np.log(TRUTH))
    steady = {day: (Residuals((Target(1, f, F_STD * f),), relative=False), {}) for day in days}
    calm = find_drift(joint(model, steady, growth=Growth(("k",), days, 0.4)), np.log(TRUTH))
    # the same sensitivities but for a fraction of a per cent of stiffness
    assert found.std_per_day == pytest.approx(found.scatter * calm.std_per_day, rel=0.05)
    # χ² of six residuals of ten deviations, on 6 − 3 degrees of freedom, less what the slope takes
    assert found.scatter == pytest.approx(np.sqrt(600 / 3), rel=0.1)
    assert not found.detected


def test_nothing_that_grows(models: dict[str, SupportModel]) -> None:
    day = Residuals((Target(1, 0.18, 0.001),), relative=False)
    with pytest.raises(InputError, match="no slope"):
        find_drift(joint(models["maxwell-3"], {"": (day, {})}), np.log(TRUTH))
