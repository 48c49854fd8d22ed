"""Sensor readings of a motion at the sample rate, with sensor errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response import StateSpace, first_order_hold, observation_matrix
from jackettwin.simulate.motion.motion import Motion
from jackettwin.simulate.scenario.scenario import Instrument, Scenario


def readings(motion: Motion, scenario: Scenario) -> FloatArray:
    """Return what the instruments read (n_instruments, n_samples), without flaws, after what is discarded.

    Between load steps the motion is exact for the forces that were straight there. Instruments on the nacelle
    point where it does at each instant.
    """
    air, instruments = scenario.air, scenario.instruments
    turning = [i for i, one in enumerate(instruments) if one.on_nacelle and air is not None]
    along = [_along(instruments[i], axis) for i in turning for axis in np.eye(3)]
    read = _read(motion, scenario, (*instruments, *along))
    found = read[: len(instruments)]
    if air is not None and turning:
        global_axes = read[len(instruments) :].reshape(len(turning), 3, -1)
        yaw = air.heading(np.arange(read.shape[1], dtype=np.float64) * scenario.clock.step_s)
        cos, sin = np.cos(yaw), np.sin(yaw)
        for i, (x, y, z) in zip(turning, global_axes, strict=True):
            d = np.asarray(instruments[i].direction) / np.linalg.norm(instruments[i].direction)
            found[i] = (cos * d[0] - sin * d[1]) * x + (sin * d[0] + cos * d[1]) * y + d[2] * z
    return found


def _along(instrument: Instrument, axis: FloatArray) -> Instrument:
    """Return the instrument along a global axis."""
    x, y, z = (float(v) for v in axis)
    return replace(instrument, direction=(x, y, z))


def _read(motion: Motion, scenario: Scenario, instruments: tuple[Instrument, ...]) -> FloatArray:
    """Return the readings of instruments whose directions are in global axes."""
    clock, space = scenario.clock, motion.space
    C, D = _observation(motion, instruments)
    per_load = round(clock.load_step_s / clock.step_s)
    weights = _weights(space, C, D, clock.step_s, per_load)
    rows, n, m = weights.reshape(-1, weights.shape[2]), C.shape[1], D.shape[1]
    read = rows[:, :n] @ motion.states[:-1].T
    read += rows[:, n : n + m] @ motion.force[:-1].T
    read += rows[:, n + m :] @ motion.force[1:].T
    read = read.reshape(C.shape[0], per_load, -1).transpose(0, 2, 1)
    first = round(clock.discard_s / clock.step_s)
    return np.asarray(read.reshape(C.shape[0], -1)[:, first:])


def _weights(space: StateSpace, C: FloatArray, D: FloatArray, step_s: float, per_load: int) -> FloatArray:
    """Return readings from a load step's first state, first and last forces: (n_instruments, per_load, ...).

    The samples within a load step are so many steps of one hold.
    """
    n, m = C.shape[1], D.shape[1]
    share = np.arange(per_load) / per_load
    reached = np.hstack([np.eye(n), np.zeros((n, 2 * m))])
    weights = np.empty((C.shape[0], per_load, n + 2 * m))
    hold = first_order_hold(space.A, space.B, step_s) if per_load > 1 else None
    for j, now in enumerate(share):
        if hold is not None and j > 0:
            before = share[j - 1]
            reached = hold.E @ reached
            reached[:, n : n + m] += (1.0 - before) * hold.P0 + (1.0 - now) * hold.P1
            reached[:, n + m :] += before * hold.P0 + now * hold.P1
        weights[:, j] = C @ reached
        weights[:, j, n:] += np.hstack([(1.0 - now) * D, now * D])
    return weights


def _observation(motion: Motion, instruments: tuple[Instrument, ...]) -> tuple[FloatArray, FloatArray]:
    """Return C, D with readings = C x + D f."""
    space, n = motion.space, motion.space.n
    sensors = tuple(instrument.sensor for instrument in instruments)
    rows = np.asarray(observation_matrix(motion.model.assembly, sensors) @ motion.model.reduced.basis)
    C, D = np.zeros((rows.shape[0], space.A.shape[0])), np.zeros((rows.shape[0], n))
    for k, (row, instrument) in enumerate(zip(rows, instruments, strict=True)):
        if instrument.recorded_as == "acceleration":
            C[k], D[k] = row @ space.A[n : 2 * n], row @ space.B[n : 2 * n]
        elif instrument.recorded_as == "velocity":
            C[k, n : 2 * n] = row
        else:
            C[k, :n] = row
    return C, D


def flawed(clean: FloatArray, instruments: tuple[Instrument, ...], *, step_s: float, seed: int) -> FloatArray:
    """Return readings with bias, noise, clipping and drop-outs (NaN), each channel from its own stream."""
    read = clean.copy()
    streams = np.random.default_rng(seed).spawn(len(instruments))
    for row, instrument, rng in zip(read, instruments, streams, strict=True):
        row += instrument.bias
        if instrument.noise > 0.0:
            row += instrument.noise * rng.standard_normal(row.size)
        if instrument.limit is not None:
            np.clip(row, -instrument.limit, instrument.limit, out=row)
        if instrument.dropouts_per_hour > 0.0:
            _drop(row, instrument, rng, step_s)
    return read


def _drop(row: FloatArray, instrument: Instrument, rng: np.random.Generator, step_s: float) -> None:
    """Remove readings: a Poisson process of gaps of exponential length."""
    hours = row.size * step_s / 3600.0
    for _ in range(rng.poisson(instrument.dropouts_per_hour * hours)):
        start = int(rng.integers(row.size))
        length = max(1, round(rng.exponential(instrument.dropout_s) / step_s))
        row[start : start + length] = np.nan
