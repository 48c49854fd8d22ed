"""Detection of places whose two horizontal channels are exchanged: x is stored as y, and y as x.

Along one axis the heights of a tower move together: x here with x there, y with y. Where the two channels
of a place are coherent with the *other* axis of all other places, and not with their own, they are
exchanged. Structures whose modes lie across the axes are coherent both ways; then nothing is concluded.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks import phases
from jackettwin.records.processing.filters import bridge
from jackettwin.records.quality.faults import is_constant
from jackettwin.records.record import Channel, Record

ALONG = 0.9
"""Cosine of the angle to an axis above which a channel points along it."""
LEAST = 20.0
"""Smallest sum of the weights of two channels that move together: two bins of full coherence."""
RATIO = 3.0
"""Least ratio of the smaller of the sums along both axes to the larger across. Of the shipped records it is
15 or more, of a tower of independent axes under noise 8 or more."""


def axes_in_line(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the record with exchanged channels put right, and what was found.

    Which places are wrong follows from the majority; of two that disagree nobody can say, and both stay.
    """
    places = dict(_places(record))
    if len(places) < 2:
        return record, ()
    rows = [i for pair in places.values() for i in pair]
    gamma = _coherence(np.array([bridge(record.data[i]) for i in rows]), record.sample_rate_hz)
    if gamma is None:
        return record, ()
    names, sense = list(places), np.zeros((len(places), len(places)))
    for p, q in combinations(range(len(places)), 2):
        block = gamma[2 * p : 2 * p + 2, 2 * q : 2 * q + 2]
        along, across = (block[0, 0], block[1, 1]), (block[0, 1], block[1, 0])
        if min(along) > max(LEAST, RATIO * max(across)):
            sense[p, q] = sense[q, p] = 1.0
        elif min(across) > max(LEAST, RATIO * max(along)):
            sense[p, q] = sense[q, p] = -1.0
    if not (sense < 0.0).any():
        return record, ()
    crossed = _minority(sense)
    if crossed is None:
        channels = ", ".join(record.channels[i].name for i in rows)
        return record, (Finding("axes_crossed_unclear", None, {"channels": channels}),)
    data, found = record.data.copy(), []
    for k in crossed:
        x, y = places[names[k]]
        data[[x, y]] = record.data[[y, x]]
        channels = f"{record.channels[x].name}, {record.channels[y].name}"
        found.append(Finding("axes_crossed", None, {"channels": channels}, repaired=True))
    return replace(record, data=data), tuple(found)


def _minority(sense: FloatArray) -> list[int] | None:
    """Return the places that disagree with most others, None if that is not decided.

    Parameters
    ----------
    sense : (n_places, n_places)
        1 for two places that agree, −1 for two that disagree, 0 where unknown.

    Examples
    --------
    >>> _minority(np.array([[0, 1, -1], [1, 0, -1], [-1, -1, 0]])), _minority(np.array([[0, -1], [-1, 0]]))
    ([2], None)
    """
    against = (sense < 0.0).sum(axis=1)
    wrong = [int(k) for k in np.flatnonzero(against > (sense > 0.0).sum(axis=1) + 1)]
    side = np.where(np.isin(np.arange(len(sense)), wrong), -1.0, 1.0)
    agrees = bool(np.all(np.outer(side, side) * sense >= 0.0))
    return wrong if wrong and agrees and 2 * len(wrong) < len(sense) else None


def _places(record: Record) -> Iterator[tuple[object, tuple[int, int]]]:
    """Yield the places with two channels along common horizontal axes, and their rows."""
    at: dict[object, list[int]] = {}
    for i, channel in enumerate(record.channels):
        place = channel.node if channel.node is not None else channel.height_m
        if place is not None and _compared(channel) and not is_constant(record.data[i]):
            at.setdefault(place, []).append(i)
    axes: FloatArray | None = None
    for where, rows in at.items():
        directions = np.array([record.channels[i].direction for i in rows])
        if len(rows) != 2:
            continue
        if axes is None and abs(directions[0] @ directions[1]) < 1.0 - ALONG:
            axes = directions
        if axes is None:
            continue
        along = np.abs(directions @ axes.T) > ALONG
        if along.sum() == 2 and along.any(axis=0).all() and along.any(axis=1).all():
            first = int(np.argmax(along[:, 0]))
            yield where, (rows[first], rows[1 - first])


def _compared(channel: Channel) -> bool:
    """Tell whether a channel is a horizontal vibration in global axes."""
    x, y, z = channel.direction
    return channel.quantity in VIBRATIONS and channel.frame == "global" and abs(z) < 0.1 < abs(x) + abs(y)


def _coherence(y: FloatArray, sample_rate_hz: float) -> FloatArray | None:
    """Return the sums of coherence weights over the bins of motion, (n_channels, n_channels)."""
    seen = phases(y - y.mean(axis=1, keepdims=True), sample_rate_hz, np.ones(len(y), dtype=complex))
    if seen is None:
        return None
    out = np.zeros((len(y), len(y)))
    i, j = seen.pairs.T
    out[i, j] = out[j, i] = seen.total
    return out
