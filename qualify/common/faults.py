"""Faults of records, each in strengths 1 to 3: what is planted to see who is misled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jackettwin.records import Record

Fault = Callable[[Record, float, np.random.Generator], Record]


def _time(record: Record) -> np.ndarray:
    return np.arange(record.data.shape[1]) / record.sample_rate_hz


def _middle_hz(record: Record, rng: np.random.Generator) -> float:
    """Return a frequency within the part of the spectrum that holds most of the power."""
    power = np.abs(np.fft.rfft(record.data, axis=1)) ** 2
    share = np.cumsum(power.sum(axis=0)) / power.sum()
    f = np.fft.rfftfreq(record.data.shape[1], 1.0 / record.sample_rate_hz)
    return float(np.interp(rng.uniform(0.1, 0.9), share, f))


def _upper(record: Record) -> np.ndarray:
    """Return which channels hang on the second logger: the first half."""
    return np.arange(len(record.data)) < len(record.data) // 2


def _shifted(record: Record, delay: np.ndarray) -> np.ndarray:
    """Return the samples of the upper channels read later by a delay that may change [s]."""
    t = _time(record)
    data = record.data.copy()
    for i in np.flatnonzero(_upper(record)):
        data[i] = np.interp(t - delay, t, data[i])
    return data


def logger_steps(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Half the channels late from half-time on, by 0.05, 0.1, 0.2 s."""
    t = _time(record)
    return replace(record, data=_shifted(record, 0.025 * 2**strength * (t > 0.5 * t[-1])))


def logger_late(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Half the channels late throughout, by 0.05, 0.1, 0.2 s."""
    return replace(record, data=_shifted(record, 0.025 * 2**strength * np.ones(record.data.shape[1])))


def clock_drifts(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """The clock of half the channels slow by 50, 150, 450 ppm."""
    return replace(record, data=_shifted(record, 50e-6 * 3 ** (strength - 1.0) * _time(record)))


def gain_steps(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """The gain of one channel half-way times 1.3, 2, 4."""
    data = record.data.copy()
    data[rng.integers(len(data)), data.shape[1] // 2 :] *= (1.3, 2.0, 4.0)[int(strength) - 1]
    return replace(record, data=data)


def tone_drifts(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """A tone that wanders by ±2 % over the record, of 0.2, 0.5, 1 rms of the channels."""
    t, f = _time(record), _middle_hz(record, rng)
    wander = 0.02 * np.sin(2.0 * np.pi * t / t[-1] * rng.uniform(0.5, 2.0) + rng.uniform(0.0, 6.0))
    phase = 2.0 * np.pi * np.cumsum(f * (1.0 + wander)) / record.sample_rate_hz
    size = (0.2, 0.5, 1.0)[int(strength) - 1] * np.sqrt(2.0) * record.data.std(axis=1, keepdims=True)
    return replace(record, data=record.data + size * rng.uniform(0.3, 1.0, size.shape) * np.sin(phase))


def tone_steady(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """A steady tone of 0.2, 0.5, 1 rms of the channels."""
    size = (0.2, 0.5, 1.0)[int(strength) - 1] * np.sqrt(2.0) * record.data.std(axis=1, keepdims=True)
    wave = np.sin(2.0 * np.pi * _middle_hz(record, rng) * _time(record))
    return replace(record, data=record.data + size * rng.uniform(0.3, 1.0, size.shape) * wave)


def waves(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """A broad band of forces (5 to 10 %) in the proportions of a push, of 0.3, 0.7, 1.5 rms; sea stated."""
    n = record.data.shape[1]
    f = np.fft.rfftfreq(n, 1.0 / record.sample_rate_hz)
    power = np.abs(np.fft.rfft(record.data, axis=1)).sum(axis=0)
    peak = float(np.clip(f[np.argmax(power)] * rng.uniform(0.5, 0.8), 0.06, 0.25))
    zeta = rng.uniform(0.05, 0.1)
    shape = 1.0 / (peak**2 - f**2 + 2j * zeta * peak * f + 1e-12)
    wave = np.fft.irfft(rng.normal(size=(len(f), 2)) @ np.array([1.0, 1j]) * shape * f**2, n)
    size = (0.3, 0.7, 1.5)[int(strength) - 1] * record.data.std(axis=1, keepdims=True)
    data = record.data + size * rng.uniform(0.3, 1.0, size.shape) * wave / wave.std()
    return replace(record, data=data, conditions={"tp_s": 1.0 / peak})


def one_sensor(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """One sensor on a mount that shakes: a resonance of 1 % of 0.5, 1, 2 rms in it alone."""
    n, data = record.data.shape[1], record.data.copy()
    f, f0 = np.fft.rfftfreq(n, 1.0 / record.sample_rate_hz), _middle_hz(record, rng)
    response = f**2 / (f0**2 - f**2 + 0.02j * f0 * f + 1e-12)
    shaking = np.fft.irfft(rng.normal(size=(len(f), 2)) @ np.array([1.0, 1j]) * response, n)
    i = rng.integers(len(data))
    data[i] += (0.5, 1.0, 2.0)[int(strength) - 1] * data[i].std() * shaking / shaking.std()
    return replace(record, data=data)


def coarse(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Quantised by steps of 0.3, 0.6, 1.2 rms."""
    step = (0.3, 0.6, 1.2)[int(strength) - 1] * record.data.std(axis=1, keepdims=True)
    return replace(record, data=step * np.round(record.data / step))


def reversed_sensor(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """One, two, three channels of wrong sign: no mode is lost, only its shape is wrong."""
    data = record.data.copy()
    data[rng.choice(len(data), int(strength), replace=False)] *= -1.0
    return replace(record, data=data)


def gaps(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Samples lost in every channel at its own time: 2, 5, 10 %."""
    data = record.data.copy()
    n = data.shape[1]
    for row in data:
        length = int((0.02, 0.05, 0.10)[int(strength) - 1] * n)
        first = rng.integers(n - length)
        row[first : first + length] = np.nan
    return replace(record, data=data)


def half_stronger(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Not stationary: the second half louder 2, 5, 10 times."""
    data = record.data.copy()
    data[:, data.shape[1] // 2 :] *= (2.0, 5.0, 10.0)[int(strength) - 1]
    return replace(record, data=data)


FAULTS: dict[str, Fault] = {
    "logger steps": logger_steps,
    "logger late": logger_late,
    "clock drifts": clock_drifts,
    "gain steps": gain_steps,
    "drifting tone": tone_drifts,
    "steady tone": tone_steady,
    "waves": waves,
    "one sensor shakes": one_sensor,
    "coarse quantiser": coarse,
    "reversed sensor": reversed_sensor,
    "gaps": gaps,
    "not stationary": half_stronger,
}
"""Name → what it does to a record."""
