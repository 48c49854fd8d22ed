"""Raw samples as losslessly compressed Parquet files, by asset and day.

64-bit floats are rounded before they are identified and stored (:func:`without_false_digits`): their last
thirty binary digits are noise that no compression shortens.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from jackettwin.arrays import FloatArray
from jackettwin.errors import look_up
from jackettwin.files import atomic_path
from jackettwin.records import Channel, Record

SCHEMA_VERSION = 1
_FINEST = 10**8
"""Largest denominator of a step, as loggers write at most eight decimals."""
_FALSE = 2.0**-14
"""Step of rounded samples by the median change between neighbours: it adds 3e-10 of the noise's power."""
_GROUP = 2**17
"""Samples that are read at once, of a record that is looked at closely."""
_BLOCK, _MOST_BLOCKS = 2**9, 2**14
"""Samples whose extremes are kept: twice as many while there would be more blocks than this."""
_COARSER = 4
"""A bin of so many blocks is drawn from their extremes: its edges are then within a quarter of it."""
_GAINS = (1.0, 9.80665, 9.81, 9.80665e-3, 1e-3, 1e-2, 1e-6)
"""Factors by which readers convert 32-bit floats in g, mg, mm/s², cm/s² or µm."""


def waveform_path(asset: str, start_utc: datetime, record_id: str) -> str:
    """Return the path of a record's samples, relative to the store."""
    return f"records/{asset}/{start_utc:%Y-%m-%d}/{record_id}.parquet"


def write_waveform(record: Record, path: Path) -> int:
    """Write the samples and description of a record; return the size of the file in bytes."""
    arrays, steps, kept = [], [], {}
    block = _BLOCK * 2 ** max(0, ceil(np.log2(max(record.data.shape[1], 1) / (_BLOCK * _MOST_BLOCKS))))
    for i, row in enumerate(record.data):
        packed, step = packed_samples(row)
        arrays.append(pa.array(packed))
        steps.append(step)
        kept[f"extremes of c{i}"] = base64.b64encode(_extremes(row[None], block).tobytes())
    described = {
        "schema_version": SCHEMA_VERSION,
        "name": record.name,
        "sample_rate_hz": record.sample_rate_hz,
        "start_utc": None if record.start_utc is None else record.start_utc.isoformat(),
        "channels": [asdict(channel) for channel in record.channels],
        "conditions": dict(record.conditions),
        "metadata": dict(record.metadata),
        "steps": steps,
        "block": block,
    }
    table = pa.Table.from_arrays(arrays, names=[f"c{i}" for i in range(len(arrays))])
    about = json.dumps(described, default=str).encode()
    table = table.replace_schema_metadata({b"jackettwin": about})
    floating = [f.name for f in table.schema if pa.types.is_floating(f.type)]
    with (
        atomic_path(path) as temporary,
        pq.ParquetWriter(
            temporary,
            table.schema,
            compression="zstd",
            use_dictionary=False,
            use_byte_stream_split=floating,
        ) as file,
    ):
        file.write_table(table, row_group_size=_GROUP)
        file.add_key_value_metadata(kept)
    return path.stat().st_size


def is_waveform(path: Path) -> bool:
    """Return whether a file was written by :func:`write_waveform`."""
    if path.suffix != ".parquet":
        return False
    try:
        return b"jackettwin" in (pq.read_schema(path).metadata or {})
    except (pa.ArrowException, OSError):
        return False


def read_waveform(path: Path, names: Collection[str] | None = None) -> Record:
    """Return the record that :func:`write_waveform` wrote, equal to the last bit; or some of its channels."""
    with pq.ParquetFile(path) as file:
        about: dict[str, Any] = json.loads(file.metadata.metadata[b"jackettwin"])
        wanted = [i for i, c in enumerate(about["channels"]) if names is None or c["name"] in names]
        data = _samples(file, about, wanted, 0, file.metadata.num_rows)
    start = about["start_utc"]
    return Record(
        data,
        about["sample_rate_hz"],
        tuple(
            Channel(**{**c, "direction": tuple(c["direction"])})
            for c in (about["channels"][i] for i in wanted)
        ),
        None if start is None else datetime.fromisoformat(start),
        about["conditions"],
        about["metadata"],
        about["name"],
    )


@dataclass(frozen=True)
class SampleExtremes:
    """Smallest and largest samples of a record's bins of equal length.

    Attributes
    ----------
    start_utc : of the record
    sample_rate_hz : float
    names : of the channels
    time_s : (n_bins,) where each begins, after the record's start
    low, high : (n_channels, n_bins); NaN where a bin has no sample
    """

    start_utc: datetime
    sample_rate_hz: float
    names: tuple[str, ...]
    time_s: FloatArray
    low: FloatArray
    high: FloatArray


def read_extremes(
    path: Path, names: Sequence[str] | None, since_s: float, until_s: float | None, points: int
) -> SampleExtremes:
    """Return the extremes of at most ``points`` bins between two times after a record's start.

    A long stretch is drawn from extremes that were kept with the samples, so that a day opens as quickly as
    a minute; its first bin may begin a quarter of a bin before ``since_s``.

    Raises
    ------
    InputError
        If the record has no channel of a name.
    """
    with pq.ParquetFile(path) as file:
        known = file.metadata.metadata
        about: dict[str, Any] = json.loads(known[b"jackettwin"])
        places = {channel["name"]: i for i, channel in enumerate(about["channels"])}
        wanted = [look_up(places, name, "channel", field="channels") for name in names or places]
        rate, end = about["sample_rate_hz"], file.metadata.num_rows
        first = min(int(since_s * rate), end)
        last = end if until_s is None else min(ceil(until_s * rate), end)
        size, block = max(ceil((last - first) / points), 1), about.get("block")
        if block is not None and size >= _COARSER * block:
            stored = (np.frombuffer(base64.b64decode(known[b"extremes of c%d" % i])) for i in wanted)
            size, first = ceil(size / block), first // block
            blocks = np.array([row.reshape(2, -1) for row in stored])[..., first : ceil(last / block)]
            edges = np.arange(0, blocks.shape[-1], size)
            low, high = (np.fmin.reduceat(blocks[:, 0], edges, 1), np.fmax.reduceat(blocks[:, 1], edges, 1))
            at = block * (first + edges)
        else:
            low, high = _extremes(_samples(file, about, wanted, first, last), size)
            at = first + size * np.arange(low.shape[1])
    start = datetime.fromisoformat(about["start_utc"])
    return SampleExtremes(start, rate, tuple(names or places), at / rate, low, high)


def _extremes(data: FloatArray, size: int) -> FloatArray:
    """Return the smallest and the largest of each ``size`` samples, (2, n_channels, n_bins)."""
    edges = np.arange(0, data.shape[1], size)
    if not edges.size:
        return np.empty((2, data.shape[0], 0))
    return np.array([ufunc.reduceat(data, edges, axis=1) for ufunc in (np.fmin, np.fmax)])


def _samples(
    file: pq.ParquetFile, about: dict[str, Any], wanted: Sequence[int], first: int, last: int
) -> FloatArray:
    """Return samples from one to before another of some channels, (n_channels, last − first)."""
    ends = np.cumsum([file.metadata.row_group(k).num_rows for k in range(file.metadata.num_row_groups)])
    begins = np.append(0, ends)[:-1]
    groups = np.flatnonzero((begins < last) & (ends > first)).tolist()
    table = file.read_row_groups(groups, columns=[f"c{i}" for i in wanted])
    if groups:
        table = table.slice(first - int(begins[groups[0]]), last - first)
    data = np.empty((len(wanted), table.num_rows))
    for row, i in zip(data, wanted, strict=True):
        row[:] = _unpacked(table[f"c{i}"].to_numpy(), about["steps"][i])
    return data


def without_false_digits(record: Record) -> Record:
    """Return a record whose 64-bit samples are multiples of a step far below the channel's noise.

    The step is the power of two at or below 2⁻¹⁴ of the median change from sample to sample, which is 0.95
    standard deviations of white noise. Channels that have a step already, or are 32-bit floats, and those
    that mostly stand still are not changed; rounding twice changes nothing.
    """
    return replace(record, data=np.array([_rounded(row) for row in record.data]))


def _rounded(x: FloatArray) -> FloatArray:
    changes = np.abs(np.diff(x[np.isfinite(x)]))
    if packed_samples(x)[1] is not None or not changes.size or not 0.0 < np.median(changes) < np.inf:
        return x
    step = 2.0 ** np.floor(np.log2(_FALSE * np.median(changes)))
    if np.isinf(x).any() or np.nanmax(np.abs(x)) >= step * np.iinfo(np.int32).max:
        return x
    return np.asarray(np.round(x / step) * step)


def packed_samples(x: FloatArray) -> tuple[npt.NDArray[Any], list[float] | None]:
    """Return samples as int16, int32 or float32 with their step, or unchanged with None.

    The step is stored as (numerator, denominator): a logger's 0.0012 is 12/10000 to the last bit, but not
    12 · 0.0001.
    """
    counted = _counts(x)
    if counted is not None:
        return counted
    for gain in _GAINS:
        with np.errstate(over="ignore"):  # an overflow gives infinity, which is not equal
            single = (x / gain).astype(np.float32)
        if np.array_equal(_unpacked(single, [gain, 1.0]), x, equal_nan=True):
            return single, [gain, 1.0]
    return x, None


def _counts(x: FloatArray) -> tuple[npt.NDArray[Any], list[float]] | None:
    """Return samples as multiples of a step if possible, of 32 bits if their range needs it."""
    known = np.unique(x[np.isfinite(x)])
    if known.size < 2:
        return None
    step = float(np.diff(known).min())
    decimal = Fraction(step).limit_denominator(_FINEST)
    fractions = ((step, 1.0), (float(decimal.numerator), float(decimal.denominator)))
    for numerator, denominator in (*fractions, (_binary_step(known), 1.0)):
        if numerator <= 0.0:
            continue
        with np.errstate(over="ignore"):
            counts = np.round(x * (denominator / numerator))
        largest = np.nanmax(np.abs(counts))
        kind = next((k for k in (np.int16, np.int32) if largest <= np.iinfo(k).max), None)
        if kind is None:
            continue
        packed = np.where(np.isfinite(counts), counts, np.iinfo(kind).min).astype(kind)
        if np.array_equal(_unpacked(packed, [numerator, denominator]), x, equal_nan=True):
            return packed, [numerator, denominator]
    return None


def _binary_step(x: FloatArray) -> float:
    """Return the largest power of two of which all numbers are multiples."""
    mantissas, exponents = np.frexp(x[x != 0.0])
    digits = (mantissas * 2.0**53).astype(np.int64)
    _, lowest = np.frexp((digits & -digits).astype(float))
    return float(2.0 ** (exponents + lowest - 54.0).min())


def _unpacked(stored: npt.NDArray[Any], step: list[float] | None) -> FloatArray:
    """Return samples; the least integer means a missing one."""
    samples = np.asarray(stored, dtype=float)
    if step is None:
        return samples
    if np.issubdtype(stored.dtype, np.integer):
        samples = np.where(stored == np.iinfo(stored.dtype).min, np.nan, samples)
    numerator, denominator = step
    return np.asarray(samples * numerator / denominator)
