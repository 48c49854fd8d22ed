"""Rotor stops and pull-and-release tests: found, named, and identified as decays."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from jackettwin.errors import InputError
from jackettwin.identification import IdentificationSettings, identify, mac
from jackettwin.identification.decays import free_decay
from jackettwin.identification.decays.free_decay import MIN_EXPLAINED_FIRST, transient
from jackettwin.identification.decays.modes_of_decay import DecayFit, modes_of_decay
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

RATE, LENGTH = 10.0, 6000
T = np.arange(LENGTH) / RATE
F, ZETA = np.array([0.31, 0.95]), np.array([0.012, 0.012])
HEIGHT = np.array([0.25, 0.5, 0.75, 1.0])
SHAPES = np.array([np.append(HEIGHT**1.5, 0.1 * HEIGHT), np.append(np.sin(4.2 * HEIGHT), 0.2 * HEIGHT)])
SYSTEM = ModalSystem(F, ZETA, SHAPES, np.diag([1.0, 0.3]), noise_ratio=0.02)


def let_go(at_s: float, amplitudes: tuple[float, float], since: npt.NDArray[np.float64] = T) -> np.ndarray:
    """Return the accelerations of both modes from an instant on, (8 channels, n)."""
    omega, later = 2.0 * np.pi * F[:, None], np.maximum(since - at_s, 0.0)
    swing = np.exp(-ZETA[:, None] * omega * later) * np.cos(omega * later) * (since >= at_s)
    return np.asarray(SHAPES.T @ (np.array(amplitudes)[:, None] * swing))


def record(y: np.ndarray, quantity: str = "acceleration", unit: str = "m/s²") -> Record:
    return Record(y, RATE, tuple(Channel(f"s{i}", quantity, unit) for i in range(len(y))), name="stop")


def after_a_stop(seed: int) -> Record:
    """Return ten minutes in wind, in which a rotor stops at 150 s, with twenty times the motion."""
    wind = simulate(SYSTEM, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=RATE).data
    return record(wind / wind.std() * 0.1 + let_go(150.0, (4.0, 1.5)))


@pytest.mark.parametrize("seed", range(3))
def test_a_rotor_stop_is_a_decay(seed: int) -> None:
    found = identify(after_a_stop(seed))
    assert [(one.code, one.severity) for one in found.findings] == [("free_decay", "info")]
    assert not found.warnings
    assert {mode.method for mode in found.modes} == {"decay"}
    first = found.modes[0]
    assert first.status == "ok"
    assert first.frequency_interval_90 is not None
    assert first.damping_ratio_interval_90 is not None
    # 99 % intervals: eight of 90 % would fail in half of the runs of other seeds
    for value, (low, high), truth in (
        (first.frequency_hz, first.frequency_interval_90, F[0]),
        (first.damping_ratio, first.damping_ratio_interval_90, ZETA[0]),
    ):
        assert (low / value) ** 1.57 < truth / value < (high / value) ** 1.57
    assert mac(first.mode_shape, SHAPES[0].astype(complex)) > 0.99
    # nothing that is not of the structure is called ok
    for mode in found.modes:
        assert mode.status != "ok" or np.min(np.abs(np.log(mode.frequency_hz / F))) < 0.02


def test_a_channel_with_a_gap_hides_no_decay_from_the_others() -> None:
    whole = after_a_stop(0)
    data = whole.data.copy()
    data[1, 4000:] = np.nan
    found = identify(replace(whole, data=data))
    assert {mode.method for mode in found.modes} == {"decay"}
    assert [c.name for c in found.channels] == ["s0", *(f"s{i}" for i in range(2, 8))]
    assert "s1: 33% of the samples are missing; left out" in found.warnings


def test_pull_and_release_seen_as_displacement() -> None:
    omega = 2.0 * np.pi * F[:, None]
    swing = np.exp(-ZETA[:, None] * omega * T[:900]) * np.cos(omega * T[:900])
    y = SHAPES.T @ (np.array([[0.1], [0.01]]) * swing)
    noise = 2e-5 * np.random.default_rng(5).standard_normal((8, 1000))
    pulled = np.concatenate([np.repeat(y[:, :1], 100, axis=1), y], axis=1) + noise
    found = identify(record(pulled, "displacement", "m"))
    assert found.modes[0].method == "decay"
    assert abs(found.modes[0].frequency_hz / F[0] - 1.0) < 2e-3
    assert abs(found.modes[0].damping_ratio / ZETA[0] - 1.0) < 0.1


def test_damping_that_falls_with_the_amplitude_is_said() -> None:
    omega = 2.0 * np.pi * F[0]
    # ζ falls from 3 to 1 % over a minute
    exponent = omega * np.cumsum(0.01 + 0.02 * np.exp(-np.maximum(T - 30.0, 0.0) / 30.0)) / RATE
    swing = np.where(T >= 30.0, np.exp(-(exponent - exponent[300])) * np.cos(omega * (T - 30.0)), 0.0)
    y = np.outer(SHAPES[0], swing) + 2e-3 * np.random.default_rng(2).standard_normal((8, LENGTH))
    (mode,) = identify(record(y)).modes
    assert mode.status is ModeStatus.DOUBTFUL
    assert "changes with the amplitude" in str(mode.status_reason)


@pytest.mark.parametrize("duration_s", [120.0, 600.0])
def test_wind_is_no_decay(duration_s: float) -> None:
    settings = IdentificationSettings()
    for seed in range(15):
        wind = simulate(SYSTEM, np.random.default_rng(seed), duration_s=duration_s, sample_rate_hz=RATE)
        assert transient(wind, settings) is None


def test_a_gust_that_dies_down_is_no_decay_and_leaves_no_mode_ok() -> None:
    """Wind that falls by a factor of fifty: random forces go on, so damped cosines explain little."""
    wind = simulate(SYSTEM, np.random.default_rng(1), duration_s=600.0, sample_rate_hz=RATE).data
    settings = IdentificationSettings(refine=False)
    found = identify(record(wind * (0.02 + np.exp(-np.abs(T - 60.0) / 60.0))), settings)
    assert all(mode.method != "decay" for mode in found.modes)
    assert all(mode.status != "ok" for mode in found.modes)


LIVELY = ModalSystem(4.0 * F, ZETA, SHAPES, np.diag([1.0, 0.3]), noise_ratio=0.02)


@pytest.mark.parametrize(("zeta", "seed", "searches"), [(0.05, 3, 0), (0.012, 0, 1)])
def test_what_forces_shake_while_it_fades_is_searched_once_at_most(
    zeta: float, seed: int, searches: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every fit takes tenths of a second, and seconds for long records of many channels."""
    explained: list[float] = []

    def counted(*arguments: Any) -> DecayFit | None:
        found = modes_of_decay(*arguments)
        explained.extend([] if found is None else [found.fit.explained])
        return found

    monkeypatch.setattr(free_decay, "modes_of_decay", counted)
    shaken = replace(SYSTEM, damping_ratio=np.array([zeta, zeta]))
    wind = simulate(shaken, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=RATE).data
    found = transient(record(wind * np.exp(-T / 150.0)), IdentificationSettings())
    assert found is not None
    assert found.identified is None
    assert len(explained) == searches
    assert all(share < MIN_EXPLAINED_FIRST for share in explained)


def test_a_force_that_goes_on_for_a_while_puts_off_the_start() -> None:
    """Wind as strong as the decay acts for half a minute more; from there on the decay is read."""
    wind = simulate(SYSTEM, np.random.default_rng(2), duration_s=600.0, sample_rate_hz=RATE).data
    fading = wind / wind.std() * (0.002 + 0.3 / (1.0 + np.exp((T - 175.0) / 2.0)))
    found = identify(record(fading + let_go(150.0, (4.0, 1.5))))
    assert {mode.method for mode in found.modes} == {"decay"}
    (said,) = (f.text for f in found.findings if f.code == "free_decay")
    assert float(re.findall(r"([\d.]+) s", said)[0]) > 160.0
    for mode, f in zip(found.modes, F, strict=True):
        assert abs(mode.frequency_hz / f - 1.0) < 2e-3


@pytest.mark.parametrize("seed", range(3))
def test_the_start_of_a_simulation_is_left_out(seed: int) -> None:
    """It rings from rest while wind already acts: neither a free decay nor stationary."""
    wind = simulate(SYSTEM, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=RATE).data
    found = identify(record(wind / wind.std() * 0.25 + let_go(0.0, (4.0, 1.5))))
    assert any(f.code == "beside_knock" for f in found.findings)
    assert 400.0 < found.duration_s < 560.0
    assert [mode.status for mode in found.modes] == ["ok", "ok"]
    for mode, f, zeta in zip(found.modes, F, ZETA, strict=True):
        std_f, std_zeta = np.sqrt(np.diag(mode.log_covariance))
        assert abs(np.log(mode.frequency_hz / f)) < 4.0 * std_f
        assert abs(np.log(mode.damping_ratio / zeta)) < 4.0 * std_zeta


def knock(at_s: float) -> np.ndarray:
    """Return what a blow does to a tower that swings four times as fast, (8 channels, n)."""
    omega, later = 2.0 * np.pi * LIVELY.frequency_hz[:, None], np.maximum(T - at_s, 0.0)
    swing = np.exp(-ZETA[:, None] * omega * later) * np.cos(omega * later) * (T >= at_s)
    return np.asarray(SHAPES.T @ (np.array([[30.0], [10.0]]) * swing))


@pytest.mark.parametrize("at_s", [200.0, 480.0])
def test_a_knock_in_a_long_record_costs_what_it_touches_only(at_s: float) -> None:
    """Something bumps the tower far more strongly than wind: the rest of the record tells more."""
    wind = simulate(LIVELY, np.random.default_rng(4), duration_s=600.0, sample_rate_hz=RATE).data
    found = identify(record(wind / wind.std() + knock(at_s)))
    assert any(f.code == "beside_knock" for f in found.findings)
    assert found.duration_s < 600.0
    assert [mode.status for mode in found.modes] == ["ok", "ok"]
    for mode, f, zeta in zip(found.modes, LIVELY.frequency_hz, ZETA, strict=True):
        std_f, std_zeta = np.sqrt(np.diag(mode.log_covariance))
        assert abs(np.log(mode.frequency_hz / f)) < 4.0 * std_f
        assert abs(np.log(mode.damping_ratio / zeta)) < 4.0 * std_zeta


def test_a_knock_on_what_stands_still_is_identified_from_itself() -> None:
    noise = np.random.default_rng(3).standard_normal((8, LENGTH))
    settings = IdentificationSettings()
    assert transient(record(noise + knock(200.0)), settings).beside is None
    found = identify(record(noise + knock(200.0)))
    assert found.modes
    assert {mode.method for mode in found.modes} == {"decay"}


def short_pull(zeta: float, duration_s: float) -> Record:
    """Return a release after 3 s in a record that ends while the structure still swings, at 0.5 Hz."""
    t = np.arange(round(duration_s * RATE)) / RATE
    later = np.maximum(t - 3.0, 0.0)
    swing = np.exp(-zeta * np.pi * later) * np.cos(np.pi * later) * (t >= 3.0)
    noise = np.random.default_rng(3).standard_normal((3, t.size))
    return record(np.array([1.0, 0.6, 0.3])[:, None] * swing + 0.02 * noise)


def test_a_pull_that_still_swings_at_the_end_is_a_decay() -> None:
    """It falls by 1.7 e-folds; its last tenth, taken as the level that follows, had left one of 0.9."""
    (mode,) = identify(short_pull(0.02, 30.0)).modes
    assert (mode.method, mode.status) == ("decay", "ok")
    assert abs(mode.frequency_hz / 0.5 - 1.0) < 1e-3
    assert abs(mode.damping_ratio / 0.02 - 1.0) < 0.05


def test_a_clean_decay_is_identified_from_one_e_fold() -> None:
    """A mode that dies at once is most of what the others leave, early on as a force would be."""
    t = np.arange(600) / RATE
    slow, fast = (
        np.exp(2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2)) * t).real
        for f, zeta in ((0.5, 0.0055), (1.9, 0.13))
    )
    noise = 1e-6 * np.random.default_rng(4).standard_normal((2, t.size))
    (mode, *_) = identify(
        record(np.array([[1.0], [0.6]]) * slow + np.array([[0.02], [-0.01]]) * fast + noise)
    ).modes
    assert (mode.method, mode.status) == ("decay", "ok")
    assert abs(mode.frequency_hz / 0.5 - 1.0) < 1e-4
    assert abs(mode.damping_ratio / 0.0055 - 1.0) < 0.02


def test_a_pull_that_hardly_decays_is_refused_for_its_cycles() -> None:
    with pytest.raises(InputError, match=r"too few cycles.*12 cycles near 0.5 Hz.*free decay"):
        identify(short_pull(0.005, 24.0))
