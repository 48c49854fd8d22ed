r"""Changes of a sensor during a record: failure, or a change of gain or sign.

Sensors on one structure are correlated. Within a frequency band in which the structure moves in few modes,
a channel is a constant combination of the others,

.. math:: z_i(t) \approx \sum_j b_j z_j(t),

where z are the complex envelopes of the band.
With b from one part of the record, the gain of the channel relative to its prediction,
:math:`g = \langle \hat z_i, z_i\rangle / \langle\hat z_i, \hat z_i\rangle` in each part,
remains one if the sensor is intact. A change of the forces affects all channels and leaves g at one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.records.quality.sensor_polarity import MIN_CYCLES, strongest_line
from jackettwin.signals import of_fast_length, tukey

PARTS = 20
"""Parts of a record over which the gain is taken."""
MIN_PARTS = 4
"""Fewest parts on each side of a change."""
LEARNING_PARTS = (slice(0, 10), slice(10, 20), slice(0, 6), slice(14, 20))
"""Parts from which a prediction is learnt; for any change, one of them is on one side of it."""
BANDS = 8
"""Number of octaves examined, upwards from just below the strongest line."""
LINES_PER_PART = (2, 24)
"""Fewest and most spectral lines of a band per part."""
SUFFICIENT_COHERENCE = 0.98
"""Coherence above which no further bands are examined."""
MIN_MEDIAN_COHERENCE = 0.8
"""Smallest median of that coherence over the parts, so that it does not rest on a single event."""
CASES_PER_CHANNEL = 8.0
"""Fewest envelope samples per channel of a prediction."""
MAX_OTHERS = 6
"""Most channels in a prediction: those most similar to the one predicted."""
EXPLAINED = 0.95
"""Smallest coherence with the prediction on one side of the change."""
FACTOR = 1.5
"""Smallest change of gain that is reported."""
MIN_POWER_RATIO = 4.0
"""Factor by which the unexplained power must be smaller with two gains than with one,
and than the motion of the others where the channel shows nothing."""
DEAD = 0.15
"""Gain below which a channel is dead."""
PRESENT = 0.9
"""Smallest share of present samples in a part."""


@dataclass(frozen=True)
class SensorChange:
    """A channel that differs before and after some time.

    Attributes
    ----------
    row : int
    start, stop : int
        Samples of the shorter side of the change.
    gain : float
        Gain there relative to the rest; negative for a reversed sign, 0 for a dead channel.
    certain : bool
        Whether this channel is at fault: the others agree among themselves, or it is dead.
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

    The ends are tapered, so that the jump between them does not leak into every band.
    """
    out: list[ComplexArray] = []
    y = of_fast_length(y)
    n = y.shape[1]
    if n < 4 * MIN_CYCLES:
        return out
    taper = tukey(n, 1.0 / PARTS)
    spectra = np.empty((len(y), n // 2 + 1), dtype=complex)
    for row, lines in zip(y, spectra, strict=True):
        lines[:] = np.fft.rfft(np.where(np.isfinite(row), row, 0.0) * taper)
    low = max(int(strongest_line(spectra) / np.sqrt(2.0)), MIN_CYCLES)
    for _ in range(BANDS):
        lines = min(max(low // PARTS, LINES_PER_PART[0]), LINES_PER_PART[1]) * PARTS
        if low + lines > spectra.shape[1]:
            break
        out.append(np.fft.ifft(spectra[:, low : low + lines], axis=1))
        low *= 2
    return out


def _present(y: FloatArray) -> BoolArray:
    """Tell which parts of which channels have enough samples, (n_channels, PARTS)."""
    parts = np.array_split(np.isfinite(y), PARTS, axis=1)
    return np.array([part.mean(axis=1) for part in parts]).T >= PRESENT


def _change(bands: list[ComplexArray], there: BoolArray, rows: list[int], i: int) -> SensorChange | None:
    """Return the change of channel i, in parts, in the first band in which the others explain it well."""
    best: _Prediction | None = None
    for z in bands:
        for some in LEARNING_PARTS:
            seen = _prediction(z, there, rows, i, some)
            if seen is not None and (best is None or seen.explained > best.explained):
                best = seen
        if best is not None and best.explained > SUFFICIENT_COHERENCE:
            break
    if best is None or best.explained < EXPLAINED:
        return None
    return _split(i, best, certain=len(rows) > 2)


@dataclass(frozen=True)
class _Prediction:
    """A channel and its prediction: products summed over each part, zero where samples are missing."""

    explained: float
    cross: ComplexArray
    predicted: FloatArray
    own: FloatArray

    def over(self, parts: slice) -> _Prediction:
        """Return the sums over some parts, and the coherence there."""
        cross, predicted, own = self.cross[parts], self.predicted[parts], self.own[parts]
        power = max(float(predicted.sum()) * float(own.sum()), np.finfo(float).tiny)
        return _Prediction(float(np.abs(cross.sum())) / power**0.5, cross, predicted, own)

    @property
    def follows(self) -> bool:
        """Whether the channel follows its prediction, in most of the parts."""
        there = self.predicted > 0.0
        power = np.sqrt(np.maximum(self.predicted * self.own, np.finfo(float).tiny))
        in_most = float(np.median((np.abs(self.cross) / power)[there])) if there.any() else 0.0
        return self.explained > EXPLAINED and in_most > MIN_MEDIAN_COHERENCE

    @property
    def gain(self) -> complex:
        """Gain from the sums."""
        return complex(self.cross.sum() / max(float(self.predicted.sum()), np.finfo(float).tiny))

    @property
    def left_over(self) -> float:
        """Power of the channel that its prediction does not explain."""
        return float(self.own.sum()) * (1.0 - self.explained**2)

    def a_part(self, power: float) -> float:
        """Return a power per part with samples."""
        return power / max(int(np.count_nonzero(self.predicted)), 1)


def _prediction(
    z: ComplexArray, there: BoolArray, rows: list[int], i: int, some: slice
) -> _Prediction | None:
    """Return a channel and its prediction by the others, learnt from some parts of the record."""
    parts = z.reshape(len(z), PARTS, -1)
    others = [j for j in rows if j != i]
    learn = np.zeros(PARTS, dtype=np.bool_)
    learn[some] = True
    learn &= there[[i, *others]].all(axis=0)
    x, own = parts[others][:, learn].reshape(len(others), -1), parts[i][learn].ravel()
    if own.size < CASES_PER_CHANNEL or not np.any(own):
        return None
    keep = _most_alike(x, own, min(MAX_OTHERS, int(own.size // CASES_PER_CHANNEL)))
    used = [others[k] for k in keep]
    b, *_ = np.linalg.lstsq(x[keep].T, own, rcond=1e-6)
    predicted = np.tensordot(b, parts[used], axes=1)
    valid = there[[i, *used]].all(axis=0)
    products = (predicted.conj() * parts[i], np.abs(predicted) ** 2, np.abs(parts[i]) ** 2)
    cross, power, mine = (np.where(valid, np.sum(product, axis=1), 0.0) for product in products)
    whole = _Prediction(0.0, cross, power.real, mine.real)
    return replace(whole, explained=whole.over(some).explained)


def _most_alike(x: ComplexArray, own: ComplexArray, n: int) -> IntArray:
    power = np.sqrt(np.sum(np.abs(x) ** 2, axis=1))
    subspace_mac = np.abs(x.conj() @ own) / np.where(power > 0.0, power, np.inf)
    return np.sort(np.argsort(-subspace_mac)[: max(n, 1)])


def _split(i: int, seen: _Prediction, *, certain: bool) -> SensorChange | None:
    """Return the change at which two gains explain the channel best; None if one gain suffices.

    The part that contains the change belongs to neither side.
    """
    splits = {
        k: (seen.over(slice(0, k)), seen.over(slice(k + 1, PARTS)))
        for k in range(MIN_PARTS, PARTS - MIN_PARTS)
        if min(np.count_nonzero(seen.predicted[:k]), np.count_nonzero(seen.predicted[k + 1 :])) >= 3
    }
    if not splits:
        return None
    k = min(splits, key=lambda k: splits[k][0].left_over + splits[k][1].left_over)
    left, right = splits[k]
    gain = _gain_of_the_worse(left, right, first=k >= PARTS // 2)
    rest = left.left_over + right.left_over
    if gain is None or (gain[0] != 0.0 and MIN_POWER_RATIO * rest > seen.over(slice(0, PARTS)).left_over):
        return None
    ratio, worse_is_left = gain
    start, stop = (0, k + 1) if worse_is_left else (k, PARTS)
    return SensorChange(i, start, stop, ratio, certain or ratio == 0.0)


def _gain_of_the_worse(left: _Prediction, right: _Prediction, *, first: bool) -> tuple[float, bool] | None:
    """Return the gain of the faulty side relative to the other, and whether it is the left one.

    The faulty side is the dead one, else the shorter; None if the sides are alike or neither is coherent.
    """
    sound = [side.follows for side in (left, right)]
    if not any(sound):
        return None
    better_is_left = sound[0] and (first or not sound[1])
    better, worse = (left, right) if better_is_left else (right, left)
    ratio = worse.gain / better.gain
    if abs(ratio) < DEAD and not all(sound):
        # where a structure comes to rest, the unexplained power is noise
        moves = worse.a_part(float(worse.predicted.sum())) > MIN_POWER_RATIO * better.a_part(better.left_over)
        return (0.0, not better_is_left) if moves else None
    turned = abs(ratio.imag) > 0.5 * abs(ratio)
    if not all(sound) or turned or 1.0 / FACTOR < ratio.real < FACTOR:
        return None
    return float(ratio.real), not better_is_left
