r"""Detection of channels in another unit than stated: g for m/s², mg for g.

Three ratios that should be one are examined:

* two parallel sensors at one place: the ratio of their amplitudes where they vibrate most;
* parallel sensors on a tower, three heights at least: the amplitude of one over that between its neighbours,
  in the strongest narrow band of displacement. The first bending mode grows with height about as a power of
  it, :math:`u ∝ (h-h_0)^p`;
* a vertical sensor that shows gravity: its mean over 9.81 m/s².

Only ratios near those of units count.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.records.quality.sensor_polarity import CERTAIN, ParallelChannels, SharedMotion, one_motion

if TYPE_CHECKING:
    from jackettwin.records.record import Record


TOO_LARGE = (
    ("m/s^2", "g", GRAVITY_M_S2),
    ("mg", "g", 1e3),
    ("mg or cm/s^2", "m/s^2", 1e3 / GRAVITY_M_S2),
    ("mm/s^2", "g", 1e3 * GRAVITY_M_S2),
)
"""Unit of the numbers, stated unit, and the factor by which that makes them too large."""
WORDS = {
    **{factor: f"{own} taken for {taken}" for own, taken, factor in TOO_LARGE},
    **{1.0 / factor: f"{taken} taken for {own}" for own, taken, factor in TOO_LARGE},
}
FACTORS = tuple(WORDS)
"""Ratios of units of acceleration that are confused."""
GRAVITY_FACTORS = (1.0 / GRAVITY_M_S2, GRAVITY_M_S2, 1e3, 1e3 / GRAVITY_M_S2)
"""Ratios considered for a mean of gravity; smaller ones would be an ordinary offset."""
GRAVITY_TOLERANCE = 0.03
"""Relative tolerance of gravity, for offset and tilt of a sensor."""
ONE_PLACE_TOLERANCE = 0.2
"""Tolerance of ln(ratio) of two sensors at one place."""
MAX_LOG_DEVIATION = 0.9
"""Largest |ln| of the ratio of an amplitude to the one interpolated from its neighbours;
random cantilevers stay below 0.8."""
TOWER_TOLERANCE = 0.6
"""Tolerance of ln(ratio) on a tower."""
BELOW = 0.5
"""Depth of the foot of a tower below the lowest sensor, as a share of the sensors' span."""


@dataclass(frozen=True)
class WrongUnit:
    """A channel that is too large by a factor; one of ``others`` may be wrong instead."""

    channel: str
    factor: float
    others: tuple[str, ...] = ()

    @property
    def words(self) -> dict[str, str]:
        """Which channel, how much too large, and the units that are mixed up."""
        which = f"it or {' or '.join(self.others)}" if self.others else "it"
        size = (
            f"{self.factor:.3g} times too large"
            if self.factor > 1.0
            else f"{1 / self.factor:.3g} times too small"
        )
        return {"which": which, "size": size, "units": WORDS[self.factor]}


def wrong_units(record: Record, groups: Sequence[ParallelChannels]) -> dict[str, WrongUnit]:
    """Return, by name, accelerations whose unit conflicts with that of others.

    Parameters
    ----------
    record : Record
    groups : of ``sensor_polarity.parallel_groups``
    """
    found = {w.channel: w for group in groups for w in _in_group(record, group)}
    return found | {w.channel: w for w in _by_gravity(record)}


def _in_group(record: Record, group: ParallelChannels) -> Iterator[WrongUnit]:
    names = [record.channels[i].name for i in group.seen.rows]
    if np.min(np.abs(group.seen.coherency)) < CERTAIN or np.min(group.seen.size) <= 0.0:
        return
    if group.heights is None and one_motion(group.seen):
        yield from _at_one_place(group.seen, names)
    elif group.heights is not None and len(set(group.heights)) > 2:
        yield from _on_a_tower(group.seen, np.array(group.heights), names)


def _at_one_place(seen: SharedMotion, names: list[str]) -> Iterator[WrongUnit]:
    """Yield channels a unit's ratio off the median of three or more sensors, or off the other of two."""
    usual = np.median(seen.size) if len(names) > 2 else np.min(seen.size)
    for name, size in zip(names, seen.size, strict=True):
        factor = _nearest(float(np.log(size / usual)), ONE_PLACE_TOLERANCE)
        if factor is not None:
            yield WrongUnit(name, factor, () if len(names) > 2 else tuple(n for n in names if n != name))


def _on_a_tower(seen: SharedMotion, heights_m: FloatArray, names: list[str]) -> Iterator[WrongUnit]:
    """Yield the channel whose correction by a unit's ratio makes the amplitudes grow smoothly with height."""
    size = np.log(seen.size)
    if np.max(np.abs(_bend(heights_m, size))) < MAX_LOG_DEVIATION:
        return
    cures = []
    for i in range(len(names)):
        for factor in FACTORS:
            cured = size.copy()
            cured[i] -= np.log(factor)
            left = float(np.max(np.abs(_bend(heights_m, cured))))
            # a power law may fall with height as well, which no tower's first bending mode does
            if left < TOWER_TOLERANCE and _grows(heights_m, cured):
                cures.append((left, i, factor))
    if cures:
        _, best, factor = min(cures)
        yield WrongUnit(
            names[best], factor, tuple(names[i] for i in sorted({i for _, i, _ in cures} - {best}))
        )


def _bend(heights_m: FloatArray, size: FloatArray) -> FloatArray:
    """Return ln of the ratio of each amplitude to a power law through the two nearest other heights."""
    x = np.log(heights_m - heights_m.min() + BELOW * np.ptp(heights_m))
    out = np.zeros(len(size))
    for i in range(len(size)):
        others = np.flatnonzero(x != x[i])
        below, above = others[x[others] < x[i]], others[x[others] > x[i]]
        if len(below) and len(above):
            a, b = below[np.argmax(x[below])], above[np.argmin(x[above])]
        else:
            a = others[np.argmin(np.abs(x[others] - x[i]))]
            further = others[x[others] != x[a]]
            b = further[np.argmin(np.abs(x[further] - x[i]))]
        out[i] = size[i] - size[a] - (size[b] - size[a]) * (x[i] - x[a]) / (x[b] - x[a])
    return out


def _grows(heights_m: FloatArray, size: FloatArray) -> bool:
    """Tell whether ln of the amplitudes hardly falls from one height to the next."""
    return bool(np.all(np.diff(size[np.argsort(heights_m, kind="stable")]) > -TOWER_TOLERANCE))


def _by_gravity(record: Record) -> Iterator[WrongUnit]:
    """Yield vertical channels whose mean is gravity in another unit."""
    for channel, row in zip(record.channels, record.data, strict=True):
        if channel.quantity != "acceleration" or abs(channel.direction[2]) < 1.0 - GRAVITY_TOLERANCE:
            continue
        finite = row[np.isfinite(row)]
        mean = abs(float(np.median(finite))) if finite.size else 0.0
        for factor in GRAVITY_FACTORS:
            if abs(mean / (factor * GRAVITY_M_S2) - 1.0) < GRAVITY_TOLERANCE:
                yield WrongUnit(channel.name, factor)


def _nearest(log_ratio: float, tolerance: float) -> float | None:
    """Return the ratio of units nearest to a ratio, None if none is near."""
    best = min(FACTORS, key=lambda factor: abs(log_ratio - np.log(factor)))
    return best if abs(log_ratio - np.log(best)) < tolerance else None
