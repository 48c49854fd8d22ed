r"""Subtraction of tones of known phase by least squares: the orders of a rotor of measured speed.

With the azimuth :math:`\theta(t) = \int \Omega\, dt` the tone of order k is
:math:`\mathrm{Re}\, c\, e^{ik\theta}`, with one complex amplitude per channel, whatever the speed.
A mode is driven at random and has no fixed phase relative to the rotor:
over T seconds the fit removes no more of it than a line of width 1/T. If the speed is wrong by more than a
few tenths of a turn over the record, the tone remains and is recognised by its statistics.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.processing.filters import bridge

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jackettwin.records.record import Record


FEWEST_SAMPLES = 30
"""Fewest samples of a channel that is treated: ten times its three unknowns."""


def less_phase(y: FloatArray, phase: FloatArray) -> FloatArray:
    """Return samples without the least-squares combination of cosine and sine of a phase.

    A constant is fitted too, but not subtracted.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks missing samples.
    phase : (n_samples,)
        [rad]

    Examples
    --------
    >>> phase = np.linspace(0.0, 60.0, 200) ** 1.2
    >>> bool(np.allclose(less_phase(np.array([1.0 + np.sin(phase)]), phase), 1.0))
    True
    """
    basis = np.stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
    out = y.copy()
    for row, there in zip(out, np.isfinite(y), strict=True):
        if there.sum() >= FEWEST_SAMPLES:
            seen = basis[:, there]
            row[there] -= np.linalg.solve(seen @ seen.T, seen @ row[there])[:2] @ seen[:2]
    return out


ORDERS = (1, 3, 6)
"""Multiples of the rotor's speed at which three blades excite a tower."""
MIN_TURNS = 20.0
"""Fewest turns in a record; with fewer, the rotor stands or its tones cannot be separated."""
SPEED_KEYS = ("rotor_speed_rpm", "mean_rotor_speed_rpm", "rotor_rpm")
"""Names of the mean speed of the rotor among a record's conditions."""
ROTOR_STATES = ("rotor standing", "rotor turning")
"""States of a record whose rotor speed is measured."""
SPREAD = 0.05
"""Relative range of the speed about a stated mean, within ten minutes of operation."""


@dataclass(frozen=True)
class RotorOrder:
    """A multiple of the rotor's speed.

    Attributes
    ----------
    order : int
        3 for 3P.
    low_hz, high_hz : float
        Range of its frequency, 1st to 99th percentile.
    share : float
        Largest share of a channel's power that was subtracted.
    """

    order: int
    low_hz: float
    high_hz: float
    share: float


def rotor_speed(record: Record) -> FloatArray | None:
    """Return the rotor's speed [rad/s], gaps bridged; None if it is not measured or the rotor stands."""
    rows = [i for i, c in enumerate(record.channels) if c.quantity == "rotor speed"]
    if not rows or not np.isfinite(record.data[rows[0]]).any():
        return None
    speed = np.abs(bridge(record.data[rows[0]]))
    turns = float(np.sum(speed)) / record.sample_rate_hz / (2.0 * np.pi)
    return speed if turns >= MIN_TURNS else None


def stated_orders(conditions: Mapping[str, Any], duration_s: float) -> tuple[RotorOrder, ...]:
    """Return the ranges of the orders by a mean speed in the conditions; none for a rotor at rest."""
    stated = _stated_rpm(conditions)
    turns_a_second = abs(stated[0]) / 60.0 if stated else 0.0
    if turns_a_second * duration_s < MIN_TURNS:
        return ()
    low, high = turns_a_second * (1.0 - SPREAD), turns_a_second * (1.0 + SPREAD)
    return tuple(RotorOrder(k, k * low, k * high, 0.0) for k in ORDERS)


def knows_rotor_speed(conditions: Mapping[str, Any]) -> bool:
    """Return whether conditions state the speed of the rotor, or follow from a channel of it.

    Examples
    --------
    >>> [knows_rotor_speed(c) for c in ({"rotor_rpm": 0}, {"state": ROTOR_STATES[0]}, {"state": "idling"})]
    [True, True, False]
    """
    return bool(_stated_rpm(conditions)) or conditions.get("state") in ROTOR_STATES


def _stated_rpm(conditions: Mapping[str, Any]) -> list[float]:
    return [conditions[key] for key in SPEED_KEYS if isinstance(conditions.get(key), int | float)]


def without_orders(record: Record, speed_rad_s: FloatArray) -> tuple[Record, tuple[RotorOrder, ...]]:
    """Return the record without the tones of the rotor in its vibration channels, and these tones.

    Parameters
    ----------
    speed_rad_s : (n_samples,)
        Without gaps.
    """
    azimuth = np.cumsum(speed_rad_s) / record.sample_rate_hz
    nyquist = 0.5 * record.sample_rate_hz
    data, orders = record.data.copy(), []
    vibrating = [i for i, c in enumerate(record.channels) if c.quantity in VIBRATIONS]
    for k in ORDERS:
        low, high = np.percentile(k * speed_rad_s, [1.0, 99.0]) / (2.0 * np.pi)
        if high >= nyquist:
            continue
        left = less_phase(data[vibrating], k * azimuth)
        share = max(map(_share, data[vibrating], data[vibrating] - left), default=0.0)
        data[vibrating] = left
        orders.append(RotorOrder(k, float(low), float(high), share))
    return replace(record, data=data), tuple(orders)


def _share(y: FloatArray, tone: FloatArray) -> float:
    """Return the share of a channel's power that is the tone's."""
    there = np.isfinite(y)
    power = float(np.var(y[there])) if there.any() else 0.0
    return float(np.var(tone[there])) / power if power > 0.0 else 0.0
