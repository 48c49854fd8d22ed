"""Faults of records, each in strengths 1 to 3: what is planted to see who is misled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jackettwin.records import Record

Fault = Callable[[Record, float, np.random.Generator], Record]
SENSE = "planted_sense"
"""Key of a record's metadata: the sign of each channel that was planted."""


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
    """One, two, three channels of wrong sign: no mode is lost, only its shape is turned as they are."""
    sense = np.ones(len(record.data))
    sense[rng.choice(len(sense), int(strength), replace=False)] = -1.0
    return replace(record, data=record.data * sense[:, None], metadata={SENSE: sense.tolist()})


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


def seconds_lost(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """The logger of half the channels loses 5, 17, 40 s somewhere; what follows moves up."""
    lost = int((5.0, 17.0, 40.0)[int(strength) - 1] * record.sample_rate_hz)
    n = record.data.shape[1]
    lost = min(lost, n // 8)
    at = int(rng.uniform(0.3, 0.7) * n)
    short = np.delete(record.data, np.s_[at : at + lost], axis=1)
    return replace(record, data=np.where(_upper(record)[:, None], short, record.data[:, : n - lost]))


def two_days(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """One channel, two, half of them of another time of the same structure."""
    number = (1, 2, len(record.data) // 2)[int(strength) - 1]
    data = record.data.copy()
    lines = np.fft.rfft(data[:number], axis=1)
    # the same phases for all: what they have in common with each other stays
    lines *= np.exp(2j * np.pi * rng.uniform(size=lines.shape[1]))
    data[:number] = np.fft.irfft(lines, data.shape[1], axis=1)
    return replace(record, data=data)


def time_reversed(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """One channel, two, half of them stored from the end to the beginning."""
    number = (1, 2, len(record.data) // 2)[int(strength) - 1]
    data = record.data.copy()
    data[:number] = data[:number, ::-1]
    return replace(record, data=data)


def held(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Every sample of every channel repeated once, twice, three times."""
    times = int(strength) + 1
    return replace(record, data=np.repeat(record.data[:, ::times], times, axis=1)[:, : record.data.shape[1]])


def short(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """Cut to 40, 20, 10 cycles of the strongest line."""
    k = np.argmax(np.abs(np.fft.rfft(record.data, axis=1)).sum(axis=0)[5:]) + 5
    n = int((40.0, 20.0, 10.0)[int(strength) - 1] * record.data.shape[1] / k)
    return replace(record, data=record.data[:, : max(n, 200)])


def offset_steps(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """The zero of every channel steps once, by 1, 3, 10 rms, at one time."""
    size = (1.0, 3.0, 10.0)[int(strength) - 1] * record.data.std(axis=1, keepdims=True)
    after = _time(record) > rng.uniform(0.2, 0.8) * record.duration_s
    return replace(record, data=record.data + size * rng.choice([-1.0, 1.0], size.shape) * after)


def gain_grows(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """The gain of one channel grows through the record to 1.5, 2, 4 times what it was."""
    data = record.data.copy()
    data[rng.integers(len(data))] *= np.linspace(1.0, (1.5, 2.0, 4.0)[int(strength) - 1], data.shape[1])
    return replace(record, data=data)


def sign_turns(record: Record, strength: float, rng: np.random.Generator) -> Record:
    """One channel, two, half of them turn their sign somewhere."""
    number = (1, 2, len(record.data) // 2)[int(strength) - 1]
    data = record.data.copy()
    data[:number, int(rng.uniform(0.25, 0.75) * data.shape[1]) :] *= -1.0
    # which of the two senses was the right one nothing tells: shapes of either are true
    sense = np.where(np.arange(len(data)) < number, -1.0, 1.0)
    return replace(record, data=data, metadata={SENSE: sense.tolist()})


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
    "seconds lost": seconds_lost,
    "two days": two_days,
    "time reversed": time_reversed,
    "held": held,
    "short": short,
    "offset steps": offset_steps,
    "gain grows": gain_grows,
    "sign turns": sign_turns,
}
"""Name → what it does to a record."""
