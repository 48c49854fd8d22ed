"""Evidence of a cause whose direction is uncertain, against the densities that it is a ratio of."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import erfc
from scipy.stats import multivariate_normal

from jackettwin.watching.causes import Cause, sensor_noise, sizes_about
from jackettwin.watching.change import Change
from jackettwin.watching.diagnosis import (
    TAIL,
    _free,
    _in_noise,
    _judge,
    _likelihood,
    _loudness,
    _misfit,
    _moved,
    _of_two,
    diagnose,
    explained_share,
)

KINDS = ("frequency", "damping", "frequency")


def case(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, Cause]:
    root = rng.standard_normal((3, 3))
    sizes = np.array([-0.5, 0.3, 2.0])
    cause = Cause("any", rng.standard_normal((4, 3)), sizes, np.zeros(3))
    return root @ root.T + np.eye(3), rng.standard_normal(3), cause


def changed(info: np.ndarray, score: np.ndarray) -> Change:
    none = np.zeros(len(score))
    return Change(
        0.0, "scatter", "any", 0.0, (0.0, 0.0), none > 0.0, none, none, info[None], score[None], np.zeros(1),
        np.zeros((1, len(score), 3)), 0.0, none,
    )  # fmt: skip


def test_the_evidence_is_that_of_a_normal_direction(rng: np.random.Generator) -> None:
    """X = A⁻¹b is N(θJ, A⁻¹ + θ²RRᵀ) if it is the cause, N(0, A⁻¹) if nothing changed."""
    info, score, cause = case(rng)
    noise, root = np.linalg.inv(info), _misfit(cause, KINDS)
    x, J = noise @ score, cause.draws.mean(axis=0)
    expected = [
        multivariate_normal(size * J, noise + size**2 * root @ root.T).logpdf(x)
        - multivariate_normal(np.zeros(3), noise).logpdf(x)
        for size in cause.sizes
    ]
    np.testing.assert_allclose(_likelihood(info[None], score[None], cause, KINDS)[0], expected)


def test_a_free_step_is_normal_too(rng: np.random.Generator) -> None:
    info, score, _ = case(rng)
    noise, std = np.linalg.inv(info), np.array([0.5, 2.0, 0.0])
    x = noise @ score
    expected = (
        multivariate_normal(np.zeros(3), noise + np.diag(std**2)).logpdf(x)
        - multivariate_normal(np.zeros(3), noise).logpdf(x)
    )  # fmt: skip
    np.testing.assert_allclose(_free(info[None], score[None], std), [expected])


def test_draws_that_differ_make_the_direction_uncertain_where_they_do(rng: np.random.Generator) -> None:
    cause = case(rng)[2]
    same = np.tile([1.0, 0.5, 1.0], (5, 1))
    turned = same + np.array([0.3, 0.0, -0.3]) * np.array([-1, -0.5, 0, 0.5, 1])[:, None]
    roots = (_misfit(replace(cause, draws=draws), KINDS) for draws in (same, turned))
    alone, together = (root @ root.T for root in roots)
    assert alone[0, 2] == 0.0 and together[0, 2] < 0.0
    np.testing.assert_allclose((together - alone)[0, 0], 0.3**2 * 2.5 / 4, rtol=0.1)  # misfit grows a little


def test_a_large_step_is_not_many_small_ones_where_it_is_bent() -> None:
    at, bend = np.array([0.0, 1.0, 3.0]), np.array([[0.0, -0.5], [0.0, 0.0], [0.0, 1.0]])
    cause = Cause("bent", np.array([[1.0, 0.0]]), np.ones(1), np.zeros(1), bent_at=at, bend=bend)
    found = cause.steps(np.array([-1.0, 0.5, 1.0, 3.0, 5.0]))
    np.testing.assert_allclose(found, [[-1.0, 1.0], [0.5, -0.125], [1.0, 0.0], [3.0, 3.0], [5.0, 5.0]])


def test_a_direction_may_miss_by_more_than_is_usual(rng: np.random.Generator) -> None:
    """The evidence is the mean over sizes and over how far a direction may miss."""
    info, score, cause = case(rng)
    cause = replace(cause, log_size_weights=np.full(3, -np.log(3.0)))
    noise, J = np.linalg.inv(info), cause.draws.mean(axis=0)
    x = noise @ score
    roots = {times: _misfit(cause, KINDS, times) for times in TAIL}
    density = sum(
        share / 3.0 * multivariate_normal(size * J, noise + size**2 * roots[times] @ roots[times].T).pdf(x)
        for times, share in TAIL.items()
        for size in cause.sizes
    )
    none = multivariate_normal(np.zeros(3), noise).pdf(x)
    np.testing.assert_allclose(_judge([(0.0, changed(info, score))], cause, KINDS)[0], np.log(density / none))


def test_what_no_size_of_a_cause_explains_is_told_by_its_chance() -> None:
    """A wrong clock moves all frequencies alike, exactly: across that, χ² has one degree of freedom."""
    sizes, weights = sizes_about(1e-3, 1.2, both_ways=True)
    clock = Cause("clock", np.ones((1, 2)), sizes, weights, misfit=0.0)
    noise, kinds = 2e-4, ("frequency", "frequency")
    for across in (0.5, 2.0, 3.0):
        seen = -2e-3 + noise * across / np.sqrt(2.0) * np.array([1.0, -1.0])
        change = changed(np.eye(2) / noise**2, seen / noise**2)
        assert explained_share(change, clock, kinds) == pytest.approx(erfc(across / np.sqrt(2.0)), rel=0.02)
        first = diagnose(change, (clock,), kinds)
        is_clock = first.verdicts[0].cause == "clock"
        assert is_clock is (across < 3.0) and bool(np.isnan(first.explained)) is not is_clock
    loose = replace(clock, misfit=0.1)  # what a model may miss explains more
    assert explained_share(change, loose, kinds) > 2.0 * explained_share(change, clock, kinds)


def test_no_cause_is_favoured_for_its_usual_size() -> None:
    """Two that do the same, one by a third of what is usual: a large change is either's alike."""
    kinds, info = ("frequency",), np.array([[1e8]])
    causes = [
        Cause(name, np.array([[unit]]), *sizes_about(1.0, 0.8), misfit=0.03)
        for name, unit in (("scour", -1e-3), ("soil", -3e-3))
    ]
    for change in (-1e-3, -4e-3):
        one, other = (_judge([(0.0, changed(info, info[0] * change))], cause, kinds)[0] for cause in causes)
        assert abs(one - other) < 0.1


def test_a_size_beyond_the_usual_ones_is_unlikely_and_not_impossible() -> None:
    """A clock that runs 3 % wrong, as at 100 Hz for 97, was something else with certainty."""
    (sizes, weights), kinds = (
        sizes_about(1e-3, 1.2, both_ways=True, larger=True, finer=5), ("frequency",) * 4
    )  # fmt: skip
    far = np.abs(sizes) > 1e-3 * np.exp(2.4)
    assert np.exp(weights).sum() == pytest.approx(1.0) and np.exp(weights[far]).sum() == pytest.approx(0.05)
    clock = Cause("clock", np.ones((1, 4)), sizes, weights, misfit=0.0)
    middle = 1e-3 * np.exp(4.8 * (0.5 / 0.95 - 0.5))  # half of all are below
    assert clock.usual == pytest.approx(middle, rel=0.01)
    assert sizes_about(0.1, 0.8, larger=True, largest=1.0)[0].max() < 1.0
    change = changed(np.eye(4) / 3e-4**2, np.full(4, 0.03 / 3e-4**2))
    first = diagnose(change, (clock,), kinds).verdicts[0]
    assert first.cause == "clock" and first.probability > 0.9 and abs(first.size / 0.03 - 1.0) < 0.05


def test_two_causes_together_have_the_density_of_their_sum(rng: np.random.Generator) -> None:
    """X is N(θJ + μ, A⁻¹ + θ²RRᵀ + C) of a first of every other size θ and a second that is N(μ, C)."""
    info, score, one = case(rng)
    one = replace(one, log_size_weights=np.log([0.2, 0.3, 0.5]))
    other = replace(one, name="other", draws=rng.standard_normal((4, 3)), prior=3.0)
    second = [
        (size, share, size * other.draws.mean(axis=0))
        for size, share in zip(one.sizes, (0.2, 0.3, 0.5), strict=True)
    ]
    noise, x = np.linalg.inv(info), np.linalg.solve(info, score)

    def missed(cause: Cause, size: float, times: float = 1.0) -> np.ndarray:
        return size**2 * _misfit(cause, KINDS, times) @ _misfit(cause, KINDS, times).T

    def density(size: float, times: float, mu: np.ndarray, spread: np.ndarray) -> float:
        wide = noise + missed(one, size, times) + spread
        return float(multivariate_normal(size * one.draws.mean(axis=0) + mu, wide).pdf(x))

    firsts = [(size, share * w, t) for size, w, _ in second[::2] for t, share in TAIL.items()]
    alone = sum(w * density(size, t, np.zeros(3), np.zeros((3, 3))) for size, w, t in firsts)
    both = sum(
        w * share * density(size, t, mu, missed(other, of))
        for size, w, t in firsts
        for of, share, mu in second
    )  # fmt: skip
    found = _of_two(changed(info, score), (one, other), np.array([2.0, 1.0]), KINDS)
    assert found.keys() == {"any and other"}
    expected = 2.0 + np.log(0.02 * 3.0 / 4.0) + np.log(both / alone)
    assert found["any and other"] == pytest.approx(expected, rel=1e-6)  # the ridge is 1e-9


def test_two_changes_at_once_are_told_where_one_does_not_explain_all() -> None:
    def cause(name: str, *effect: float) -> Cause:
        return Cause(name, np.array([effect]), *sizes_about(1.0, 0.8), misfit=0.02)

    a, b, c = (
        cause("a", -0.003, -0.003, 0.0, 0.0), cause("b", 0.0, 0.0, -0.002, -0.004),
        cause("c", 0.0, -0.003, -0.003, 0.0),
    )  # fmt: skip

    def told(size_b: float, *alone: str) -> str:
        seen = a.steps(np.ones(1))[0] + size_b * b.steps(np.ones(1))[0]
        change = changed(np.eye(4) / 2e-4**2, seen / 2e-4**2)
        first = diagnose(change, (a, b, c), ("frequency",) * 4, alone).verdicts[0]
        assert first.probability > 0.8
        return first.cause

    assert told(0.0) == "a"
    assert {*told(2.0).split(" and ")} == {"a", "b"}
    assert told(-2.0) == told(2.0, "b") == "something else"  # b acts in one sense only


def test_the_mean_of_louder_noise_lies_further_off(rng: np.random.Generator) -> None:
    """X = A⁻¹b is N(0, GA⁻¹G + S) of a failing sensor, N(0, A⁻¹) if nothing changed."""
    info, score, _ = case(rng)
    noise, std, louder = np.linalg.inv(info), np.array([0.5, 0.1, 0.3]), np.array([2.5, 1.0, 4.0])
    x = noise @ score
    wide = np.diag(louder) @ noise @ np.diag(louder) + np.diag(std**2)
    expected = (
        multivariate_normal(np.zeros(3), wide).logpdf(x)
        - multivariate_normal(np.zeros(3), noise).logpdf(x)
    )  # fmt: skip
    change = changed(info, score)
    np.testing.assert_allclose(_moved(change, louder[None], std), [expected], rtol=1e-6)  # the ridge is 1e-9


QUANTITIES = (("frequency", 0), ("damping", 0), ("frequency", 1))


def test_a_cause_in_louder_noise_is_normal_as_well(rng: np.random.Generator) -> None:
    """X = A⁻¹b is N(θJ, GA⁻¹G + θ²RRᵀ) if it is the cause and noise is louder by G."""
    info, score, cause = case(rng)
    cause = replace(cause, log_size_weights=np.full(3, -np.log(3.0)))
    change = replace(changed(info, score), log_scatter=np.full((1, 3, 3), 2.0))
    sensor = sensor_noise(QUANTITIES)
    total, louder = _loudness(change, sensor)
    ((weight, known),) = _in_noise(change, sensor)
    noise, J = np.linalg.inv(info), cause.draws.mean(axis=0)
    x, wide = noise @ score, np.diag(louder[0]) @ noise @ np.diag(louder[0])
    roots = {times: _misfit(cause, KINDS, times) for times in TAIL}
    density = sum(
        share / 3.0 * multivariate_normal(s * J, wide + s**2 * roots[times] @ roots[times].T).pdf(x)
        for times, share in TAIL.items()
        for s in cause.sizes
    )
    none = multivariate_normal(np.zeros(3), noise).pdf(x)
    expected = np.log(0.05) + total[0] + np.log(density / none)
    found = _judge([(weight, known)], cause, KINDS)[0]
    np.testing.assert_allclose(found, expected, rtol=1e-6)  # the ridge is 1e-9


def test_a_large_change_of_noisy_records_is_no_sensor_and_a_small_one_is() -> None:
    """−3 % of all modes in threefold scatter: a sensor shifts none by more than some tenths of a per cent."""
    info = np.diag([1e7, 1e3, 1e7])
    quiet = np.zeros((1, 3, 3))
    loud = np.tile([20.0, 60.0, 40.0], (1, 3, 1))
    alike = Cause("softer", np.array([[1.0, 0.0, 1.0]]), *sizes_about(6e-3, 0.8, both_ways=True))
    causes = (alike, sensor_noise(QUANTITIES))

    def first(size: float, scatter: np.ndarray) -> str:
        score = info @ (size * np.array([1.0, 0.0, 1.0]))
        return diagnose(replace(changed(info, score), log_scatter=scatter), causes, KINDS).verdicts[0].cause

    assert first(-0.03, quiet) == first(-0.03, loud) == "softer"
    assert first(-0.0003, loud) == "sensor: more scatter"


def test_a_size_is_as_uncertain_as_the_scale_of_its_effect() -> None:
    """Where draws differ by a factor s alone and a change δ is known, θ is δ/(J s): as wide in ln as s.

    Draws of which one moves another quantity are no scale, and widen nothing.
    """
    ln_s = 0.5 * np.array([-1.5, -0.7, -0.2, 0.2, 0.7, 1.5])
    J, precise = np.array([1.0, 0.5, 2.0]), np.diag([1e8, 1e8, 1e8])
    sizes, weights = sizes_about(0.1, 1.2, larger=True)
    scaled = Cause("soil", np.exp(ln_s)[:, None] * J, sizes, weights, misfit=1e-3)
    delta = 0.1 * J
    _, mid, (low, high) = _judge([(0.0, changed(precise, precise @ delta))], scaled, KINDS)
    assert mid == pytest.approx(0.1, rel=0.05)
    wide = 1.645 * np.std(ln_s, ddof=1)
    # of 99 factors one is at 4.5, the next at 5.6 %: within 0.05 standard deviations, and steps of the sizes
    assert np.log(high / mid) == pytest.approx(wide, rel=0.05)
    assert np.log(mid / low) == pytest.approx(wide, rel=0.05)
    shaped = J + np.array([[0.0, 0.0, x] for x in (-1.0, 0.0, 1.0)])
    other = Cause("mass", shaped, sizes, weights, misfit=1e-3)
    _, mid, (low, high) = _judge([(0.0, changed(precise, precise @ delta))], other, KINDS)
    assert np.log(high / low) < 0.1


def test_a_cause_is_judged_at_the_onset_that_is_likely_and_not_at_the_largest_step() -> None:
    """In louder noise an onset can be out of the question that has the largest step."""
    J = np.array([1.0, 0.5, 2.0])
    cause = Cause("mass", J[None], *sizes_about(0.1, 1.2))
    info = np.stack([1e4 * np.eye(3), 1e4 * np.eye(3)])
    score = np.stack([info[0] @ np.array([2.0, -3.0, 1.0]), info[1] @ (0.1 * J)])
    change = replace(changed(info[0], score[0]), info=info, score=score, log_stake=np.array([-1e6, 0.0]))
    assert explained_share(change, cause, KINDS) > 0.9
    assert explained_share(replace(change, log_stake=np.zeros(2)), cause, KINDS) < 1e-6
