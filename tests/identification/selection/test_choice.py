"""What is reported: refined where the model fits, plain where it does not, and why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.selection.choice import PAIR_WIDENING
from jackettwin.identification.synthetic import ModalSystem, simulate


def test_refined_modes_state_both_estimates_and_the_bound(tower, rng):
    result = identify(simulate(tower, rng, sample_rate_hz=5.0))
    assert len(result.modes) == 4
    for mode in result.modes:
        assert mode.method == "maximum likelihood"
        assert mode.unrefined is not None
        assert mode.unrefined.method == "ssi-cov"
        assert mode.cramer_rao_log_std is not None
        assert mode.cramer_rao_log_std[1] == pytest.approx(mode.damping_ratio_cov_limit, rel=0.5)
        assert mode.mode_shape.imag == pytest.approx(0.0)
        low, high = mode.damping_ratio_interval_90
        assert low < mode.damping_ratio < high


def test_refinement_can_be_switched_off(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    plain = identify(record, IdentificationSettings(refine=False))
    assert {mode.method for mode in plain.modes} == {"ssi-cov"}
    both = [mode.unrefined for mode in identify(record).modes]
    np.testing.assert_array_equal(
        [mode.frequency_hz for mode in plain.modes], [mode.frequency_hz for mode in both]
    )


def test_units_of_a_channel_change_nothing_but_its_shape(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    factor = np.ones((len(record.data), 1))
    factor[2] = 1000.0
    modes = identify(record).modes
    for mode, other in zip(modes, identify(replace(record, data=record.data * factor)).modes, strict=True):
        # rounding, and a climb that stops at 2 % of a standard deviation
        assert other.damping_ratio == pytest.approx(mode.damping_ratio, rel=1e-3)
        assert mode.mode_shape[2] / mode.mode_shape[0] == pytest.approx(
            other.mode_shape[2] / other.mode_shape[0] / 1000.0, rel=1e-2, abs=1e-4
        )


def test_remaining_gaps_leave_the_modes_unrefined_and_say_so(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    data = record.data.copy()
    for start in range(200, 3000, 300):
        data[:, start : start + 30] = np.nan
    result = identify(replace(record, data=data))
    assert any("gaps remain" in text for text in result.warnings)
    assert {mode.method for mode in result.modes} == {"ssi-cov"}


def test_a_gap_in_the_middle_costs_its_length_alone(tower, rng):
    """Both sides are fitted together: standard deviations grow as by a record that much shorter."""
    record = simulate(tower, rng, sample_rate_hz=5.0)
    data = record.data.copy()
    data[:, 1300:1900] = np.nan
    whole, gappy = identify(record).modes, identify(replace(record, data=data)).modes
    for mode, other, zeta in zip(whole, gappy, tower.damping_ratio, strict=True):
        assert mode.method == other.method == "maximum likelihood"
        std, shorter = (np.sqrt(np.diag(m.log_covariance)) for m in (mode, other))
        # 20 % of the record; the estimated spectra differ, and with them the bounds
        assert np.mean(shorter / std) == pytest.approx(np.sqrt(1.0 / 0.8), rel=0.25)
        assert abs(np.log(other.damping_ratio / zeta)) < 2.5 * shorter[1]


def test_modes_are_refined_on_a_stretch_that_is_most_of_the_record(tower, rng):
    """What is refined is that of the stretch alone; its first eighth and a gap stand for no time."""
    record = simulate(tower, rng, sample_rate_hz=5.0)
    gone, cut = record.data.copy(), replace(record, data=record.data[:, 480:])
    gone[:, 400:480] = np.nan
    result, alone = identify(replace(record, data=gone)), identify(cut)
    assert not any("gaps remain" in text for text in result.warnings)
    for mode, same in zip(result.modes, alone.modes, strict=True):
        assert mode.method == same.method == "maximum likelihood"
        # the poles from which the fits start are those of other samples, and so is what they admit
        assert abs(mode.frequency_hz - same.frequency_hz) < 2.0 * same.frequency_std_hz
        assert mode.damping_ratio_std == pytest.approx(same.damping_ratio_std, rel=0.5)


def test_damping_of_a_close_pair_that_no_fit_describes_is_known_less_well(rng):
    pair = ModalSystem(np.array([0.3, 0.302, 1.0]), np.full(3, 0.01), np.eye(3), np.diag([1.0, 1.0, 4.0]))
    record = simulate(pair, rng, sample_rate_hz=5.0, duration_s=1800.0)
    data = record.data.copy()
    for start in range(200, 9000, 300):  # no stretch of twenty cycles is left to fit
        data[:, start : start + 10] = np.nan
    record = replace(record, data=data)
    plain = identify(record, IdentificationSettings(refine=False)).modes
    modes = identify(record).modes
    wider = [m.damping_ratio_std / p.damping_ratio_std for m, p in zip(modes, plain, strict=True)]
    np.testing.assert_allclose(wider, [PAIR_WIDENING, PAIR_WIDENING, 1.0], rtol=1e-9)
    np.testing.assert_allclose([m.frequency_std_hz for m in modes], [p.frequency_std_hz for p in plain])


def test_a_steady_tone_is_taken_out_before_the_fit(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    plain = identify(record)
    t = np.arange(record.data.shape[1]) / 5.0
    tone = np.sqrt(2.0) * record.data.std(axis=1, keepdims=True) * np.sin(2.0 * np.pi * 0.7003 * t)
    disturbed = identify(replace(record, data=record.data + tone))
    assert any("steady tone" in r.reason for r in disturbed.rejected)
    for mode in plain.modes:
        other = min(disturbed.modes, key=lambda m: abs(m.frequency_hz - mode.frequency_hz))
        # the tone is farther than 6 half bandwidths from every mode
        assert other.damping_ratio == pytest.approx(mode.damping_ratio, rel=0.05)


def test_a_fit_that_breaks_down_leaves_what_the_subspace_method_found(tower, rng, monkeypatch):
    from jackettwin.identification.maximum_likelihood import fits

    def broken(*args, **kwargs):
        raise np.linalg.LinAlgError("singular")

    record = simulate(tower, rng, sample_rate_hz=5.0)
    monkeypatch.setattr(fits, "refine", broken)
    # what does not fit the whole band is refined in narrow ones
    narrow = identify(record)
    assert not narrow.warnings
    assert {mode.method for mode in narrow.modes} == {"maximum likelihood"}
    monkeypatch.setattr(fits, "refine_group", broken)
    result = identify(record)
    assert any("broke down" in text for text in result.warnings)
    assert {mode.method for mode in result.modes} == {"ssi-cov"}


def test_a_short_record_says_what_it_is_too_short_for(tower, rng):
    """Half a minute: nine cycles of the first pair, which no spectrum of it shows."""
    record = simulate(tower, rng, duration_s=30.0, sample_rate_hz=10.0)
    result = identify(record)
    assert any("30 s contain" in text and "cycles" in text for text in result.warnings)
    assert any("the band starts at" in text for text in result.warnings)
    assert not [t for t in identify(simulate(tower, rng, sample_rate_hz=5.0)).warnings if "cycles" in t]


def test_one_of_two_copies_is_used(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    data = record.data.copy()
    data[3] = data[2]
    result = identify(replace(record, data=data))
    assert any("a3: is a copy of a2" in text for text in result.warnings)
    assert [c.name for c in result.channels] == ["a0", "a1", "a2", "a4", "a5", "a6", "a7"]


def test_a_pair_half_left_out_is_hinted_at(tower, rng):
    from jackettwin.identification.selection.candidates import Candidate
    from jackettwin.identification.selection.choice import _hidden, _sorted
    from jackettwin.identification.selection.clustering import Cluster

    settings = IdentificationSettings(refine=False)
    result = identify(simulate(tower, rng, sample_rate_hz=5.0), settings)
    cluster = Cluster(np.arange(3), np.arange(3), 0, 0.4, 1.3)
    judged = [Candidate(cluster, mode, "in 40% of the model orders", None) for mode in result.modes]
    whole = _sorted(judged, dict(enumerate(result.modes)), (), result.settings, settings, ())
    assert _hidden(judged, whole) == []
    half = dict(list(enumerate(result.modes))[1:])
    hints = _hidden(judged, _sorted(judged, half, (), result.settings, settings, ()))
    assert [hint.code for hint in hints] == ["hidden_mode"]
    assert f"near {result.modes[1].frequency_hz:.4g} Hz" in hints[0].text
