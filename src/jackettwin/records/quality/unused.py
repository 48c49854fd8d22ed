"""Stretches of a record that hold no samples, or samples that are not used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from jackettwin.arrays import BoolArray, Int64Array
from jackettwin.signals import runs

if TYPE_CHECKING:
    from jackettwin.records.record import Record

_APART_S = 1.0
"""Faults nearer than this are one stretch [s]."""
_MOST = 100
"""Largest number of stretches of a channel; of more, the longest are told."""


@dataclass(frozen=True)
class Unused:
    """Stretches of one channel.

    Attributes
    ----------
    channel : str
    code : {"gap", "left_out"}
        Whether samples are missing, or there but not used.
    spans_ms : tuple of (int, int)
        First and last sample of each stretch [ms] after the record's start: whole numbers, which a store
        does not round.
    """

    channel: str
    code: Literal["gap", "left_out"]
    spans_ms: tuple[tuple[int, int], ...]


def unused(record: Record, suspect: BoolArray) -> tuple[Unused, ...]:
    """Return the stretches without samples, and those of suspect ones, (n_channels, n_samples)."""
    per_ms, found = record.sample_rate_hz / 1e3, []
    for channel, row, wrong in zip(record.channels, record.data, suspect, strict=True):
        gaps = ~np.isfinite(row)
        codes: tuple[tuple[Literal["gap", "left_out"], BoolArray], ...]
        codes = (("gap", gaps), ("left_out", wrong & ~gaps))
        for code, mask in codes:
            stretches = _joined(runs(mask), round(1e3 * _APART_S * per_ms))
            spans = tuple((round(first / per_ms), round(last / per_ms)) for first, last in stretches)
            if spans:
                found.append(Unused(channel.name, code, spans))
    return tuple(found)


def _joined(found: Int64Array, apart: int) -> Iterator[tuple[int, int]]:
    """Yield first and last sample of runs (n, 2), by start and length, joined over short pauses."""
    firsts, lasts = found[:, 0], found.sum(axis=1) - 1
    cut = firsts[1:] - lasts[:-1] > max(apart, 1)
    firsts, lasts = firsts[np.r_[True, cut][: len(found)]], lasts[np.r_[cut, True][: len(found)]]
    longest = np.argsort(firsts - lasts, kind="stable")[:_MOST]
    yield from ((int(firsts[k]), int(lasts[k])) for k in np.sort(longest))
