"""The spectrum of the modes alone: that of the record if they are all, short of it if one is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import Identification, IdentificationSettings, identify
from jackettwin.identification.maximum_likelihood.spectral_fit import modal_fit
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record


@pytest.fixture(scope="module")
def record() -> Record:
    system = ModalSystem(
        np.array([0.5, 0.55, 1.6]), np.array([0.02, 0.01, 0.015]),
        np.array([[1.0, 0.4, 0.1], [-0.2, 1.0, 0.5], [0.5, -0.6, 1.0]]), np.diag([1.0, 0.5, 1.0]),
    )  # fmt: skip
    return simulate(system, np.random.default_rng(4), duration_s=1800.0, sample_rate_hz=8.0)


@pytest.fixture(scope="module")
def found(record: Record) -> Identification:
    settings = IdentificationSettings(lowest_frequency_hz=0.3, highest_frequency_hz=3.0, refine=False)
    return identify(record, settings)


def ratio(record: Record, found: Identification, near_hz: float) -> float:
    """Return the median of fitted over measured first singular values within 5 % of a frequency."""
    fit = modal_fit(record, found)
    assert fit is not None
    whole = found.spectrum
    near = np.abs(fit.frequencies_hz / near_hz - 1.0) < 0.05
    at = np.isin(whole.frequencies_hz, fit.frequencies_hz[near])
    return float(np.median(fit.singular_values[0][near] / whole.singular_values[0][at]))


def test_all_modes_give_the_measured_spectrum(record: Record, found: Identification) -> None:
    for f in (0.5, 0.55, 1.6):
        # 15 half-overlapping segments, some ten lines: 10 % a standard deviation
        assert ratio(record, found, f) == pytest.approx(1.0, abs=0.3)


def test_a_missing_mode_shows(record: Record, found: Identification) -> None:
    without = replace(found, modes=found.modes[:2])
    assert ratio(record, without, 1.6) < 0.3
    assert ratio(record, without, 0.5) == pytest.approx(1.0, abs=0.3)


def test_densities_are_in_the_channels_units(record: Record, found: Identification) -> None:
    loud = replace(record, data=record.data * np.array([[10.0], [1.0], [1.0]]))
    shapes = [m.mode_shape * np.array([10.0, 1.0, 1.0]) for m in found.modes]
    modes = tuple(replace(m, mode_shape=shape) for m, shape in zip(found.modes, shapes, strict=True))
    fit, plain = modal_fit(loud, replace(found, modes=modes)), modal_fit(record, found)
    assert fit is not None and plain is not None
    np.testing.assert_allclose(fit.density[0], 100.0 * plain.density[0], rtol=1e-4)
    np.testing.assert_allclose(fit.singular_values[0], plain.singular_values[0], rtol=1e-4)


def test_displacement_is_acceleration_over_omega_squared(record: Record, found: Identification) -> None:
    """The same numbers called displacement: another fit, since the same modal forces move them otherwise."""
    called = tuple(Channel(c.name, "displacement", "m") for c in record.channels)
    other = modal_fit(replace(record, channels=called), found)
    plain = modal_fit(record, found)
    assert other is not None and plain is not None
    high = plain.frequencies_hz > 2.5
    # far above the modes displacement falls by f⁴ against acceleration, down to the noise
    assert np.all(other.singular_values[0][high] < plain.singular_values[0][high])


def test_no_modes_no_fit(record: Record, found: Identification) -> None:
    assert modal_fit(record, replace(found, modes=())) is None
