"""Recognition across records of the orders of a rotor of unknown speed.

The frequency of a mode does not depend on the rotor's speed. The orders 1P, 3P, 6P and 9P are proportional to
the speed, so that in every record the ratio of two of them is 3, 2 or 1.5. Rotational sampling of turbulence
by the blades makes their peaks broad, and they are identified as modes in a single record.

The frequency of such ratios by chance is estimated from pairs of frequencies of different records, between
which the speed has changed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import bdtrc

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.findings import Finding
from jackettwin.identification.status import ModeStatus
from jackettwin.intervals import NORMAL_OF_MAD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.many_records.sightings import Sightings


RATIOS = (2.0, 3.0, 1.5)
"""Ratios of 6P to 3P, 3P to 1P, and 9P to 6P."""
TOLERANCE = 0.015
"""Largest deviation of ln of a ratio: the centre of a broad peak is known to about one per cent."""
SETTLED_SHARE, SETTLED_SPREAD = 0.5, 0.01
"""Least share of the records that contain a constant mode, and its largest spread of ln f."""
PERMANENT_SHARE = 0.9
"""Share of the records from which a constant peak is no order: a rotor turns at rated speed most of the time,
but not always."""
MOST_BESIDE = 0.2
"""Largest share of the records with orders at other frequencies in which an order at rated speed is found."""
LEAST_SWEEP, STEADIER = 0.03, 5.0
"""Least range of ln f of orders, absolute and as multiple of the range of the most constant mode."""
CHANCE = 1e-3
"""Probability of the number of locked pairs below which they are not due to chance."""
FEWEST = 3
"""Fewest records with a locked pair, and fewest jumps of a frequency."""
JUMP, STAYS = 0.02, 0.005
"""Least change of ln f from one record to the next that excludes a structure, and the largest typical change
of another mode meanwhile."""
CLEAR = 4.0
"""Number of standard deviations above which a change is a jump."""


@dataclass(frozen=True)
class NoMode:
    """Reason why a frequency in many records is not a mode."""

    status: ModeStatus
    reason: Finding


@dataclass(frozen=True)
class _All:
    """Estimates of all records as columns: record, track, ln f and its standard deviation."""

    record: Int64Array
    track: Int64Array
    log_f: FloatArray
    std: FloatArray

    def at(self, rows: BoolArray | Int64Array) -> _All:
        return _All(self.record[rows], self.track[rows], self.log_f[rows], self.std[rows])


@dataclass(frozen=True)
class _Locked:
    """Pairs of estimates of one record whose frequencies have a ratio: rows of the lower and the higher."""

    ratio: float
    low: Int64Array
    high: Int64Array


def objections(tracks: Sequence[Sightings]) -> dict[int, NoMode]:
    """Return the objections to tracks of modes over many records, by number of the track.

    Parameters
    ----------
    tracks : sequence of Sightings
        All tracks, including those in few records.
    """
    seen = _columns(tracks)
    n_records = len(np.unique(seen.record))
    settled = [k for k in range(len(tracks)) if _is_settled(seen.at(seen.track == k).log_f, n_records)]
    if not settled:
        return {}
    still = min(_sweep(seen.log_f[seen.track == k]) for k in settled)
    permanent = [k for k in settled if np.sum(seen.track == k) >= PERMANENT_SHARE * n_records]
    moving = seen.at(~np.isin(seen.track, permanent))
    out: dict[int, NoMode] = {}
    for locked in (_locked(moving, ratio) for ratio in RATIOS):
        sweep = _sweep(moving.log_f[locked.low])
        if sweep > max(LEAST_SWEEP, STEADIER * still) and _is_no_chance(moving, locked):
            caught = _of_orders(moving, locked, settled)
            out |= {k: one for k, one in caught.items() if k not in out}
    return _of_jumps(seen, settled) | out


def _columns(tracks: Sequence[Sightings]) -> _All:
    kept = [one.at(one.severity <= ModeStatus.DOUBTFUL.severity) for one in tracks]
    return _All(
        np.concatenate([one.record for one in kept]),
        np.repeat(np.arange(len(kept)), [len(one) for one in kept]),
        np.log(np.concatenate([one.frequency_hz for one in kept])),
        np.sqrt(np.nan_to_num(np.concatenate([one.log_covariance[:, 0, 0] for one in kept]))),
    )


def _is_settled(log_f: FloatArray, n_records: int) -> bool:
    if log_f.size < max(SETTLED_SHARE * n_records, FEWEST):
        return False
    return float(NORMAL_OF_MAD * np.median(np.abs(log_f - np.median(log_f)))) < SETTLED_SPREAD


def _sweep(log_f: FloatArray) -> float:
    """Return the range of most of the values."""
    return float(np.ptp(np.percentile(log_f, (10.0, 90.0)))) if log_f.size >= FEWEST else 0.0


def _locked(moving: _All, ratio: float) -> _Locked:
    """Return the pairs of one record whose frequencies have a ratio."""
    low, high = [], []
    for record in np.unique(moving.record):
        rows = np.flatnonzero(moving.record == record)
        apart = moving.log_f[rows] - moving.log_f[rows][:, None] - np.log(ratio)
        i, j = np.nonzero(np.abs(apart) < TOLERANCE)
        low.append(rows[i])
        high.append(rows[j])
    none = np.zeros(0, dtype=np.int64)
    return _Locked(ratio, np.concatenate([none, *low]), np.concatenate([none, *high]))


def _is_no_chance(moving: _All, locked: _Locked) -> bool:
    """Return whether pairs within records are locked more often than pairs of different records."""
    if len(np.unique(moving.record[locked.low])) < FEWEST:
        return False
    ordered = np.sort(moving.log_f)
    above = moving.log_f + np.log(locked.ratio)
    met = np.searchsorted(ordered, above + TOLERANCE) - np.searchsorted(ordered, above - TOLERANCE)
    within = int(sum(n * (n - 1) // 2 for n in np.unique(moving.record, return_counts=True)[1]))
    across = moving.log_f.size * (moving.log_f.size - 1) // 2 - within
    chance = (int(met.sum()) - locked.low.size + 1.0) / (across + 2.0)
    return bool(bdtrc(locked.low.size - 1, within, min(chance, 1.0)) < CHANCE)


def _of_orders(moving: _All, locked: _Locked, settled: Sequence[int]) -> dict[int, NoMode]:
    """Return the tracks that consist of a rotor's orders."""
    rows = np.unique(np.concatenate([locked.low, locked.high]))
    orders, numbers = moving.at(rows), np.exp(moving.log_f[locked.low])
    reason = Finding(
        "rotor_order_across_records",
        params={
            "ratio": locked.ratio, "low_hz": float(numbers.min()), "high_hz": float(numbers.max()),
            "number": len(np.unique(orders.record)),
        },
    )  # fmt: skip
    out = {}
    for k in np.unique(orders.track):
        own = moving.record[moving.track == k]
        caught = orders.record[orders.track == k]
        elsewhere = np.setdiff1d(orders.record, caught)
        beside = np.isin(elsewhere, own).sum() > MOST_BESIDE * elsewhere.size
        if 2 * caught.size >= own.size and not (k in settled and beside):
            out[int(k)] = NoMode(ModeStatus.TONE, reason)
    return out


def _of_jumps(seen: _All, settled: Sequence[int]) -> dict[int, NoMode]:
    """Return the tracks that jump from record to record while another mode is constant."""
    typical = {k: float(np.median(np.abs(_changes(seen.at(seen.track == k))[0]))) for k in settled}
    steadiest = min(typical, key=lambda k: typical[k])
    if typical[steadiest] > STAYS:
        return {}
    stays = float(np.exp(np.median(seen.log_f[seen.track == steadiest])))
    out = {}
    for k in np.unique(seen.track):
        change, std = _changes(seen.at(seen.track == k))
        jumps = np.abs(change) > np.maximum(JUMP, CLEAR * std)
        if jumps.sum() >= FEWEST and 4 * jumps.sum() >= change.size:
            size = float(np.median(np.abs(change[jumps])))
            reason = Finding(
                "jumps_between_records", params={"times": int(jumps.sum()), "size": size, "stays_hz": stays}
            )
            out[int(k)] = NoMode(ModeStatus.DOUBTFUL, reason)
    return out


def _changes(own: _All) -> tuple[FloatArray, FloatArray]:
    """Return the changes of ln f between successive records with the track, and their uncertainty."""
    order = np.argsort(own.record, kind="stable")
    return np.diff(own.log_f[order]), np.hypot(own.std[order][1:], own.std[order][:-1])
