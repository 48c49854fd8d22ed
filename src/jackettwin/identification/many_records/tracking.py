"""Modes followed from record to record, by shape and frequency, in memory that hardly grows.

Records join one after the other. Of a mode only numbers are kept, a few dozen bytes a record, beside its last
shapes, by which it is recognised, and sums that hold its mean shape. What it is compared with moves on with
it: tide, temperature and scour may take a frequency anywhere, as long as they take their time.
"""

from __future__ import annotations

from array import array
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.errors import InputError
from jackettwin.identification.many_records.setups import ShapeSum, joined_channels, tied
from jackettwin.identification.many_records.sightings import Sightings, log_covariance

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Channel


FREQUENCY_SCALE = 0.03
"""Relative change of frequency that counts as much as shapes at right angles."""
SHAPE_SLACK = 2.0
"""So many times the variance of two shapes may their 1 − MAC be without counting."""
SAME_MODE = 1.0
"""Largest distance, frequency and shape together, of one mode in two records."""
PATIENCE = 500
"""After so many records without it a mode is no longer waited for; found again it starts anew, and the parts
are joined at the end."""
RECENT = 15
"""Records by which a mode is recognised: enough for a median, few enough to follow a drift."""
FEWEST_OF_A_PART = 3
"""A track of fewer records is no part of a mode that was lost and found again."""
PART_REACH = 0.1
"""Largest change of ln f while a mode was not seen."""
PART_MAC = 0.9
"""Least MAC of its mean shapes before and after."""
PART_CHANNELS = 3
"""Fewer channels say too little of a shape."""
TOGETHER = 0.05
"""Two tracks seen together in more than this share of the shorter one's records are two modes."""
_COLUMNS = 10


@dataclass(frozen=True)
class _Glimpse:
    """A mode in one record: channels, shape, variance of the shape, ln f."""

    at: Int64Array
    shape: ComplexArray
    vagueness: float
    log_f: float


@dataclass
class Track:
    """One mode as it is followed; grows with every record that holds it.

    Attributes
    ----------
    rows : array of float
        Ten numbers a record, see ``sightings``.
    recent : deque
        The mode in the last ``RECENT`` records that hold it.
    log_f : float
        Median ln f of these.
    last : int
        Position of the last of them.
    shapes : dict
        The sum of its shapes over the records of every key.
    """

    rows: array[float] = field(default_factory=lambda: array("d"))
    recent: deque[_Glimpse] = field(default_factory=lambda: deque(maxlen=RECENT))
    log_f: float = 0.0
    last: int = 0
    shapes: dict[Hashable, ShapeSum] = field(default_factory=dict)

    def add(self, number: int, m: int, found: Identification, glimpse: _Glimpse, key: Hashable) -> None:
        """Continue with mode ``m`` of record ``number``."""
        mode = found.modes[m]
        numbers = (
            mode.frequency_hz,
            mode.damping_ratio,
            found.duration_s,
            *log_covariance(mode).flat,
            mode.status.severity,
        )
        self.rows.extend((number, m, *numbers))
        self.recent.append(glimpse)
        self.last = number
        self.log_f = float(np.median([one.log_f for one in self.recent]))
        before = self.shapes.get(key, ShapeSum.none(0))
        self.shapes[key] = before.with_shape(glimpse.shape, glimpse.at)

    def sightings(self) -> Sightings:
        """Return the mode in all its records, in their order."""
        rows = np.array(self.rows).reshape(-1, _COLUMNS)
        record, mode, severity = rows[:, (0, 1, 9)].astype(np.int64).T
        covariance = rows[:, 5:9].reshape(-1, 2, 2)
        return Sightings(record, mode, rows[:, 2], rows[:, 3], rows[:, 4], covariance, severity)

    def shape(self, keys: Iterable[Hashable], n_channels: int) -> ComplexArray:
        """Return the mean shape over the records of some keys; NaN where none of them has the channel."""
        total = ShapeSum.none(n_channels)
        for key in keys:
            if key in self.shapes:
                total = total.plus(self.shapes[key])
        return total.mean()


@dataclass(frozen=True)
class TrackedModes:
    """Records, and every mode followed through them.

    Attributes
    ----------
    records : tuple of str
        Their names.
    keys : tuple
        What each belongs to.
    duration_s : (n_records,)
    channels : tuple of Channel
        Of all records.
    shared : tuple of str
        Names of the channels that all records have.
    tracks : tuple of Track
    """

    records: tuple[str, ...]
    keys: tuple[Hashable, ...]
    duration_s: FloatArray
    channels: tuple[Channel, ...]
    shared: tuple[str, ...]
    tracks: tuple[Track, ...]


def follow(identifications: Iterable[tuple[Identification, Hashable]]) -> TrackedModes:
    """Follow the modes of records, each with a key that says which group it belongs to.

    Within a record, modes go to tracks such that the sum of the distances is least, none twice, so that
    modes that cross keep their shapes. A record is met once and not kept.

    Raises
    ------
    InputError
        If there is no record, some share no channel with the others, or one name stands for different
        sensors.
    """
    known: dict[str, Channel] = {}
    names: list[str] = []
    keys: list[Hashable] = []
    duration, sets = array("d"), dict[tuple[str, ...], None]()
    tracks: list[Track] = []
    active: list[Track] = []
    for number, (found, key) in enumerate(identifications):
        joined_channels(known, found)
        order = list(known)
        own = tuple(c.name for c in found.channels)
        channels = np.array([order.index(name) for name in own], dtype=np.int64)
        started = _join(active, found, channels, number, key)
        tracks += started
        active += started
        if number % PATIENCE == 0:
            active = [track for track in active if number - track.last < PATIENCE]
        sets[tuple(sorted(own))] = None
        names += found.records
        keys.append(key)
        duration.append(found.duration_s)
    if not keys:
        raise InputError("nothing to fuse", field="records", allowed="at least one record")
    if not tied(list(sets)):
        raise InputError(
            "records share no channel",
            field="records",
            value=[names[0], names[-1]],
            remedy="fuse records of the same sensors",
        )
    shared = set.intersection(*map(set, sets))
    return TrackedModes(
        records=tuple(names),
        keys=tuple(keys),
        duration_s=np.array(duration),
        channels=tuple(known.values()),
        shared=tuple(name for name in known if name in shared),
        tracks=tuple(_whole(tracks, len(known))),
    )


def _join(
    tracks: Sequence[Track], found: Identification, channels: Int64Array, number: int, key: Hashable
) -> list[Track]:
    """Give every mode of a record to the track it continues, or to a new one; return the new ones."""
    seen = [
        _Glimpse(channels, mode.mode_shape, _vagueness(mode), float(np.log(mode.frequency_hz)))
        for mode in found.modes
    ]
    near = [t for t in tracks if any(abs(t.log_f - s.log_f) < FREQUENCY_SCALE for s in seen)]
    taken: dict[int, Track] = {}
    if near:
        apart = np.array([_distance(track, seen) for track in near])
        for t, at in zip(*scipy.optimize.linear_sum_assignment(np.minimum(apart, SAME_MODE)), strict=True):
            if apart[t, at] < SAME_MODE:
                taken[int(at)] = near[int(t)]
    started = []
    for m, glimpse in enumerate(seen):
        if m not in taken:
            taken[m] = Track()
            started.append(taken[m])
        taken[m].add(number, m, found, glimpse, key)
    return started


def _distance(track: Track, seen: Sequence[_Glimpse]) -> FloatArray:
    """Return the distance of every mode of a record from a track, medians over its last records.

    Inside a close pair the shapes of one record mix: so much of 1 − MAC as their own uncertainty explains
    does not count. Shapes are compared by the channels both records have; where there is none, not at all.
    """
    size = 1 + max(int(one.at.max()) for one in (*seen, *track.recent))
    subspace_mac = _shared_mac(_spread(seen, size), _spread(list(track.recent), size))
    vague = np.add.outer([s.vagueness for s in seen], [s.vagueness for s in track.recent])
    unlike = np.maximum(1.0 - subspace_mac - SHAPE_SLACK * vague, 0.0)
    comparable = np.isfinite(subspace_mac).any(axis=0)
    if not comparable.any():
        return np.full(len(seen), np.inf)
    change = np.abs(np.array([s.log_f for s in seen]) - track.log_f)
    return np.asarray(change / FREQUENCY_SCALE + np.median(unlike[:, comparable], axis=1))


def _spread(glimpses: Sequence[_Glimpse], size: int) -> ComplexArray:
    """Return shapes over all channels, NaN where their record has none."""
    out = np.full((len(glimpses), size), np.nan, dtype=complex)
    for row, one in zip(out, glimpses, strict=True):
        row[one.at] = one.shape
    return out


def _shared_mac(a: ComplexArray, b: ComplexArray) -> FloatArray:
    """Return the MAC of shapes by the channels that both have, (n_a, n_b); NaN where there is none.

    >>> nan = np.nan
    >>> _shared_mac(np.array([[1.0, 2.0, nan]]), np.array([[2.0, 4.0, 9.0], [nan, nan, 1.0]])).tolist()
    [[1.0, nan]]
    """
    has_a, has_b = np.isfinite(a).astype(float), np.isfinite(b).astype(float)
    a, b = np.where(has_a > 0.0, a, 0.0), np.where(has_b > 0.0, b, 0.0)
    power = (np.abs(a) ** 2 @ has_b.T) * (has_a @ np.abs(b.T) ** 2)
    cross = np.abs(a.conj() @ b.T) ** 2
    return np.where(power > 0.0, cross / np.where(power > 0.0, power, 1.0), np.nan)


def _vagueness(mode: ModalEstimate) -> float:
    """Return the variance of a shape's entries over the square of its length."""
    if mode.mode_shape_std is None:
        return 0.0
    return float(np.sum(mode.mode_shape_std**2) / np.sum(np.abs(mode.mode_shape) ** 2))


def _whole(tracks: list[Track], n_channels: int) -> list[Track]:
    """Join tracks of one mode that was lost from sight and found again at another frequency.

    They are never seen together, and their mean shapes agree.
    """
    parts = [(track, track.sightings()) for track in tracks]
    long = [(t, s) for t, s in parts if len(s) >= FEWEST_OF_A_PART]
    out = [t for t, s in parts if len(s) < FEWEST_OF_A_PART]
    while long:
        track, seen = long.pop(0)
        found = _part_of(track, seen, long, n_channels)
        if found is None:
            out.append(track)
        else:
            other, _ = long.pop(found)
            merged = _merged(track, other)
            long.insert(0, (merged, merged.sightings()))
    return out


def _part_of(
    track: Track, seen: Sightings, others: Sequence[tuple[Track, Sightings]], n_channels: int
) -> int | None:
    """Return which of the others continues a track; None if none does."""
    shape = track.shape(track.shapes, n_channels)
    for i, (other, also) in enumerate(others):
        together = len(np.intersect1d(seen.record, also.record))
        if together > TOGETHER * min(len(seen), len(also)) or _gap(seen, also) > PART_REACH:
            continue
        others_shape = other.shape(other.shapes, n_channels)
        if np.count_nonzero(np.isfinite(shape) & np.isfinite(others_shape)) < PART_CHANNELS:
            continue
        if _shared_mac(shape[None], others_shape[None])[0, 0] > PART_MAC:
            return i
    return None


def _gap(a: Sightings, b: Sightings) -> float:
    """Return how far ln f of two tracks are apart, between their nearest values."""
    low = max(np.min(a.frequency_hz), np.min(b.frequency_hz))
    high = min(np.max(a.frequency_hz), np.max(b.frequency_hz))
    return max(0.0, float(np.log(low / high)))


def _merged(a: Track, b: Track) -> Track:
    """Return both as one; where both were seen, the first counts."""
    shapes = dict(a.shapes)
    for key, total in b.shapes.items():
        shapes[key] = shapes[key].plus(total) if key in shapes else total
    both = np.array([*a.rows, *b.rows]).reshape(-1, _COLUMNS)
    _, first = np.unique(both[:, 0], return_index=True)
    return Track(array("d", both[first].ravel()), b.recent, b.log_f, b.last, shapes)
