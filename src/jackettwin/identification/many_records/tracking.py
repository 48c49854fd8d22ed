"""Tracking of modes from record to record by shape and frequency, in nearly constant memory.

Records are added one by one. For a mode only a few dozen bytes per record are stored, besides its latest
shapes, by which it is recognised, and sums for its mean shape. The reference of a mode is updated with each
record: tide, temperature and scour may change a frequency by any amount, provided they do so slowly.
"""

from __future__ import annotations

from array import array
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.errors import InputError
from jackettwin.identification.many_records.setups import ShapeSum, add_channels, tied
from jackettwin.identification.many_records.sightings import Sightings, log_covariance
from jackettwin.identification.maximum_likelihood.line_likelihood import LOG_ZETA, NOISE_WEIGHTS

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Channel


FREQUENCY_SCALE = 0.03
"""Relative change of frequency that counts as much as orthogonal shapes."""
SHAPE_TOLERANCE = 2.0
"""Multiple of the variance of two shapes by which 1 − MAC is reduced before it counts."""
SAME_MODE = 1.0
"""Largest distance of one mode in two records, frequency and shape combined."""
MAX_ABSENCE = 500
"""Records without a mode after which its track ends; if it reappears, a new track starts,
and tracks are merged at the end."""
RECENT = 15
"""Number of records by which a mode is recognised: enough for a median, few enough to follow a drift."""
MIN_PART_RECORDS = 3
"""Fewest records of a track that is merged with another."""
PART_REACH = 0.1
"""Largest change of ln f across a gap between merged tracks."""
PART_MAC = 0.9
"""Smallest MAC of the mean shapes of merged tracks."""
PART_CHANNELS = 3
"""Fewest common channels for comparing these shapes."""
MAX_COMMON_SHARE = 0.05
"""Share of the shorter track's records above which common records show that two tracks are two modes."""
_COLUMNS = 10


@dataclass(frozen=True)
class _Observed:
    """A mode in one record: channels, shape, relative variance of the shape, ln f."""

    at: Int64Array
    shape: ComplexArray
    shape_variance: float
    log_f: float


@dataclass
class Track:
    """Track of one mode, which grows with every record that contains it.

    Attributes
    ----------
    rows : array of float
        Ten numbers per record, see ``sightings``.
    recent : deque
        The mode in the last ``RECENT`` records that contain it.
    log_f : float
        Median ln f over these.
    last : int
        Index of the last of them.
    shapes : dict
        Sums of its shapes over the records of each key.
    likelihoods : dict
        Likelihood of its damping in those records that have one, in single precision.
    """

    rows: array[float] = field(default_factory=lambda: array("d"))
    recent: deque[_Observed] = field(default_factory=lambda: deque(maxlen=RECENT))
    log_f: float = 0.0
    last: int = 0
    shapes: dict[Hashable, ShapeSum] = field(default_factory=dict)
    likelihoods: dict[int, npt.NDArray[np.float32]] = field(default_factory=dict)

    def add(self, number: int, m: int, found: Identification, observed: _Observed, key: Hashable) -> None:
        """Append mode ``m`` of record ``number``."""
        mode = found.modes[m]
        numbers = (
            mode.frequency_hz,
            mode.damping_ratio,
            found.duration_s,
            *log_covariance(mode).flat,
            mode.status.severity,
        )
        self.rows.extend((number, m, *numbers))
        if mode.damping_log_likelihood is not None:
            self.likelihoods[number] = mode.damping_log_likelihood.astype(np.float32)
        self.recent.append(observed)
        self.last = number
        self.log_f = float(np.median([one.log_f for one in self.recent]))
        before = self.shapes.get(key, ShapeSum.none(0))
        self.shapes[key] = before.with_shape(observed.shape, observed.at)

    def sightings(self) -> Sightings:
        """Return the estimates of the mode in all its records, in order."""
        rows = np.array(self.rows).reshape(-1, _COLUMNS)
        record, mode, severity = rows[:, (0, 1, 9)].astype(np.int64).T
        covariance = rows[:, 5:9].reshape(-1, 2, 2)
        likelihood = np.full((len(rows), len(NOISE_WEIGHTS), len(LOG_ZETA)), np.nan)
        for row, number in enumerate(record):
            if int(number) in self.likelihoods:
                # stored before ranges of noise were kept apart, it is the same in all
                likelihood[row] = self.likelihoods[int(number)]
        return Sightings(record, mode, rows[:, 2], rows[:, 3], rows[:, 4], covariance, severity, likelihood)

    def shape(self, keys: Iterable[Hashable], n_channels: int) -> ComplexArray:
        """Return the mean shape over the records of some keys; NaN at channels that none of them has."""
        total = ShapeSum.none(n_channels)
        for key in keys:
            if key in self.shapes:
                total = total.plus(self.shapes[key])
        return total.mean()


@dataclass(frozen=True)
class TrackedModes:
    """Records and the tracks of their modes.

    Attributes
    ----------
    records : tuple of str
        Names of the records.
    keys : tuple
        Group to which each belongs.
    duration_s : (n_records,)
    channels : tuple of Channel
        Channels of all records.
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
    """Track the modes of records, each with a key that names its group.

    Modes of a record are assigned to tracks, one each, such that the sum of the distances is smallest;
    thereby modes that cross are followed by their shapes. A record is read once and not stored.

    Raises
    ------
    InputError
        If there is no record, some share no channel with the others, or one name is used for different
        sensors.
    """
    known: dict[str, Channel] = {}
    names: list[str] = []
    keys: list[Hashable] = []
    duration, sets = array("d"), dict[tuple[str, ...], None]()
    tracks: list[Track] = []
    active: list[Track] = []
    for number, (found, key) in enumerate(identifications):
        add_channels(known, found.channels, found.records[0])
        order = list(known)
        own = tuple(c.name for c in found.channels)
        channels = np.array([order.index(name) for name in own], dtype=np.int64)
        started = _join(active, found, channels, number, key)
        tracks += started
        active += started
        if number % MAX_ABSENCE == 0:
            active = [track for track in active if number - track.last < MAX_ABSENCE]
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
        tracks=tuple(_merge_parts(tracks, len(known))),
    )


def _join(
    tracks: Sequence[Track], found: Identification, channels: Int64Array, number: int, key: Hashable
) -> list[Track]:
    """Assign every mode of a record to a track or to a new one; return the new ones."""
    seen = [
        _Observed(channels, mode.mode_shape, _shape_variance(mode), float(np.log(mode.frequency_hz)))
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
    for m, observed in enumerate(seen):
        if m not in taken:
            taken[m] = Track()
            started.append(taken[m])
        taken[m].add(number, m, found, observed, key)
    return started


def _distance(track: Track, seen: Sequence[_Observed]) -> FloatArray:
    """Return the distance of every mode of a record from a track, as medians over its latest records.

    The shapes of a close pair mix within a record; the part of 1 − MAC that their uncertainty explains is
    subtracted. Shapes are compared at common channels; without any, the distance is infinite.
    """
    size = 1 + max(int(one.at.max()) for one in (*seen, *track.recent))
    subspace_mac = _shared_mac(_spread(seen, size), _spread(list(track.recent), size))
    vague = np.add.outer([s.shape_variance for s in seen], [s.shape_variance for s in track.recent])
    unlike = np.maximum(1.0 - subspace_mac - SHAPE_TOLERANCE * vague, 0.0)
    comparable = np.isfinite(subspace_mac).any(axis=0)
    if not comparable.any():
        return np.full(len(seen), np.inf)
    change = np.abs(np.array([s.log_f for s in seen]) - track.log_f)
    return np.asarray(change / FREQUENCY_SCALE + np.median(unlike[:, comparable], axis=1))


def _spread(observed_modes: Sequence[_Observed], size: int) -> ComplexArray:
    """Return shapes over all channels, NaN where their record has no such channel."""
    out = np.full((len(observed_modes), size), np.nan, dtype=complex)
    for row, one in zip(out, observed_modes, strict=True):
        row[one.at] = one.shape
    return out


def _shared_mac(a: ComplexArray, b: ComplexArray) -> FloatArray:
    """Return the MAC of shapes at common channels, (n_a, n_b); NaN where there is none.

    >>> nan = np.nan
    >>> _shared_mac(np.array([[1.0, 2.0, nan]]), np.array([[2.0, 4.0, 9.0], [nan, nan, 1.0]])).tolist()
    [[1.0, nan]]
    """
    has_a, has_b = np.isfinite(a).astype(float), np.isfinite(b).astype(float)
    a, b = np.where(has_a > 0.0, a, 0.0), np.where(has_b > 0.0, b, 0.0)
    power = (np.abs(a) ** 2 @ has_b.T) * (has_a @ np.abs(b.T) ** 2)
    cross = np.abs(a.conj() @ b.T) ** 2
    return np.where(power > 0.0, cross / np.where(power > 0.0, power, 1.0), np.nan)


def _shape_variance(mode: ModalEstimate) -> float:
    """Return the variance of a shape's entries over the square of its length."""
    if mode.mode_shape_std is None:
        return 0.0
    return float(np.sum(mode.mode_shape_std**2) / np.sum(np.abs(mode.mode_shape) ** 2))


def _merge_parts(tracks: list[Track], n_channels: int) -> list[Track]:
    """Merge tracks of one mode that was lost and found again at another frequency.

    Such tracks have hardly any common record, and their mean shapes agree.
    """
    parts = [(track, track.sightings()) for track in tracks]
    long = [(t, s) for t, s in parts if len(s) >= MIN_PART_RECORDS]
    out = [t for t, s in parts if len(s) < MIN_PART_RECORDS]
    while long:
        track, seen = long.pop(0)
        found = _continuation(track, seen, long, n_channels)
        if found is None:
            out.append(track)
        else:
            other, _ = long.pop(found)
            merged = _merge(track, other)
            long.insert(0, (merged, merged.sightings()))
    return out


def _continuation(
    track: Track, seen: Sightings, others: Sequence[tuple[Track, Sightings]], n_channels: int
) -> int | None:
    """Return the index of the track that continues another, or None."""
    shape = track.shape(track.shapes, n_channels)
    for i, (other, also) in enumerate(others):
        together = len(np.intersect1d(seen.record, also.record))
        if together > MAX_COMMON_SHARE * min(len(seen), len(also)) or _gap(seen, also) > PART_REACH:
            continue
        others_shape = other.shape(other.shapes, n_channels)
        if np.count_nonzero(np.isfinite(shape) & np.isfinite(others_shape)) < PART_CHANNELS:
            continue
        if _shared_mac(shape[None], others_shape[None])[0, 0] > PART_MAC:
            return i
    return None


def _gap(a: Sightings, b: Sightings) -> float:
    """Return the gap between the ranges of ln f of two tracks."""
    low = max(np.min(a.frequency_hz), np.min(b.frequency_hz))
    high = min(np.max(a.frequency_hz), np.max(b.frequency_hz))
    return max(0.0, float(np.log(low / high)))


def _merge(a: Track, b: Track) -> Track:
    """Return two tracks as one; if both have a record, the first is used."""
    shapes = dict(a.shapes)
    for key, total in b.shapes.items():
        shapes[key] = shapes[key].plus(total) if key in shapes else total
    both = np.array([*a.rows, *b.rows]).reshape(-1, _COLUMNS)
    _, first = np.unique(both[:, 0], return_index=True)
    likelihoods = b.likelihoods | a.likelihoods
    return Track(array("d", both[first].ravel()), b.recent, b.log_f, b.last, shapes, likelihoods)
