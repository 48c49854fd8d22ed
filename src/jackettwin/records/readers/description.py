"""The JSON beside a record: rate, start, channels, conditions; further keys are metadata."""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import dataclass, field
from datetime import datetime
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ConfigDict, Field

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files import Schema, validate
from jackettwin.records.readers.stamps import parse_time, read_zone
from jackettwin.records.record import Frame

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jackettwin.records.record import Record

NUMBERS = ("mean_wind_speed_m_s", "wind_speed_m_s", "yaw_deg")
"""Conditions that are numbers or not known (null)."""
CHANNEL_METADATA = "channel_metadata"
"""Key of a record's metadata under which further keys of its channels are kept."""


class ChannelEntry(Schema):
    """Description of one channel; omitted values may follow from the data file."""

    model_config = ConfigDict(extra="allow")

    quantity: str | None = None
    unit: str | None = None
    gain: float | None = Field(default=None, allow_inf_nan=False)
    height_m: float | None = None
    node: str | int | None = None
    direction: tuple[float, float, float] | None = None
    frame: Frame | None = None


class _File(Schema):
    model_config = ConfigDict(extra="allow")

    sample_rate_hz: float | None = Field(default=None, gt=0.0, strict=True)
    start_utc: str | None = None
    clock: str | dict[str, Any] | None = None
    channels: dict[str, ChannelEntry] | None = None
    conditions: dict[str, Any] = Field(default_factory=dict)


@dataclass(frozen=True)
class Description:
    """A validated description; ``channels`` is None when the data file alone says what it holds."""

    sample_rate_hz: float | None = None
    start_utc: datetime | None = None
    clock: str | None = None
    channels: Mapping[str, ChannelEntry] | None = None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    metadata: Mapping[str, Any] = field(default_factory=dict)


def read_description(path: Path) -> Description:
    """Read and validate ``NAME.json``.

    Raises
    ------
    InputError
        Names the file, the field and what is allowed.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("cannot be read as text", file=path, remedy="check the file") from error
    return parse_description(text, file=path)


def parse_description(text: str, *, file: Path | str | None = None) -> Description:
    """Validate the text of a description.

    Raises
    ------
    InputError
        If it is not JSON, a known key has a wrong value, or a key is a near miss of a known one.
    """
    if not text.strip():
        raise InputError(
            "is empty, and it is the file that describes the record of this name",
            file=file,
            allowed="a JSON object",
            remedy="restore it; a shell empties NAME.json before a command that ends in > NAME.json begins: "
            "write the answer to another name",
        )
    try:
        data = json.loads(text, parse_constant=_refuse_constant, object_pairs_hook=_refuse_repeats)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"is not JSON: {error}", file=file, allowed="a JSON object", remedy="check commas and quotes"
        ) from error
    if not isinstance(data, dict):
        raise InputError(
            "is not a JSON object", file=file, value=data, allowed="{...}", remedy="start with {"
        )
    try:
        entries = validate(_File, data, file=file)
    except InputError as error:
        error.remedy = error.remedy or "correct the value; docs/reference/records.md shows the format"
        raise
    _refuse_near_misses(entries, "", file)
    _refuse_words(entries.conditions, file)
    for name, entry in (entries.channels or {}).items():
        _refuse_near_misses(entry, f"channels.{name}.", file)
    further = {
        name: entry.model_extra for name, entry in (entries.channels or {}).items() if entry.model_extra
    }
    metadata = dict(entries.model_extra or {})
    if isinstance(entries.clock, dict):  # what an earlier reader measured of the stamps
        metadata["clock"] = entries.clock
    elif entries.clock is not None:
        with located(file=file):
            read_zone(entries.clock)
    return Description(
        sample_rate_hz=entries.sample_rate_hz,
        start_utc=parse_time(entries.start_utc, file=file) if entries.start_utc else None,
        clock=entries.clock if isinstance(entries.clock, str) else None,
        channels=entries.channels,
        conditions=entries.conditions,
        metadata={**metadata, CHANNEL_METADATA: further} if further else metadata,
    )


def describe(record: Record) -> dict[str, Any]:
    """Return the description of a record as plain JSON data; NaN becomes null."""
    metadata = dict(record.metadata)
    further = metadata.pop(CHANNEL_METADATA, {})
    head = {
        "sample_rate_hz": record.sample_rate_hz,
        "start_utc": record.start_utc.isoformat().replace("+00:00", "Z") if record.start_utc else None,
    }
    channels = {
        c.name: {
            **further.get(c.name, {}),
            "quantity": c.quantity,
            "unit": c.unit,
            "height_m": c.height_m,
            "node": c.node,
            "direction": list(c.direction),
            **({} if c.frame == "global" else {"frame": c.frame}),
        }
        for c in record.channels
    }
    body = {"channels": channels, "conditions": dict(record.conditions)}
    plain: dict[str, Any] = _plain({**metadata, **head, **body})
    return plain


def description_text(record: Record) -> str:
    """Return the description of a record as JSON text."""
    return json.dumps(describe(record), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    """Return JSON data: arrays as lists, NaN as None, anything else unknown as text."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, str | int) else str(value)


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a JSON number")


def _refuse_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse a key given twice, of which JSON would silently keep the last."""
    for key, count in Counter(key for key, _ in pairs).items():
        if count > 1:
            raise ValueError(f"key {key!r} is given {count} times")
    return dict(pairs)


def _refuse_words(conditions: Mapping[str, Any], file: Path | str | None) -> None:
    for name in NUMBERS:
        value = conditions.get(name)
        if value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
            continue
        raise InputError(
            "is not a number",
            file=file,
            field=f"conditions.{name}",
            value=value,
            allowed="a number, or null if it is not known",
            remedy="correct or remove it",
        )


def _refuse_near_misses(model: Schema, place: str, file: Path | str | None) -> None:
    """Refuse an unknown key that is almost a known one: a typo must not become silent metadata."""
    known = [name for name in type(model).model_fields if name not in model.model_fields_set]
    for key in model.model_extra or {}:
        if get_close_matches(key.lower(), known, n=1, cutoff=0.8):
            raise InputError(
                "unknown key that looks like a known one",
                file=file,
                field=f"{place}{key}",
                allowed=", ".join(type(model).model_fields),
                remedy=did_you_mean(key.lower(), known),
            )
