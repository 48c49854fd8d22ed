"""Modes over time as the table that ``jackettwin watch`` reads, a row for each mode and time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime, timedelta
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv

from jackettwin.change import Columns, Days, history_of
from jackettwin.change.modal_table import QUANTITIES
from jackettwin.files import atomic_path
from jackettwin.twin import UNDATED, Observation, TwinModel, TwinState
from jackettwin.twin.pair_angles import pair_angles

MODES_IN_TIME = "modes_in_time.csv"
"""Name of the file that commands write."""
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

Row = dict[str, Any]


def rows_of_records(records: Iterable[Observation]) -> list[Row]:
    """Return a row for each named mode of each record with a start time, in order of time."""
    rows = []
    for seen in records:
        if seen.start_utc is None:
            continue
        angles = pair_angles(seen)
        for label, mode in seen.named_modes.items():
            numbers = (
                mode.frequency_hz, mode.frequency_std_hz, mode.damping_ratio, mode.damping_ratio_std,
                *np.degrees(angles.get(label, (np.nan, np.nan))),
            )  # fmt: skip
            rows.append(_row(seen.start_utc, label, numbers, _said(seen.conditions)))
    return sorted(rows, key=lambda row: (row["time_utc"], row["label"]))


def _said(conditions: Mapping[str, Any]) -> Row:
    """Return a record's state of operation and its numeric conditions."""
    numbers = {n: x for n, x in conditions.items() if isinstance(x, (int, float)) and not n.endswith("seed")}
    return {"state": conditions.get("state")} | numbers


def rows_of_days(model: TwinModel, state: TwinState) -> list[Row]:
    """Return a row for each mode, day and state of operation, from the daily sums of a twin's state."""
    dates, days = [date for date in state.days if date != UNDATED], Days.of(state)
    history = history_of(Columns.of(model, days, dates), days, dates)
    rows = []
    for i, day in enumerate(history.days):
        beside = dict(zip(history.condition_names, history.conditions[i], strict=True))
        said = {"state": history.state_names[history.states[i]]} | beside
        for q, label in enumerate(history.labels):
            numbers = [getattr(history, name)[i, q] for name in QUANTITIES.values()]
            numbers[4:] = np.degrees(numbers[4:])
            if isfinite(numbers[0]):
                rows.append(_row(_EPOCH + timedelta(days=float(day)), label, numbers, said))
    return rows


def _row(time: datetime, label: str, numbers: Iterable[float | None], said: Row) -> Row:
    """Return a row with None for unknown values."""
    known = dict(zip(QUANTITIES, numbers, strict=True)) | said
    finite = {n: None if isinstance(x, float) and not isfinite(x) else x for n, x in known.items()}
    return {"time_utc": time.astimezone(UTC).isoformat(), "label": label} | finite


def write_modes_in_time(rows: list[Row], path: Path) -> None:
    """Write a table of modes as CSV with empty cells for unknown values; write no file without rows."""
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: [row.get(name) for row in rows] for name in names}
    told = {name: values for name, values in columns.items() if any(x is not None for x in values)}
    if rows:
        with atomic_path(path) as temporary:
            pacsv.write_csv(pa.table(told), temporary)
