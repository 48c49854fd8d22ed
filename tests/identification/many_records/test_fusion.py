"""Many records: closed forms of the mean, identities through crossings, intervals that shrink."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification import IdentificationSettings, fuse, identify, mac
from jackettwin.identification.many_records.fusion import Average, average, random_effects
from jackettwin.identification.many_records.sightings import Sightings
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.synthetic import simulate
from jackettwin.intervals import NORMAL_90
from jackettwin.study.many_records.document import fused_mode_document

RNG = np.random.default_rng


@pytest.fixture(scope="module")
def results():
    from jackettwin.identification.synthetic import ModalSystem

    shapes = np.kron(np.array([[1.0, 0.4, 0.2]]), np.eye(2))
    system = ModalSystem(np.array([0.300, 0.306]), np.array([0.03, 0.015]), shapes, np.eye(2))
    return system, [
        identify(simulate(system, np.random.default_rng([7, k]), sample_rate_hz=3.0)) for k in range(20)
    ]


def test_equal_records_give_the_plain_mean():
    mean, variance, between = random_effects(np.array([0.0, 0.1, 0.2]), np.full(3, 0.05))
    assert (mean, variance, between) == pytest.approx((0.1, 0.05 / 3, 0.0))


def test_scatter_beyond_the_records_own_uncertainty_is_found(rng):
    values = rng.normal(0.0, 0.5, 2000) + rng.normal(0.0, 0.1, 2000)
    mean, variance, between = random_effects(values, np.full(2000, 0.01))
    # standard error of a variance from 2000 values: 3 %
    assert between == pytest.approx(0.25, rel=0.12)
    assert variance == pytest.approx(0.26 / 2000, rel=0.12)
    assert abs(mean) < 4 * np.sqrt(variance)


@pytest.mark.parametrize(("scatter", "low", "high"), [(0.0, 0.88, 0.95), (5.0, 0.86, 0.93)])
def test_intervals_of_four_records_hold_the_mean_whether_these_scatter_or_not(
    scatter: float, low: float, high: float, rng
) -> None:
    """Nominal 90 %, ± 3.5 standard errors of 700 sets and, without scatter, what cannot be excluded."""
    held = 0
    for values in rng.normal(0.0, np.hypot(1.0, scatter), (700, 4)):
        mean, variance, _ = random_effects(values, np.ones(4))
        held += abs(mean) < NORMAL_90 * np.sqrt(variance)
    assert low < held / 700 < high


def test_a_close_pair_is_fused_apart_and_its_intervals_hold_the_truth(results):
    system, found = results
    fused = fuse(found)
    shapes = np.array([mode.mode_shape for mode in fused.modes])
    for f, zeta, shape in zip(system.frequency_hz, system.damping_ratio, system.mode_shapes, strict=True):
        mode = fused.modes[int(np.argmax(mac(shape, shapes)))]
        assert mac(shape, mode.mode_shape) > 0.98
        # four standard errors
        assert abs(np.log(mode.frequency_hz / f)) < 4 * mode.frequency_std_hz / mode.frequency_hz
        assert abs(np.log(mode.damping_ratio / zeta)) < 4 * mode.damping_ratio_std / mode.damping_ratio
        single = found[0].modes[0].damping_ratio_std / found[0].modes[0].damping_ratio
        assert mode.damping_ratio_std / mode.damping_ratio < 0.5 * single


def test_modes_that_cross_keep_their_shapes(results):
    """The same records with the two frequencies swapped in half of them: shape decides."""
    _, found = results
    swapped = []
    for k, result in enumerate(found):
        factor = 1.0 if k % 2 else 0.98
        modes = tuple(
            replace(m, frequency_hz=m.frequency_hz * (factor if abs(m.mode_shape[0]) > 0.7 else 1.0))
            for m in result.modes
        )
        swapped.append(replace(result, modes=modes))
    fused = fuse(swapped)
    for mode in fused.modes[:2]:
        members = zip(mode.sightings.record, mode.sightings.mode, strict=True)
        same = [mac(swapped[r].modes[m].mode_shape, mode.mode_shape) for r, m in members]
        assert np.median(same) > 0.9
        assert min(same) > 0.5


def test_a_doubtful_estimate_says_nothing_where_the_mode_is_clear_elsewhere(results):
    """Half of the records doubt the first mode 2 % higher: it is fused from the others, and stays ok."""
    _, found = results
    clear = [replace(one, modes=one.modes[:1]) for one in found]
    doubt = Finding("decay_weak", params={"ratio": 1.0})

    def doubted(one):
        mode = one.modes[0].flagged(ModeStatus.DOUBTFUL, doubt)
        return replace(one, modes=(replace(mode, frequency_hz=1.02 * mode.frequency_hz),))

    (alone,) = fuse(clear[:10]).modes
    (mode,) = fuse([*clear[:10], *map(doubted, clear[10:])]).modes
    assert (mode.status, mode.records_ok, len(mode.sightings)) == (ModeStatus.OK, 10, 20)
    assert mode.frequency_hz == pytest.approx(alone.frequency_hz, rel=1e-12)
    assert mode.damping_ratio == pytest.approx(alone.damping_ratio, rel=1e-12)
    (mostly,) = fuse([*clear[:8], *map(doubted, clear[8:])]).modes
    assert mostly.status == ModeStatus.DOUBTFUL
    assert mostly.frequency_hz == pytest.approx(fuse(clear[:8]).modes[0].frequency_hz, rel=1e-12)
    (never,) = fuse(map(doubted, clear)).modes
    assert never.status == ModeStatus.DOUBTFUL and never.records_ok == 0


def test_a_record_that_does_not_tell_the_damping_tells_the_frequency(results):
    _, found = results
    unknown = Finding("decay_damping_unknown", params={"spread": 1.0})
    clear = [replace(one, modes=one.modes[:1]) for one in found]
    vague = [
        replace(
            one,
            modes=(replace(one.modes[0].flagged(ModeStatus.DAMPING_UNKNOWN, unknown), damping_ratio=0.2),),
        )
        for one in clear[10:]
    ]
    (mode,) = fuse([*clear[:10], *vague]).modes
    assert mode.damping_ratio == pytest.approx(fuse(clear[:10]).modes[0].damping_ratio, rel=1e-12)
    assert mode.frequency_std_hz < 0.9 * fuse(clear[:10]).modes[0].frequency_std_hz


def test_a_quick_look_at_several_records_states_no_intervals(results):
    """Its modes are not checked, and no record states an uncertainty that could be fused."""
    quick = IdentificationSettings(blocks=0, refine=False)
    fused = fuse(identify(simulate(results[0], rng, sample_rate_hz=3.0), quick) for rng in map(RNG, (1, 2)))
    assert fused.modes
    names = [channel.name for channel in fused.channels]
    for mode in fused.modes:
        document = fused_mode_document(mode, names)
        assert document["status"] == "unchecked"
        assert document["frequency_hz"] == mode.frequency_hz
        assert document["frequency_interval_90"] is document["damping_ratio_std"] is None


def test_order_of_records_does_not_matter(results):
    _, found = results
    forward, backward = fuse(found), fuse(found[::-1])
    f = [mode.frequency_hz for mode in forward.modes]
    # sums in another order
    np.testing.assert_allclose([mode.frequency_hz for mode in backward.modes][:2], f[:2], rtol=1e-3)


def test_nothing_to_fuse_is_refused():
    with pytest.raises(InputError, match="nothing to fuse"):
        fuse([])


def test_the_covariance_of_ln_f_and_ln_zeta_is_that_within_records() -> None:
    """Scatter between records widens both deviations and adds nothing to their product."""
    n, own, rho = 8, np.array([1e-3, 0.1]), 0.6
    covariance = np.outer(own, own) * np.array([[1.0, rho], [rho, 1.0]])
    nodes = np.full((n, 3, 3), np.nan)

    def averaged(scatter: float) -> Average:
        moved = scatter * np.array([1.0, -1.0] * (n // 2))
        record, zero = np.arange(n), np.zeros(n, dtype=np.int64)
        seen = Sightings(
            record, zero, 0.3 * np.exp(moved), np.full(n, 0.01), np.full(n, 600.0),
            np.tile(covariance, (n, 1, 1)), zero, nodes,
        )  # fmt: skip
        return average(seen)

    still, moving = averaged(0.0), averaged(0.02)
    assert still.log_covariance == pytest.approx(covariance / n, rel=1e-6)
    assert moving.log_std[0] > 5.0 * still.log_std[0]
    assert moving.log_covariance[0, 1] == pytest.approx(still.log_covariance[0, 1], rel=0.01)
