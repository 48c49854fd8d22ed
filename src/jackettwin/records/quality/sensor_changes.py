r"""Channels that change while a record runs: a sensor that dies, a gain or a sign that is another afterwards.

Sensors on one structure repeat each other. In a band of frequencies, a channel is the same combination of the
others as long as the structure moves in few modes there,

.. math:: z_i(t) \approx \sum_j b_j z_j(t),

z the complex envelopes of the band. With b from a stretch of the record, the gain of the channel against its
prediction, :math:`g = \langle \hat z_i, z_i\rangle / \langle\hat z_i, \hat z_i\rangle` over each part, is one
throughout if the sensor is sound. A force that changes moves all channels, and leaves g at one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.records.processing.spectra import of_fast_length
from jackettwin.records.quality.sensor_polarity import LEAST_CYCLES, strongest_line
from jackettwin.signals import tukey

PARTS = 20
"""Parts of a record over which the gain is taken."""
FEWEST_PARTS = 4
"""On either side of a change."""
LEARNT_FROM = (slice(0, 10), slice(10, 20), slice(0, 6), slice(14, 20))
"""Parts from which a prediction is learnt: one of them lies on one side of any change."""
BANDS = 8
"""Octaves looked at, from below the strongest line up."""
LINES_A_PART = (2, 24)
"""Spectral lines of a band for each part, least and most."""
WELL_EXPLAINED = 0.98
"""Coherence that makes it needless to look at further bands."""
IN_MOST = 0.8
"""Median over the parts of the coherence there: what is explained must not be a single event."""
CASES_A_CHANNEL = 8.0
"""Envelope samples needed for each channel of a prediction."""
MOST_OTHERS = 6
"""Channels a prediction is made from at most: those most like the one predicted."""
EXPLAINED = 0.95
"""Coherence with the prediction on a side of the change on which a channel follows the others."""
FACTOR = 1.5
"""Least change of gain that is reported."""
CLEARER = 4.0
"""So many times less must be left unexplained by two gains than by one, and than the others move where one
shows nothing."""
DEAD = 0.15
"""Gain below which a channel shows nothing of what the others do."""
PRESENT = 0.9
"""Share of the samples of a part that must be there."""


@dataclass(frozen=True)
class SensorChange:
    """A channel that is another after some time, or before it.

    Attributes
    ----------
    row : int
    start, stop : int
        Samples that do not go with the rest, the shorter side of the change.
    gain : float
        There, over that of the rest; negative for a turned sign, 0 for a channel that shows nothing.
    certain : bool
        Whether it is this channel: others agree among themselves, or it shows nothing at all.
    """

    row: int
    start: int
    stop: int
    gain: float
    certain: bool


def described(change: SensorChange, step_s: float) -> str:
    """Return a change in words.

    >>> described(SensorChange(0, 6000, 12000, 3.02, True), 0.05)
    'is 3.0 times as sensitive from 300 s on as before'
    """
    at, than = (change.start, "before") if change.start else (change.stop, "afterwards")
    when = f"from {at * step_s:.0f} s on" if change.start else f"until {at * step_s:.0f} s"
    if change.gain == 0.0:
        return f"shows nothing of what the other channels do {when}"
    if change.gain < 0.0:
        return f"moves against its own sense {when}, {-change.gain:.1f} times as strong as {than}"
    return f"is {change.gain:.1f} times as sensitive {when} as {than}"


def changes(y: FloatArray) -> list[SensorChange]:
    """Return the channels that change during a record, one change each, the clearest first.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks missing samples.
    """
    out: list[SensorChange] = []
    rows = [i for i in range(len(y)) if np.isfinite(y[i]).any() and np.nanstd(y[i]) > 0.0]
    bands = _envelopes(y) if rows else []
    there = _present(y) if bands else np.empty((0, PARTS), dtype=np.bool_)
    while len(rows) >= 2 and bands:
        found = [change for i in rows if (change := _change(bands, there, rows, i)) is not None]
        if not found:
            break
        worst = max(found, key=lambda one: abs(one.gain - 1.0) / max(1.0, abs(one.gain)))
        start, stop = (np.array([worst.start, worst.stop]) * y.shape[1]) // PARTS
        out.append(SensorChange(worst.row, int(start), int(stop), worst.gain, worst.certain))
        if not worst.certain:
            break
        rows.remove(worst.row)
    return out


def _envelopes(y: FloatArray) -> list[ComplexArray]:
    """Return the complex envelopes of all channels in octaves, each (n_channels, PARTS · samples a part).

    The ends are tapered, lest the jump between them leak into every band.
    """
    out: list[ComplexArray] = []
    y = of_fast_length(y)
    n = y.shape[1]
    if n < 4 * LEAST_CYCLES:
        return out
    taper = tukey(n, 1.0 / PARTS)
    spectra = np.fft.rfft(np.where(np.isfinite(y), y, 0.0) * taper, axis=1)
    low = max(int(strongest_line(spectra) / np.sqrt(2.0)), LEAST_CYCLES)
    for _ in range(BANDS):
        lines = min(max(low // PARTS, LINES_A_PART[0]), LINES_A_PART[1]) * PARTS
        if low + lines > spectra.shape[1]:
            break
        out.append(np.fft.ifft(spectra[:, low : low + lines], axis=1))
        low *= 2
    return out


def _present(y: FloatArray) -> BoolArray:
    """Return which parts of which channels hold samples enough, (n_channels, PARTS)."""
    parts = np.array_split(np.isfinite(y), PARTS, axis=1)
    return np.array([part.mean(axis=1) for part in parts]).T >= PRESENT


def _change(bands: list[ComplexArray], there: BoolArray, rows: list[int], i: int) -> SensorChange | None:
    """Return the change of channel i, in parts, in the first band in which the others explain it well."""
    best: _Against | None = None
    for z in bands:
        for some in LEARNT_FROM:
            seen = _against_others(z, there, rows, i, some)
            if seen is not None and (best is None or seen.explained > best.explained):
                best = seen
        if best is not None and best.explained > WELL_EXPLAINED:
            break
    if best is None or best.explained < EXPLAINED:
        return None
    return _split(i, best, certain=len(rows) > 2)


@dataclass(frozen=True)
class _Against:
    """A channel beside its prediction: products summed over each part, zero where samples are missing."""

    explained: float
    cross: ComplexArray
    predicted: FloatArray
    own: FloatArray

    def over(self, parts: slice) -> _Against:
        """Return the sums over some parts, and the coherence there."""
        cross, predicted, own = self.cross[parts], self.predicted[parts], self.own[parts]
        power = max(float(predicted.sum()) * float(own.sum()), np.finfo(float).tiny)
        return _Against(float(np.abs(cross.sum())) / power**0.5, cross, predicted, own)

    @property
    def follows(self) -> bool:
        """Whether the channel follows its prediction, in most of the parts."""
        there = self.predicted > 0.0
        power = np.sqrt(np.maximum(self.predicted * self.own, np.finfo(float).tiny))
        in_most = float(np.median((np.abs(self.cross) / power)[there])) if there.any() else 0.0
        return self.explained > EXPLAINED and in_most > IN_MOST

    @property
    def gain(self) -> complex:
        """Of the sums."""
        return complex(self.cross.sum() / max(float(self.predicted.sum()), np.finfo(float).tiny))

    @property
    def left_over(self) -> float:
        """Power of the channel its prediction does not explain."""
        return float(self.own.sum()) * (1.0 - self.explained**2)

    def a_part(self, power: float) -> float:
        """Return so much power over the parts in which samples are there."""
        return power / max(int(np.count_nonzero(self.predicted)), 1)


def _against_others(
    z: ComplexArray, there: BoolArray, rows: list[int], i: int, some: slice
) -> _Against | None:
    """Return a channel beside its prediction by the others, learnt in some parts of the record."""
    parts = z.reshape(len(z), PARTS, -1)
    others = [j for j in rows if j != i]
    learn = np.zeros(PARTS, dtype=np.bool_)
    learn[some] = True
    learn &= there[[i, *others]].all(axis=0)
    x, own = parts[others][:, learn].reshape(len(others), -1), parts[i][learn].ravel()
    if own.size < CASES_A_CHANNEL or not np.any(own):
        return None
    keep = _most_alike(x, own, min(MOST_OTHERS, int(own.size // CASES_A_CHANNEL)))
    used = [others[k] for k in keep]
    b, *_ = np.linalg.lstsq(x[keep].T, own, rcond=1e-6)
    predicted = np.tensordot(b, parts[used], axes=1)
    valid = there[[i, *used]].all(axis=0)
    products = (predicted.conj() * parts[i], np.abs(predicted) ** 2, np.abs(parts[i]) ** 2)
    cross, power, mine = (np.where(valid, np.sum(product, axis=1), 0.0) for product in products)
    whole = _Against(0.0, cross, power.real, mine.real)
    return replace(whole, explained=whole.over(some).explained)


def _most_alike(x: ComplexArray, own: ComplexArray, n: int) -> IntArray:
    power = np.sqrt(np.sum(np.abs(x) ** 2, axis=1))
    subspace_mac = np.abs(x.conj() @ own) / np.where(power > 0.0, power, np.inf)
    return np.sort(np.argsort(-subspace_mac)[: max(n, 1)])


def _split(i: int, seen: _Against, *, certain: bool) -> SensorChange | None:
    """Return the change where two gains explain the channel best; None if one does as well.

    The part in which the change lies belongs to neither side.
    """
    splits = {
        k: (seen.over(slice(0, k)), seen.over(slice(k + 1, PARTS)))
        for k in range(FEWEST_PARTS, PARTS - FEWEST_PARTS)
        if min(np.count_nonzero(seen.predicted[:k]), np.count_nonzero(seen.predicted[k + 1 :])) >= 3
    }
    if not splits:
        return None
    k = min(splits, key=lambda k: splits[k][0].left_over + splits[k][1].left_over)
    left, right = splits[k]
    gain = _gain_of_the_worse(left, right, first=k >= PARTS // 2)
    rest = left.left_over + right.left_over
    if gain is None or (gain[0] != 0.0 and CLEARER * rest > seen.over(slice(0, PARTS)).left_over):
        return None
    ratio, worse_is_left = gain
    start, stop = (0, k + 1) if worse_is_left else (k, PARTS)
    return SensorChange(i, start, stop, ratio, certain or ratio == 0.0)


def _gain_of_the_worse(left: _Against, right: _Against, *, first: bool) -> tuple[float, bool] | None:
    """Return the gain of the worse side over that of the better, and whether the worse is the left.

    The worse is the one that shows nothing, else the shorter; None if the sides are alike or neither tells.
    """
    sound = [side.follows for side in (left, right)]
    if not any(sound):
        return None
    better_is_left = sound[0] and (first or not sound[1])
    better, worse = (left, right) if better_is_left else (right, left)
    ratio = worse.gain / better.gain
    if abs(ratio) < DEAD and not all(sound):
        # where a structure comes to rest, what is left of a prediction is noise
        moves = worse.a_part(float(worse.predicted.sum())) > CLEARER * better.a_part(better.left_over)
        return (0.0, not better_is_left) if moves else None
    turned = abs(ratio.imag) > 0.5 * abs(ratio)
    if not all(sound) or turned or 1.0 / FACTOR < ratio.real < FACTOR:
        return None
    return float(ratio.real), not better_is_left
