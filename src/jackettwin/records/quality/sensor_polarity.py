"""Detection of sensors with reversed sign.

A record alone does not determine the sign of a sensor: if it is reversed, its entry of every mode shape
changes sign, which is an equally valid shape. Two facts about the structure are used:

* two parallel sensors at one place (one ``node``, or one height on the tower axis) move together always;
* in the first bending mode of a tower, and below it, every point of its axis moves the same way. Channels
  with a ``height_m`` must be in phase in the strongest narrow band of displacement, where that mode or what
  is slower prevails (higher bending modes move top and middle against each other by nature).

On a bridge, or off the axis of a building, neighbours may move against each other from the first mode on;
then no finding is given. Nor is one given if the same channels move together in a nearby band,
unlike those of a tower: then torsion, or another kind of structure, separates them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.records.processing.filters import bridge, fade_weight
from jackettwin.records.processing.spectra import hann_lines
from jackettwin.records.quality import faults

if TYPE_CHECKING:
    from jackettwin.records.record import Channel, Record


BAND, BAND_LINES = 0.15, 3
"""Half width of the band around the strongest line, as a share of its frequency, and at least in lines."""
WEAK_BAND, WEAK_BAND_LINES = 0.05, 5
"""The same around a weaker peak, between which and the stronger one motions mix; eleven lines, of which every
second is independent, are coherent by chance in one of five thousand."""
MIN_CYCLES = 20
"""Fewest cycles of the band's frequency in the record."""
CERTAIN = 0.9
"""Absolute coherency in the band above which a sign is certain."""
WIDTH = 1.3
"""Ratio of upper to lower edge of the bands in which a sign is confirmed."""
NEARBY_RATIO = 2.5
"""Ratio of frequencies within which bands are nearby; the second bending mode of a tower is farther."""
MIN_BANDS = 4
"""Fewest bands in which sensors at one place must move together."""
NOISE_COHERENCY = 0.3
"""Absolute coherency that noise alone reaches in a band."""
SAME_SIZE = 1.25
"""Largest ratio of the amplitudes of two sensors at one place."""
SECOND_MODE = 3.5
"""Ratio of the frequencies of the second and the first bending mode of a tower, at least; those of the third
and the second are closer."""
MIN_PEAK, FLOOR = 10.0, (1.25, 2.0)
"""Least power density of a peak over the lowest quarter of that beside it, and the ratios of frequencies
within which that is. The maximum of five averaged lines of smooth noise is 4 times that quarter."""
LEAST_USED = 0.5
"""Least mean weight of the samples: with less the few lines of a band are coherent by chance."""
PARALLEL = 0.98
"""Cosine of the angle above which two channels measure the same motion."""


@dataclass(frozen=True)
class SharedMotion:
    """Common motion of parallel channels.

    Attributes
    ----------
    rows : list of int
        Rows of the record.
    peak : float
        Line at which channels are compared: the strongest of displacement, or of a tower's lowest mode.
    size : (n,) array
        Amplitude around that line.
    coherency : (n, n) array
        Real part of the coherency around that line, with signs by the stated directions.
    bands : list of (float, (n, n) array)
        Middle and coherency of the bands over all frequencies.
    """

    rows: list[int]
    peak: float
    size: FloatArray
    coherency: FloatArray
    bands: list[tuple[float, FloatArray]]


@dataclass(frozen=True)
class ParallelChannels:
    """Parallel channels at one place (``heights`` is None), or at several heights of a tower."""

    seen: SharedMotion
    heights: list[float] | None = None


def parallel_groups(record: Record, y: FloatArray) -> Iterator[ParallelChannels]:
    """Yield groups of parallel accelerations whose places determine how they move together.

    Parameters
    ----------
    record : Record
    y : (n_channels, n_samples)
        Its samples without mean and drift; NaN marks missing ones.
    """
    for rows, senses in _parallel(record, y):
        used = [k for k, i in enumerate(rows) if fade_weight(y[i : i + 1]).mean() >= LEAST_USED]
        rows = [rows[k] for k in used]
        places = [_place(record.channels[i]) for i in rows]
        if all(place is None for place in places):
            continue
        own = y[rows] * senses[used, None]
        fade = fade_weight(own)
        if len(rows) < 2 or fade.mean() < LEAST_USED:
            continue
        spectra = _windowed_spectra(own, fade)
        for together in _one_place(places):
            yield ParallelChannels(_together(rows, together, spectra))
        tower = [k for k, place in enumerate(places) if isinstance(place, float)]
        if len({places[k] for k in tower}) > 1:
            heights = [place for k in tower if isinstance(place := places[k], float)]
            yield ParallelChannels(_together(rows, tower, spectra, tower=True), heights)


def reversed_channels(record: Record, groups: Sequence[ParallelChannels]) -> dict[str, bool]:
    """Return channels that move against parallel ones: True if certain, False if doubtful.

    Parameters
    ----------
    record : Record
    groups : of ``parallel_groups``
    """
    found: dict[str, bool] = {}
    for group in groups:
        against = (
            _against_same_place(group.seen)
            if group.heights is None
            else _against_tower(group.seen, group.heights)
        )
        found.update({record.channels[group.seen.rows[i]].name: certain for i, certain in against})
    return found


def band_coherency(inside: ComplexArray) -> FloatArray:
    """Return the real part of the coherency between rows, from lines of their spectra.

    Returns
    -------
    (n_channels, n_channels) array
        Between −1 and 1; zeros where a row does not move.
    """
    cross = np.real(inside @ inside.conj().T)
    power = np.sqrt(np.outer(np.diag(cross), np.diag(cross)))
    coherency: FloatArray = np.where(power > 0.0, cross / np.where(power > 0.0, power, 1.0), 0.0)
    return coherency


def strongest_line(spectra: ComplexArray) -> int:
    """Return the line of the strongest displacement, with each channel scaled to unit power.

    Parameters
    ----------
    spectra : (n_channels, n_lines) complex
        Transforms of accelerations, more than ``MIN_CYCLES`` lines.
    """
    k = np.arange(MIN_CYCLES, spectra.shape[1])
    common = np.zeros(k.size)
    for row in spectra:
        displacement = np.abs(row[MIN_CYCLES:] / k**2) ** 2
        common += displacement / max(float(displacement.sum()), np.finfo(float).tiny)
    return int(k[np.argmax(np.convolve(common, np.ones(5), mode="same"))])


def strongest_peak(spectra: ComplexArray) -> tuple[int, ComplexArray]:
    """Return the strongest line of displacement and the lines around it."""
    peak = strongest_line(spectra)
    return peak, around(spectra, peak)


def lowest_shared_peak(spectra: ComplexArray) -> tuple[int, ComplexArray]:
    """Return the lowest clear peak at which all channels are coherent, and the lines around it.

    It counts if it is as far below the strongest line of acceleration as the first mode of a tower is
    below the second; otherwise it is the strongest line of displacement, of a second mode or of noise maybe.

    Parameters
    ----------
    spectra : (n_channels, n_lines) complex
        Transforms of accelerations, more than ``MIN_CYCLES`` lines.
    """
    power = np.array([np.convolve(np.abs(row) ** 2, np.ones(5), mode="same") for row in spectra])
    common = np.sum(power / np.maximum(power.mean(axis=1, keepdims=True), np.finfo(float).tiny), axis=0)
    for k in range(MIN_CYCLES, int(np.argmax(common) / SECOND_MODE)):
        if common[k] < common[int(k / (1.0 + BAND)) : int(k * (1.0 + BAND)) + 1].max():
            continue
        beside = np.r_[int(k / FLOOR[1]) : int(k / FLOOR[0]), int(k * FLOOR[0]) : int(k * FLOOR[1])]
        near = around(spectra, k, WEAK_BAND, WEAK_BAND_LINES)
        clear = common[k] > MIN_PEAK * np.quantile(common[beside], 0.25)
        if clear and np.abs(band_coherency(near)).min() > CERTAIN:
            return k, near
    return strongest_peak(spectra)


def around(spectra: ComplexArray, peak: float, share: float = BAND, least: int = BAND_LINES) -> ComplexArray:
    """Return the lines of the narrow band around a line."""
    k = np.arange(spectra.shape[1])
    return spectra[:, np.abs(k - peak) <= max(share * peak, least)]


def against_majority(coherency: FloatArray) -> tuple[list[int], bool]:
    """Return the rows in counterphase with the others, and whether that is certain.

    Certainty needs at least three rows whose coherencies all exceed ``CERTAIN``, and a majority.
    With two rows, or equal numbers on either side, it is only known that they disagree.

    >>> against_majority(np.array([[1.0, 0.99, -0.98], [0.99, 1.0, -0.97], [-0.98, -0.97, 1.0]]))
    ([2], True)
    """
    clear = np.flatnonzero(np.mean(np.abs(coherency) > CERTAIN, axis=1) > 0.5)
    if len(clear) < 2:
        return [], False
    among = coherency[np.ix_(clear, clear)]
    signs = np.sign(np.linalg.eigh(among)[1][:, -1])
    negative, positive = clear[signs < 0.0], clear[signs >= 0.0]
    minority = negative if len(negative) <= len(positive) else positive
    certain = len(negative) != len(positive) and bool(np.all(np.abs(among) > CERTAIN))
    return [int(i) for i in minority], certain


def _parallel(record: Record, y: FloatArray) -> Iterator[tuple[list[int], FloatArray]]:
    """Yield groups of live accelerations along one line of one frame, with the sense of each."""
    left = [
        i
        for i, channel in enumerate(record.channels)
        if channel.quantity == "acceleration" and any(channel.direction) and not faults.is_constant(y[i])
    ]
    while left and y.shape[1] >= 4 * MIN_CYCLES:
        lead = record.channels[left[0]]
        along = {
            i: float(np.array(lead.direction) @ np.array(record.channels[i].direction))
            for i in left
            if record.channels[i].frame == lead.frame
        }
        rows = [i for i, cosine in along.items() if abs(cosine) > PARALLEL]
        left = [i for i in left if i not in rows]
        if len(rows) > 1:
            yield rows, np.sign([along[i] for i in rows])


def _windowed_spectra(y: FloatArray, fade: FloatArray) -> ComplexArray:
    """Return the transforms of rows under a Hann window times ``fade``, with gaps bridged."""
    share = fade / fade.sum()
    bridged = map(bridge, y)  # one row at a time: copies of a day's channels take memory
    lines = [own for own in hann_lines((row - row @ share) * fade for row in bridged)]
    return np.array(lines)


def _place(channel: Channel) -> str | float | None:
    """Return the node a channel sits at, else its height on the tower axis, else None."""
    return channel.node if channel.node is not None else channel.height_m


def _one_place(places: list[str | float | None]) -> Iterator[list[int]]:
    for place in dict.fromkeys(p for p in places if p is not None):
        group = [k for k, other in enumerate(places) if other == place]
        if len(group) > 1:
            yield group


def _together(
    rows: list[int], chosen: list[int], all_spectra: ComplexArray, *, tower: bool = False
) -> SharedMotion:
    picked, spectra = [rows[k] for k in chosen], all_spectra[chosen]
    peak, inside = lowest_shared_peak(spectra) if tower else strongest_peak(spectra)
    n_bands = max(int(np.log((spectra.shape[1] - 1) / MIN_CYCLES) / np.log(WIDTH)), 0)
    edges = (MIN_CYCLES * WIDTH ** np.arange(n_bands + 1)).astype(np.int64)
    bands = [((a + b) / 2.0, band_coherency(spectra[:, a:b])) for a, b in pairwise(edges)]
    size = np.linalg.norm(inside, axis=1)
    return SharedMotion(picked, float(peak), size, band_coherency(inside), bands)


def one_motion(seen: SharedMotion) -> bool:
    """Tell whether channels show one motion up to size and sign: coherent in four bands, with one sign."""
    coherencies = np.array([coherency for _, coherency in seen.bands])
    clear = np.abs(coherencies) > CERTAIN
    same = np.sign(coherencies) == np.sign(seen.coherency)
    return bool(
        np.all(clear.sum(axis=0) >= MIN_BANDS) and np.all(same | (np.abs(coherencies) < NOISE_COHERENCY))
    )


def _against_same_place(seen: SharedMotion) -> Iterator[tuple[int, bool]]:
    """Yield channels that move against the others at one place in all coherent bands."""
    minority, certain = against_majority(seen.coherency)
    if minority and one_motion(seen):
        yield from ((i, certain) for i in minority)


def _against_tower(seen: SharedMotion, heights: list[float]) -> Iterator[tuple[int, bool]]:
    """Yield the channels of a tower that are in counterphase in its first mode."""
    minority, certain = against_majority(seen.coherency)
    if not minority or _off_axis(seen, heights):
        return
    for i in minority:
        for middle, coherency in seen.bands:
            nearby = 1.0 / NEARBY_RATIO < middle / seen.peak < NEARBY_RATIO
            together = [j for j in np.flatnonzero(coherency[i] > CERTAIN) if j not in minority]
            if together and (nearby or any(heights[j] == heights[i] for j in together)):
                return
    yield from ((i, certain) for i in minority)


def _off_axis(seen: SharedMotion, heights: list[float]) -> bool:
    """Tell whether sensors at one height differ in motion, so that not all are on the axis."""
    return any(
        abs(seen.coherency[i, j]) < CERTAIN
        or max(seen.size[i], seen.size[j]) > SAME_SIZE * min(seen.size[i], seen.size[j])
        for i, j in combinations(range(len(heights)), 2)
        if heights[i] == heights[j]
    )
