"""The detection limit of relaxations in ambient vibration is one of 95 % power, for the search as it is."""

from __future__ import annotations

from dataclasses import replace
from math import log

import numpy as np
import pytest
from scipy import signal, stats

from jackettwin.errors import InputError
from jackettwin.identification import IdentificationSettings, ambient_limits, limits_document
from jackettwin.identification.pole_methods import relaxations
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.relaxation_limits import ALIKE, TRIALS, AmbientLimits, with_relaxation
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

SETTINGS = IdentificationSettings(refine=False, real_poles=True, lowest_frequency_hz=0.25)
RATE = 6.0


@pytest.fixture(scope="module")
def record() -> Record:
    shapes = np.array([[1.0, 0.4, 0.1], [-0.3, 1.0, 0.5]])
    system = ModalSystem(np.array([0.5, 1.3]), np.array([0.02, 0.015]), shapes, np.diag([4.0, 0.2]))
    y = simulate(system, np.random.default_rng(1), duration_s=900.0).data
    return Record(y / y.std(), 20.0, tuple(Channel(f"d{i}", "displacement", "m") for i in range(3)))


@pytest.fixture(scope="module")
def limits(record: Record) -> AmbientLimits:
    return ambient_limits(record, SETTINGS, rates=(RATE,))


def share_found(record: Record, rms: float, n: int, seed: int) -> int:
    """Return how many of n processes of an rms are found, in the record's own noise."""
    ready, rng, found = prepare(record, SETTINGS), np.random.default_rng(seed), 0
    for _ in range(n):
        y = with_relaxation(ready.y, RATE, ready.settings.sample_rate_hz, rms, rng)
        there = relaxations(replace(ready, y=y), SETTINGS)
        found += any(abs(log(p.rate_rad_s / RATE)) < log(ALIKE) for p in there)
    return found


def test_at_the_limit_about_95_percent_are_found(record: Record, limits: AmbientLimits) -> None:
    """Two-sided: fresh trials at the interval's upper end and below its lower end, binomial at 0.1 %."""
    (one,) = limits.limits
    low, high = one.interval_90
    assert one.trials == TRIALS and low < one.rms_share < high < 20.0 * low
    n = 40
    assert share_found(record, high, n, 5) >= stats.binom.ppf(0.001, n, 0.95)
    assert share_found(record, 0.5 * low, n, 6) <= stats.binom.ppf(0.999, n, 0.95) - 3


def test_the_process_that_is_added_is_of_first_order() -> None:
    """Autocorrelation exp(−aτ), the rms as asked for in the mean over the channels."""
    rng, y = np.random.default_rng(2), np.tile([[1.0, -1.0]], (3, 100_000))
    added = with_relaxation(y, 2.0, 10.0, 0.5, rng) - y
    assert np.sqrt(np.mean(added**2)) == pytest.approx(0.5, rel=0.02)  # 20,000 s hold 20,000 relaxation times
    one = added[0] / added[0].std()
    lags = np.array([0, 5, 10])
    found = [float(np.mean(one[: one.size - k] * one[k:])) for k in lags]
    np.testing.assert_allclose(found, np.exp(-2.0 * lags / 10.0), atol=0.03)
    assert np.abs(np.corrcoef(added)).min() == pytest.approx(1.0)
    assert signal.welch(one)[1].argmax() < 3


def test_the_document_has_no_infinity(limits: AmbientLimits) -> None:
    (one,) = limits.limits
    never = replace(limits, limits=(replace(one, rms_share=float("inf")),))
    assert limits_document(never)["limits"][0]["rms_share"] is None
    said = limits_document(limits)
    assert said["kind"] == "ambient" and said["power"] == 0.95
    assert said["band_rad_s"][0] == pytest.approx(2.0 * np.pi * 0.25)


def test_a_method_without_uncertainty_is_refused(record: Record) -> None:
    with pytest.raises(InputError, match="real poles need the uncertainty of ssi-cov"):
        ambient_limits(record, SETTINGS.with_method("plscf"), rates=(RATE,))
