"""A rotor's speed from the record itself: orders that move together, and modes that do not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy import signal

from jackettwin.identification import identify
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.rotor_speed import estimated_speed
from jackettwin.records import Record, detrend, read_record

RATE, LENGTH = 10.0, 6000
T = np.arange(LENGTH) / RATE
RECORDS = Path(__file__).parents[3] / "src/jackettwin/data/records"


def swell(rng: np.random.Generator, share: float, memory_s: float = 20.0) -> npt.NDArray[np.float64]:
    """Return 1 and a random part that wanders within some seconds."""
    keep = np.exp(-1.0 / (memory_s * RATE))
    slow = signal.lfilter([1.0 - keep], [1.0, -keep], rng.standard_normal(2 * LENGTH))[LENGTH:]
    return np.asarray(1.0 + share * slow / slow.std())


def turning(kind: str, speed_hz: float, drift: float, rng: np.random.Generator) -> npt.NDArray[np.float64]:
    """Return the speed of a rotor [1/s]."""
    if kind == "waves":
        x = np.sin(2.0 * np.pi * T / 150.0 + rng.uniform(0.0, 6.0))
    elif kind == "ramp":
        x = 2.0 * T / T[-1] - 1.0
    else:
        x = swell(rng, 0.6, 25.0) - 1.0
    return np.asarray(speed_hz * (1.0 + drift * x))


LOWEST = {1: 0.5, 3: 1.0, 6: 0.5}
"""Orders and their size."""


def with_orders(
    record: Record,
    speed: npt.NDArray[np.float64],
    rng: np.random.Generator,
    *,
    strength: float,
    share: float,
    sizes: dict[int, float] = LOWEST,
) -> Record:
    """Add 1P, 3P and 6P: 3P of a strength in rms of each channel, the others half, all swelling at random."""
    angle = 2.0 * np.pi * np.cumsum(speed) / RATE
    rms = record.data.std(axis=1)
    y = record.data.copy()
    for order, size in sizes.items():
        pattern = rms * (1.0 + 0.5 * rng.standard_normal(len(y)))
        late = rng.choice([0.0, 0.5 * np.pi, np.pi], len(y)) + rng.uniform(0.0, 6.0)
        tone = np.cos(order * angle + late[:, None]) * swell(rng, share)
        y += np.sqrt(2.0) * strength * size * pattern[:, None] * tone
    return replace(record, data=y)


@pytest.mark.parametrize(
    ("kind", "speed_hz", "drift", "strength", "share"),
    [
        ("waves", 0.15, 0.02, 1.0, 0.0),
        ("waves", 0.20, 0.05, 0.5, 0.3),
        ("ramp", 0.20, 0.02, 0.2, 0.3),
        ("ramp", 0.12, 0.05, 1.0, 0.3),
        ("turbulence", 0.15, 0.02, 0.5, 0.3),
        ("turbulence", 0.17, 0.04, 1.0, 0.0),
    ],
)
def test_the_speed_is_found_without_being_measured(
    tower: ModalSystem, kind: str, speed_hz: float, drift: float, strength: float, share: float
) -> None:
    rng = np.random.default_rng(round(1000 * speed_hz + 100 * drift))
    wind = simulate(tower, rng, duration_s=600.0, sample_rate_hz=RATE)
    speed = turning(kind, speed_hz, drift, rng)
    found = estimated_speed(with_orders(wind, speed, rng, strength=strength, share=share).data, RATE)
    assert found is not None
    there = np.linspace(0.0, 1.0, len(found.speed_hz), endpoint=False) * LENGTH
    off = np.abs(found.speed_hz / np.interp(there, np.arange(LENGTH), speed) - 1.0)
    # turbulence is faster than the smoothing of the phase follows; the range it sweeps is what is used
    assert np.median(off) < 0.4 * drift


@pytest.mark.parametrize("ratio", [None, 2.0, 3.0])
def test_modes_are_no_rotor(tower: ModalSystem, ratio: float | None) -> None:
    """Not even light ones whose frequencies are multiples of each other."""
    f = tower.frequency_hz if ratio is None else np.array([0.290, 0.300, 0.290 * ratio, 0.300 * ratio])
    system = replace(tower, frequency_hz=f, damping_ratio=0.4 * tower.damping_ratio)
    for seed in range(6):
        record = simulate(system, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=RATE)
        assert estimated_speed(record.data, RATE) is None


def test_a_parked_turbine_of_another_program_has_no_speed() -> None:
    files = sorted(RECORDS.glob("*.parquet"))
    assert files
    for path in files[:2]:
        record = detrend(read_record(path))
        names = [c.name for c in record.channels if c.quantity == "acceleration"]
        assert estimated_speed(record.select(names).data[:, ::2], 0.5 * record.sample_rate_hz) is None


def test_no_order_of_a_hidden_rotor_is_a_mode_that_is_ok(tower: ModalSystem) -> None:
    rng = np.random.default_rng(7)
    wind = simulate(tower, rng, duration_s=600.0, sample_rate_hz=RATE)
    speed = turning("ramp", 0.2, 0.02, rng)
    turned = with_orders(wind, speed, rng, strength=1.0, share=0.3)
    found = identify(turned, IdentificationSettings(refine=False))
    for mode in found.modes:
        if mode.status == "ok":
            assert np.min(np.abs(np.log(mode.frequency_hz / tower.frequency_hz))) < 0.02
    # what passes no mode leaves it as it is
    assert sum(mode.status == "ok" for mode in found.modes) >= 2


def test_higher_orders_are_told_where_they_are_seen_and_are_no_modes(tower: ModalSystem) -> None:
    """The ninth and the twelfth of 0.2 Hz, a fiftieth of the power of the third; none at 3.0 and 3.6 Hz."""
    rng = np.random.default_rng(12)
    wind = simulate(tower, rng, duration_s=600.0, sample_rate_hz=RATE)
    speed = turning("turbulence", 0.2, 0.01, rng)
    turned = with_orders(wind, speed, rng, strength=1.0, share=0.3, sizes=LOWEST | {9: 0.15, 12: 0.15})
    seen = estimated_speed(turned.data, RATE)
    assert seen is not None
    assert [order for order, _, _ in seen.higher] == [9, 12]
    for order, low, high in seen.higher:
        assert 0.97 < low / (0.2 * order) < 1.0 < high / (0.2 * order) < 1.03
    found = identify(turned, IdentificationSettings(refine=False, highest_frequency_hz=4.0))
    at = [m for m in found.modes if np.min(np.abs(m.frequency_hz / np.array([1.8, 2.4]) - 1.0)) < 0.03]
    assert at
    assert all("rotor_order_passes" in [reason.code for reason in m.reasons] for m in at)
