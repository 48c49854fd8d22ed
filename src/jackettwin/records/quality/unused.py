"""Stretches of a record that hold no samples, or samples that are not used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from jackettwin.arrays import BoolArray

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
            runs = _runs(mask, round(1e3 * _APART_S * per_ms))
            spans = tuple((round(first / per_ms), round(last / per_ms)) for first, last in runs)
            if spans:
                found.append(Unused(channel.name, code, spans))
    return tuple(found)


def _runs(mask: BoolArray, apart: int) -> Iterator[tuple[int, int]]:
    """Yield first and last sample of each run, joined over short pauses."""
    places = np.flatnonzero(mask)
    if not places.size:
        return
    cuts = np.flatnonzero(np.diff(places) > max(apart, 1))
    firsts, lasts = places[np.r_[0, cuts + 1]], places[np.r_[cuts, places.size - 1]]
    longest = np.argsort(firsts - lasts, kind="stable")[:_MOST]
    yield from ((int(firsts[k]), int(lasts[k])) for k in np.sort(longest))
