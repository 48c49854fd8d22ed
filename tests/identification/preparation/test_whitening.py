"""The same motion as acceleration, velocity and displacement: the same modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose

from jackettwin.identification import (
    Identification,
    IdentificationSettings,
    fuse,
    identify,
    mac,
)
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.preparation.whitening import accelerated, differentiated
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

RATE = 20.0
UNITS = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}
FLOORS = np.arange(1, 5)
F = np.array([1.434, 2.100, 2.95, 4.10, 5.90])
ZETA = np.array([0.006, 0.008, 0.006, 0.007, 0.006])


def frame_shapes() -> npt.NDArray[np.float64]:
    """Shapes of a frame of four floors: bending along x and y, torsion, and the next two bending modes.

    A floor has one sensor along x and two along y, on either side; shapes are those of a shear frame,
    sin((2k − 1)πm/9).
    """
    first, second = np.sin(np.pi * FLOORS / 9.0), np.sin(3.0 * np.pi * FLOORS / 9.0)
    x, y, turned = [1.0, 0.05, 0.05], [0.05, 1.0, 1.0], [0.6, 1.0, -1.0]
    rows = [(first, x), (first, y), (first, turned), (second, x), (second, y)]
    return np.array([np.kron(along, floor) for along, floor in rows])


def frame(sensors: list[int], quantity: str, *, seed: int = 1, noise: float = 0.02) -> Record:
    """Return 300 s of a quantity: the middle of a longer record, integrated while it is periodic."""
    system = ModalSystem(F, ZETA, frame_shapes()[:, sensors], np.eye(5), noise_ratio=noise)
    long = simulate(system, np.random.default_rng(seed), duration_s=900.0, sample_rate_hz=RATE)
    n = long.data.shape[1]
    i_omega = 2j * np.pi * np.fft.rfftfreq(n, 1.0 / RATE)
    lines = np.fft.rfft(long.data, axis=1)
    lines[:, 1:] /= i_omega[1:] ** list(UNITS).index(quantity)
    lines[:, 0] = 0.0
    y = np.fft.irfft(lines, n, axis=1)[:, n // 3 : 2 * n // 3]
    channels = tuple(Channel(f"s{i}", quantity, UNITS[quantity]) for i in sensors)
    return Record(y, RATE, channels, name=f"{quantity} {sensors}")


@pytest.fixture(scope="module")
def accelerations() -> Identification:
    return identify(frame([0, 2, 3, 5, 7, 9, 11], "acceleration"))


def assert_same_modes(found: Identification, reference: Identification) -> None:
    assert len(found.modes) == len(reference.modes) == 5
    for mode, same in zip(found.modes, reference.modes, strict=True):
        # the ends of a record are differentiated less well than its middle, and the fit groups other lines:
        # small beside what the record itself leaves open, of which half is allowed
        assert mode.status == same.status == "ok"
        assert same.frequency_std_hz is not None
        assert abs(mode.frequency_hz - same.frequency_hz) < 0.5 * same.frequency_std_hz
        assert mac(mode.mode_shape, same.mode_shape) > 0.999


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
def test_what_a_sensor_measures_does_not_change_the_modes(
    quantity: str, accelerations: Identification
) -> None:
    found = identify(frame([0, 2, 3, 5, 7, 9, 11], quantity))
    assert {channel.quantity for channel in found.channels} == {quantity}
    assert_same_modes(found, accelerations)


def test_velocities_beside_accelerations_make_one_shape(accelerations: Identification) -> None:
    a, v = (frame([0, 2, 3, 5, 7, 9, 11], quantity) for quantity in ("acceleration", "velocity"))
    mixed = replace(a, data=np.vstack([a.data[:3], v.data[3:]]), channels=a.channels[:3] + v.channels[3:])
    assert_same_modes(identify(mixed), accelerations)


@pytest.mark.parametrize("declared", ["acceleration", "velocity", "displacement"])
def test_a_quantity_that_is_wrong_loses_no_mode(declared: str) -> None:
    record = frame([0, 2, 3, 5, 7, 9, 11], "acceleration")
    named = tuple(Channel(c.name, declared, UNITS[declared]) for c in record.channels)
    found = identify(replace(record, channels=named))
    assert_allclose([mode.frequency_hz for mode in found.modes], F, rtol=5e-3)


def test_roving_velocities_make_the_shapes_of_the_frame() -> None:
    settings = IdentificationSettings(blocks=20)
    setups = [[0, 2, 4, 9, k, 12 - k] for k in (1, 3, 5)] + [[0, 2, 4, 9, 6, 8, 10]]
    found = fuse(
        [identify(frame(rows, "velocity", seed=k), settings) for k, rows in enumerate(setups)],
    )
    order = [int(channel.name[1:]) for channel in found.channels]
    assert sorted(order) == list(range(12))
    assert_allclose([mode.frequency_hz for mode in found.modes], F, rtol=3e-3)
    for mode, shape in zip(found.modes, frame_shapes(), strict=True):
        assert mac(mode.mode_shape, shape[order]) > 0.99


@pytest.mark.parametrize(("quantity", "times"), [("velocity", 1), ("displacement", 2)])
def test_a_clean_record_becomes_accelerations(quantity: str, times: int) -> None:
    record = frame([0, 2, 3, 5], quantity)
    fast, differentiations = accelerated(record)
    assert list(differentiations) == [times] * 4
    true = frame([0, 2, 3, 5], "acceleration").data
    f, density = (welch(y, RATE) for y in (fast.data - true, true))
    # within the band that decimation keeps; point reflection at the ends leaves the last half of a percent
    band = (f.frequencies_hz > 1.0) & (f.frequencies_hz < 6.4)
    assert np.all(f.density[:, band].mean(axis=1) < 2e-4 * density.density[:, band].mean(axis=1))


def test_noise_of_a_sensor_is_not_lifted_until_it_decides() -> None:
    record = frame([0, 2, 3, 5], "displacement")
    rms = record.data.std(axis=1, keepdims=True)
    noisy = record.data + 0.05 * rms * np.random.default_rng(3).standard_normal(record.data.shape)
    assert accelerated(replace(record, data=noisy))[1].max() < 2


def test_a_record_that_was_integrated_in_silence_is_differentiated() -> None:
    record = frame([0, 2, 3, 5], "displacement")
    silent = replace(record, channels=tuple(Channel(c.name) for c in record.channels))
    assert accelerated(silent)[1].min() >= 1


def test_derivative_of_a_sine_is_a_cosine() -> None:
    t = np.arange(2000) / RATE
    omega = 2.0 * np.pi * 1.3
    y = np.sin(omega * t)
    inside = slice(100, -100)
    assert_allclose(
        differentiated(y, RATE, 1)[inside], (omega * np.cos(omega * t))[inside], atol=1e-3 * omega
    )
    assert_allclose(differentiated(y, RATE, 2)[inside], (-(omega**2) * y)[inside], atol=2e-3 * omega**2)


def test_a_gap_stays_a_gap_and_spoils_little() -> None:
    t = np.arange(2000) / RATE
    y = np.sin(2.0 * np.pi * 0.5 * t)
    y[[0, 700, 701, 1200, 1999]] = np.nan
    out = differentiated(y, RATE, 1)
    assert np.array_equal(np.isnan(out), np.isnan(y))
    whole = np.pi * np.cos(2.0 * np.pi * 0.5 * t)
    # a cubic spline over three steps of a cycle of 32 is right to 1e-3
    assert_allclose(out[40:-40][~np.isnan(out[40:-40])], whole[40:-40][~np.isnan(out[40:-40])], atol=0.02)


def test_the_spectrum_is_that_of_what_was_measured() -> None:
    record = frame([0, 2, 3, 5], "velocity")
    shown = identify(record, IdentificationSettings(refine=False)).spectrum
    plain = welch(record.data - record.data.mean(axis=1, keepdims=True), RATE)
    peak = int(np.argmax(np.where(plain.frequencies_hz > 1.0, plain.density[0], 0.0)))
    at = int(np.argmin(np.abs(shown.frequencies_hz - plain.frequencies_hz[peak])))
    assert_allclose(shown.density[0, at], plain.density[0, peak], rtol=0.05)
