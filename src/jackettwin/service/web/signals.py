"""Data for plots of records: extremes of bins, and spectra."""

from __future__ import annotations

import io
from datetime import UTC, datetime
from math import ceil, isfinite
from typing import TYPE_CHECKING

from jackettwin.errors import InputError
from jackettwin.service.web.dependencies import known_record
from jackettwin.service.web.problems import ApiError
from jackettwin.service.web.schemas.records import RecordOut, Signal, Spectra
from jackettwin.store import reading
from jackettwin.store.records import StoredRecord

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.records import Record
    from jackettwin.service.context import Service
    from jackettwin.service.web.auth import Who

_SEGMENT_S = 60.0
"""Length of a segment of the spectra: a resolution of 1/60 Hz suffices for a mode at 0.2 Hz."""


def with_zone(time: datetime | None, field: str) -> datetime | None:
    """Return a time after checking that it has a zone; UTC is not assumed.

    Raises
    ------
    InputError
        If it has no zone, or is out of range.
    """
    if time is not None and time.tzinfo is None:
        raise InputError(
            "the time has no zone", field=field, value=time.isoformat(), remedy="write 2025-01-31T12:00:00Z"
        )
    if time is not None and not 1900 <= time.year <= 9000:
        raise InputError(
            "the time is out of range", field=field, value=time.isoformat(), allowed="1900 to 9000"
        )
    return None if time is None else time.astimezone(UTC)


def record_out(record: StoredRecord) -> RecordOut:
    """Return a record in the form of the API."""
    known = {name: getattr(record, name) for name in RecordOut.model_fields if hasattr(record, name)}
    return RecordOut(**known, raw_kept=record.waveform is not None)


def samples(service: Service, record_id: str, who: Who) -> Record:
    """Return the samples of a record; answers 404 if they were deleted."""
    from jackettwin.store import read_waveform

    with reading(service.database) as connection:
        record = known_record(connection, record_id, who)
    path = None if record.waveform is None else service.settings.store / record.waveform
    if path is None or not path.exists():
        raise ApiError(404, "the samples of this record were deleted", field="record_id")
    return read_waveform(path)


def extremes(
    record: Record, names: list[str] | None, since: float, until: float | None, points: int
) -> Signal:
    """Return minimum and maximum of each of ``points`` bins between two times [s after the start]."""
    import numpy as np

    chosen = record if names is None else record.select(names)
    first = min(int(since * record.sample_rate_hz), chosen.data.shape[1])
    data = chosen.data[:, first : None if until is None else ceil(until * record.sample_rate_hz)]
    size = max(ceil(data.shape[1] / points), 1)
    edges = np.arange(0, data.shape[1], size)
    if edges.size:
        low, high = np.fmin.reduceat(data, edges, axis=1), np.fmax.reduceat(data, edges, axis=1)
    else:
        low = high = np.empty((data.shape[0], 0))
    assert record.start_utc is not None
    return Signal(
        sample_rate_hz=record.sample_rate_hz,
        start_utc=record.start_utc,
        time_s=((first + edges) / record.sample_rate_hz).tolist(),
        channels={
            channel.name: {"min": _listed(a), "max": _listed(b)}
            for channel, a, b in zip(chosen.channels, low, high, strict=True)
        },
    )


def as_arrow(signal: Signal) -> bytes:
    """Return extremes as an Arrow stream: ``time_s`` and for each channel ``NAME.min`` and ``NAME.max``."""
    import pyarrow as pa

    columns: dict[str, list[float | None]] = {"time_s": list(signal.time_s)}
    for name, bins in signal.channels.items():
        columns |= {f"{name}.min": bins["min"], f"{name}.max": bins["max"]}
    table = pa.table(columns)
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    return sink.getvalue()


def spectra(record: Record) -> Spectra:
    """Return the power spectral densities of a record by Welch's method, which allows for missing samples."""
    from jackettwin.records import welch_densities

    n = min(int(_SEGMENT_S * record.sample_rate_hz), record.data.shape[1])
    frequency, density = welch_densities(record.data, record.sample_rate_hz, n, less_mean=True)
    return Spectra(
        frequency_hz=frequency.tolist(),
        channels={c.name: row.tolist() for c, row in zip(record.channels, density, strict=True)},
        units={c.name: f"({c.unit})^2/Hz" for c in record.channels},
    )


def _listed(values: FloatArray) -> list[float | None]:
    return [float(v) if isfinite(v) else None for v in values]
