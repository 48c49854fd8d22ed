"""A measured or simulated record and its identity."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, look_up
from jackettwin.files import DIGITS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


Frame = Literal["global", "nacelle"]

LARGEST = 1e15
"""Largest credible reading in SI units; larger ones are corrupt and would overflow when squared."""
SMALLEST = 1e-30
"""Smallest variation that counts, in SI units; no sensor resolves less."""
RATES_HZ = (1e-9, 1e9)
"""Range of sample rates."""


@dataclass(frozen=True)
class Channel:
    """One measured signal: its quantity, place and direction.

    ``height_m`` is above mean sea level on the tower axis; ``node`` names a node of the structure
    instead. ``direction`` is a unit vector in global axes (in the rotor's after ``to_rotor_axes``);
    zeros for a scalar quantity. ``frame`` is ``"nacelle"`` for a sensor that turns with the yaw: its
    direction is in the rotor's axes from the start.
    """

    name: str
    quantity: str = "acceleration"
    unit: str = "m/s^2"
    height_m: float | None = None
    node: str | None = None
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    frame: Frame = "global"


_SHOWN = 6
"""Number of channels named by a record's ``repr``."""


@dataclass(frozen=True, repr=False)
class Record:
    """Samples of several channels with a common rate and start.

    Attributes
    ----------
    data : (n_channels, n_samples) float array
        Samples in SI units of each channel's quantity; NaN marks a missing sample.
    sample_rate_hz : float
    channels : tuple of Channel
        In the order of the rows of ``data``.
    start_utc : datetime or None
        Start of the interval, time zone aware.
    conditions, metadata : mapping
        Wind, yaw and operating state; everything else in the file.
    name : str
        Identifies the record in messages and results.
    """

    data: FloatArray
    sample_rate_hz: float
    channels: tuple[Channel, ...]
    start_utc: datetime | None = None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    metadata: Mapping[str, Any] = field(default_factory=dict)
    name: str = "record"

    def __repr__(self) -> str:
        start = "" if self.start_utc is None else f" from {self.start_utc:%Y-%m-%dT%H:%M:%SZ}"
        named = ", ".join(self.channel_names[:_SHOWN]) + (" …" if len(self.channels) > _SHOWN else "")
        return (
            f"Record({self.name!r}, {self.duration_s:.6g} s at {self.sample_rate_hz:g} Hz{start}, "
            f"{len(self.channels)} channels: {named})"
        )

    def __post_init__(self) -> None:
        if self.data.ndim != 2 or self.data.shape[0] != len(self.channels):
            raise InputError(
                "data and channels disagree",
                field="data",
                value=self.data.shape,
                allowed=f"({len(self.channels)}, n_samples)",
                remedy="give one row a channel",
            )
        if not RATES_HZ[0] <= self.sample_rate_hz <= RATES_HZ[1]:
            raise InputError(
                "sample rate must be a positive number",
                field="sample_rate_hz",
                value=self.sample_rate_hz,
                allowed=f"{RATES_HZ[0]:g} to {RATES_HZ[1]:g}",
                remedy="state the logger's rate in Hz",
            )

    @property
    def duration_s(self) -> float:
        """Length of the record [s]."""
        return float(self.data.shape[1] / self.sample_rate_hz)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Channel names in the order of the rows of ``data``."""
        return tuple(channel.name for channel in self.channels)

    def select(self, names: Sequence[str]) -> Record:
        """Return the record with only the named channels, in the order given; all of them share the samples.

        Raises
        ------
        InputError
            If a name is not in the record.
        """
        places = {name: i for i, name in enumerate(self.channel_names)}
        rows = [look_up(places, name, "channel", field="channels") for name in names]
        if rows == list(range(len(self.channels))):
            return self
        return replace(self, data=self.data[rows], channels=tuple(self.channels[i] for i in rows))

    def of_quantity(self, quantity: str) -> Record:
        """Return the record with only the channels of one quantity."""
        return self.select([c.name for c in self.channels if c.quantity == quantity])


def record_id(record: Record) -> str:
    """Return the identity of a record: a hash of its samples, rate, start and channels.

    Name, conditions and metadata are excluded, so that a renamed or re-described file is the same record.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from jackettwin.records import Channel, Record
    >>> record = Record(np.zeros((1, 3)), 10.0, (Channel("a"),), name="monday")
    >>> record_id(record) == record_id(replace(record, name="tuesday"))
    True
    >>> record_id(record) == record_id(replace(record, data=record.data + 1.0))
    False
    """
    start = None if record.start_utc is None else record.start_utc.astimezone(UTC).isoformat()
    channels = [
        [c.name, c.quantity, c.unit, c.height_m, c.node, list(map(float, c.direction)), c.frame]
        for c in record.channels
    ]
    head = [float(record.sample_rate_hz), start, list(record.data.shape), channels]
    hashed = hashlib.sha256(json.dumps(head, ensure_ascii=False).encode())
    for row in record.data:  # one at a time: copies of a day's channels take memory
        samples = np.ascontiguousarray(row, dtype="<f8")
        # readers may produce several kinds of NaN and zero, which must hash alike
        hashed.update((np.where(np.isnan(samples), np.nan, samples) + 0.0).tobytes())
    return hashed.hexdigest()[:DIGITS]


def record_content(record: Record) -> tuple[str, str, str]:
    """Return the identity of a record's samples, its name, and all its other content."""
    said = json.dumps([dict(record.conditions), dict(record.metadata)], sort_keys=True, default=str)
    return record_id(record), record.name, said
