"""Data for plots of records: extremes of bins, and spectra."""

from __future__ import annotations

import io
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from jackettwin.errors import InputError
from jackettwin.service.web.dependencies import known_record
from jackettwin.service.web.problems import ApiError
from jackettwin.service.web.schemas.records import RecordOut, Signal, Spectra, SpectrogramOut
from jackettwin.store import reading
from jackettwin.store.records import StoredRecord

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.records import Record
    from jackettwin.service.context import Service
    from jackettwin.service.web.auth import Who

_SEGMENT_S = 60.0
"""Length of a segment of the spectra: a resolution of 1/60 Hz suffices for a mode at 0.2 Hz."""


_SINGULAR, _COLUMNS = 3, 300
"""Largest number of singular values, and of segments of a spectrogram."""


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


def samples(service: Service, record_id: str, who: Who, names: list[str] | None = None) -> Record:
    """Return the samples of a record, or of some of its channels; answers 404 if they were deleted."""
    from jackettwin.store import read_waveform

    record, path = _kept(service, record_id, who)
    known = {channel["name"] for channel in record.channels}
    return read_waveform(path, names if known.issuperset(names or ()) else None)


def _kept(service: Service, record_id: str, who: Who) -> tuple[StoredRecord, Path]:
    """Return a record and the file of its samples; answers 404 if they were deleted."""
    with reading(service.database) as connection:
        record = known_record(connection, record_id, who)
    path = None if record.waveform is None else service.settings.store / record.waveform
    if path is None or not path.exists():
        raise ApiError(404, "the samples of this record were deleted", field="record_id")
    return record, path


def extremes(
    service: Service,
    record_id: str,
    who: Who,
    names: list[str] | None,
    since: float,
    until: float | None,
    points: int,
) -> Signal:
    """Return minimum and maximum of each of ``points`` bins between two times [s after the start]."""
    from jackettwin.store import read_extremes

    _, path = _kept(service, record_id, who)
    found = read_extremes(path, names, since, until, points)
    return Signal(
        sample_rate_hz=found.sample_rate_hz,
        start_utc=found.start_utc,
        time_s=found.time_s.tolist(),
        channels={
            name: {"min": _listed(low), "max": _listed(high)}
            for name, low, high in zip(found.names, found.low, found.high, strict=True)
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
    import numpy as np

    from jackettwin.records import spectral_matrix, welch_densities

    n = min(int(_SEGMENT_S * record.sample_rate_hz), record.data.shape[1])
    frequency, density = welch_densities(record.data, record.sample_rate_hz, n, less_mean=True)
    alike = record.data[[c.unit == record.channels[0].unit for c in record.channels]]
    alike = alike[np.isfinite(alike).any(axis=1)]
    _, matrix = spectral_matrix(alike - np.nanmean(alike, axis=1, keepdims=True), record.sample_rate_hz, n)
    # of a positive Hermitian matrix the eigenvalues are the singular values
    singular = np.abs(np.linalg.eigvalsh(matrix))[:, ::-1].T[:_SINGULAR]
    return Spectra(
        frequency_hz=frequency.tolist(),
        channels={c.name: row.tolist() for c, row in zip(record.channels, density, strict=True)},
        units={c.name: f"({c.unit})^2/Hz" for c in record.channels},
        singular_values=singular.tolist(),
    )


def spectrogram(record: Record, name: str | None, up_to_hz: float, segment_s: float) -> SpectrogramOut:
    """Return the densities of a channel in segments that overlap by three quarters."""
    import numpy as np

    from jackettwin.records import welch_densities

    chosen = record.select([name or record.channels[0].name])
    n = min(max(int(segment_s * record.sample_rate_hz), 16), chosen.data.shape[1])
    total = chosen.data.shape[1] - n
    starts = range(0, total + 1, max(n // 4, total // _COLUMNS, 1))
    pieces = [
        welch_densities(chosen.data[:, a : a + n], record.sample_rate_hz, n, less_mean=True) for a in starts
    ]
    f = pieces[0][0]
    shown = (f > 0.0) & (f <= up_to_hz)
    level = 10.0 * np.log10(np.where((d := np.array([d[0] for _, d in pieces])) > 0.0, d, np.nan))[:, shown]
    return SpectrogramOut(
        channel=chosen.channels[0].name,
        unit=f"({chosen.channels[0].unit})^2/Hz",
        segment_s=n / record.sample_rate_hz,
        time_s=[a / record.sample_rate_hz for a in starts],
        frequency_hz=f[shown].tolist(),
        level_db=[_listed(np.round(row, 1)) for row in level],
    )


def _listed(values: FloatArray) -> list[float | None]:
    return [float(v) if isfinite(v) else None for v in values]
