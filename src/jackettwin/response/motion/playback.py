"""Motion of the whole structure during a record: modal coordinates from sensors, displacements from modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.records import Record
from jackettwin.response.modes.modal import UndampedModes
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Assembly

_BAND_HZ = (0.1, 1.5)
"""Of the motion that is shown: that of the first modes; below it accelerations are noise."""
_STEP_S = 0.1
"""Of what is shown, several pictures in the shortest cycle."""
_TAPER = 0.3
"""Share of a band edge's frequency over which the filter rises."""
_VISIBLE, _NEW = 0.05, 0.2
"""Smallest size of a mode at the sensors relative to the best visible mode, and smallest part of its pattern
that is independent of lower modes."""


@dataclass(frozen=True)
class Playback:
    """Modal coordinates over time.

    Attributes
    ----------
    shapes : (assembly.n_dof, n_modes)
    q : (n_times, n_modes); displacement is shapes @ q [m]
    step_s, start_s : float
        Sampling interval, and time in the record at which the excerpt begins.
    """

    shapes: FloatArray
    q: FloatArray
    step_s: float
    start_s: float


def record_sensors(record: Record) -> tuple[Sensor, ...]:
    """Return the sensors of a record's accelerometers that have a position and a direction.

    Raises
    ------
    InputError
        If there are none.
    """
    found = tuple(
        Sensor(c.name, c.direction, c.node, None if c.node else c.height_m)
        for c in record.channels
        if c.quantity == "acceleration" and any(c.direction) and (c.node or c.height_m is not None)
    )
    if not found:
        raise InputError(
            "no accelerometer of the record has a position",
            field="channels",
            value=list(record.channel_names),
            remedy="give height_m or node, and direction",
        )
    return found


def playback(
    assembly: Assembly,
    modes: UndampedModes,
    record: Record,
    *,
    duration_s: float = 60.0,
) -> Playback:
    r"""Return the part of a record with most motion as modal coordinates.

    Accelerations become displacements in the band, d̂ = −â/ω², and these modal coordinates by least squares,
    :math:`q = (HΦ)^+ d`, of the lowest modes that the sensors measure and distinguish.
    """
    sensors = record_sensors(record)
    data = record.select([s.channel for s in sensors]).data
    d = _displacement(np.array([_filled(row) for row in data]), record.sample_rate_hz, _BAND_HZ)
    seen = np.asarray(observation_matrix(assembly, sensors) @ modes.shapes)
    kept = _told_apart(seen, modes.frequency_hz <= _BAND_HZ[1])
    shapes = modes.shapes[:, kept]
    stride = max(1, round(_STEP_S * record.sample_rate_hz))
    q = (np.linalg.pinv(seen[:, kept]) @ d[:, ::stride]).T
    step = stride / record.sample_rate_hz
    first = _liveliest(q, max(1, round(duration_s / step)))
    excerpt = q[first : first + max(1, round(duration_s / step))]
    return Playback(shapes, excerpt, step, first * step)


def _told_apart(seen: FloatArray, inside: BoolArray) -> list[int]:
    """Return the modes whose pattern at the sensors is large and independent of those of lower modes."""
    kept: list[int] = []
    largest = float(np.linalg.norm(seen[:, inside], axis=0).max(initial=0.0))
    Q = np.zeros((seen.shape[0], 0))
    for j in np.flatnonzero(inside):
        size = float(np.linalg.norm(seen[:, j]))
        rest = seen[:, j] - Q @ (Q.T @ seen[:, j])
        if size > _VISIBLE * largest and np.linalg.norm(rest) > _NEW * size:
            kept.append(int(j))
            Q = np.column_stack([Q, rest / np.linalg.norm(rest)])
    return kept


def _filled(row: FloatArray) -> FloatArray:
    known = np.isfinite(row)
    if not known.any():
        return np.zeros_like(row)
    t = np.arange(row.size)
    return np.asarray(np.interp(t, t[known], row[known] - row[known].mean()))


def _displacement(a: FloatArray, rate_hz: float, band_hz: tuple[float, float]) -> FloatArray:
    f = np.fft.rfftfreq(a.shape[1], 1.0 / rate_hz)
    low, high = band_hz
    rise = np.clip((f - (1.0 - _TAPER) * low) / (_TAPER * low), 0.0, 1.0)
    fall = np.clip(((1.0 + _TAPER) * high - f) / (_TAPER * high), 0.0, 1.0)
    gain = 0.5 - 0.5 * np.cos(np.pi * rise * fall)
    gain[1:] /= -((2.0 * np.pi * f[1:]) ** 2)
    return np.asarray(np.fft.irfft(np.fft.rfft(a, axis=1) * gain, n=a.shape[1], axis=1))


def _liveliest(q: FloatArray, window: int) -> int:
    """Return the start of the ``window`` consecutive samples with most energy."""
    if q.shape[0] <= window:
        return 0
    energy = np.concatenate([[0.0], np.cumsum((q**2).sum(axis=1))])
    return int(np.argmax(energy[window:] - energy[:-window]))
