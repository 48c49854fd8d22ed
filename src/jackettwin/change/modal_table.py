"""Reading of tables of modes through time, with one row per mode and time or one column per mode."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.change.table_times import Stamps, table_times
from jackettwin.errors import InputError, did_you_mean, located, require
from jackettwin.headings import SPREAD, heading_key, heading_scale, heading_width, is_bare_spread, with_owners
from jackettwin.records import text_table
from jackettwin.response import read_mode_label
from jackettwin.watching import History, typical

Columns = dict[str, npt.NDArray[Any]]

_STATES = ("state", "operating_state", "operation")
_MISSING = ["", "nan", "NaN", "NAN", "NA", "N/A", "n/a", "null", "NULL", "none", "None", "-", "--", "#N/A"]
_SUFFIXES = ("", "_std", "_damping", "_damping_std", "_angle_deg", "_angle_std_deg")
QUANTITIES = {
    "frequency_hz": "frequency", "frequency_std_hz": "frequency_std",
    "damping_ratio": "damping", "damping_ratio_std": "damping_std",
    "pair_angle_deg": "angle", "pair_angle_std_deg": "angle_std",
}  # fmt: skip
"""Columns of a table with one row per mode, and their names in a history."""
_MODAL = re.compile(
    r"^f_?\d|freq|zeta|d[aä]e?mp|^mode|mac|_std$|interval|phase|complex|seed|^id$|_id$|^index$|^unnamed|^row|order|_hz$",
    re.I,
)
"""Names of columns that depend on modes or describe the table;
as conditions they would explain damage away."""
_LARGEST_USUAL = 0.25
"""Largest median of damping ratios: modes with more are not identified, and per cent are seldom less."""
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class ModalTable:
    """Modes through time and when they were seen.

    Attributes
    ----------
    history : with days since ``origin``
    origin : midnight (UTC) of the first day
    remarks : what was left out or assumed
    """

    name: str
    history: History
    origin: datetime
    remarks: tuple[str, ...]

    def time(self, day: float) -> datetime:
        """Return the time of a day of the history."""
        return self.origin + timedelta(days=day)


def read_modal_table(
    path: Path,
    *,
    columns: Sequence[str] = (),
    conditions: Sequence[str] | None = None,
    zone: tzinfo | None = None,
) -> ModalTable:
    """Read a CSV or Parquet table of modes.

    Parameters
    ----------
    columns : names of frequency columns, if the table has one column a mode; beside ``NAME`` may stand
        ``NAME_std``, ``NAME_damping`` and ``NAME_damping_std``
    conditions : names of the columns that are conditions; None for all other numbers
    zone : of the clock, if the times do not say it; None for UTC

    Raises
    ------
    InputError
        If the file is no table of modes: names the column and what is allowed.
    """
    with located(file=path):
        stored = _read(path)
        if not columns:
            stored = _with_known_names(stored)
        stored, time_names, stamps, said = _in_order(stored, zone)
        days, origin = _days(stamps)
        wanted, left = _conditions(stored, time_names, columns, conditions)
        if left:
            said = (
                *said,
                f"not taken as conditions: {', '.join(name or 'a column without name' for name in left)}",
            )
        if columns:
            history, remarks = _wide(stored, days, tuple(columns), wanted)
        else:
            history, remarks = _long(stored, days, wanted)
    return ModalTable(path.stem, history, origin, (*said, *remarks))


def _read(path: Path) -> Columns:
    if not path.exists():
        raise InputError("no such file", remedy="check the path")
    try:
        if path.suffix.lower() in (".parquet", ".pq"):
            table = pq.read_table(path)
        else:
            table = _read_text(path.read_bytes())
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError, UnicodeDecodeError) as error:
        raise InputError(
            f"is not a table: {str(error).splitlines()[0]}",
            allowed="CSV or Parquet with a header",
            remedy="export it again",
        ) from None
    if len(set(table.column_names)) < len(table.column_names):
        twice = sorted({n for n in table.column_names if table.column_names.count(n) > 1})
        raise InputError("a name is given twice", field="columns", value=", ".join(twice))
    if table.num_rows == 0:
        raise InputError("holds no rows", allowed="a row a time", remedy="export it again")
    return {name.strip(): _values(table.column(name)) for name in table.column_names}


def _read_text(raw: bytes) -> pa.Table:
    require(
        not raw.startswith(b"PK\x03\x04"), "is a workbook or an archive",
        allowed="CSV or Parquet with a header", remedy="save the sheet as CSV",
    )  # fmt: skip
    rows = _below_titles(text_table(raw).rows)
    require(rows, "holds no rows", allowed="a header and rows", remedy="export it again")
    names, body = rows[0], rows[1:]
    for number, row in enumerate(body, start=2):
        if len(row) != len(names):
            raise InputError(
                f"is not a table: row {number} has {len(row)} cells, the header {len(names)}",
                allowed="CSV or Parquet with a header",
                remedy="export it again",
            )
    columns = zip(*body, strict=True) if body else [()] * len(names)
    return pa.Table.from_arrays([pa.array(cells, pa.string()) for cells in columns], names)


def _below_titles(rows: list[list[str]]) -> list[list[str]]:
    """Return the rows from the header on: lines above it have one cell, or it alone is filled."""
    widest = max(map(len, rows), default=0)
    single = (sum(bool(cell) for cell in row) < 2 for row in rows)
    top = next((i for i, alone in enumerate(single) if not alone), 0)
    return rows[top:] if widest > 1 else rows


def _values(column: Any) -> npt.NDArray[Any]:
    """Return numbers, times (datetime64) or words."""
    if pa.types.is_timestamp(column.type) and column.type.tz is not None:
        column = column.cast(pa.timestamp("ms", "UTC")).cast(pa.timestamp("ms"))
        return np.char.add(np.datetime_as_string(column.to_numpy().astype("datetime64[ms]")), "Z")
    if pa.types.is_timestamp(column.type) or pa.types.is_date(column.type):
        return np.asarray(column.cast(pa.timestamp("ms")).to_numpy()).astype("datetime64[ms]")
    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        return np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)
    if pa.types.is_dictionary(column.type):
        column = column.cast(pa.string())
    words = np.array([("" if w is None else str(w)).strip() for w in column.to_pylist()], dtype=np.str_)
    numbers = np.where(np.isin(words, _MISSING), "nan", words)
    for text in (numbers, np.char.replace(numbers, ",", ".")):
        try:
            return text.astype(np.float64)
        except ValueError:
            continue
    return words


def _with_known_names(stored: Columns) -> Columns:
    """Return a table of one row a mode with the names and units that it is read by.

    A heading that may be that of several columns is left as it is.

    Raises
    ------
    InputError
        If no heading is that of the modes' labels, or of their frequencies.
    """
    headings = list(stored)
    known = {"label", *QUANTITIES}.intersection(headings)
    if {"label", "frequency_hz"} <= known:
        return stored
    found: dict[str, list[tuple[str, str]]] = {}
    for before, heading, owned in zip(["", *headings], headings, with_owners(headings), strict=False):
        key = heading_key(owned)
        follows = heading_key(before) in ("frequency_hz", "damping_ratio") and SPREAD.match(heading)
        if is_bare_spread(heading) and not follows:
            continue  # the spread of something else
        if key is not None and heading not in known:
            found.setdefault("label" if key == "mode" else key, []).append((heading, owned))
    told = {key: ones[0] for key, ones in found.items() if len(ones) == 1 and key not in known}
    for name in ("label", "frequency_hz"):
        if name not in known and name not in told:
            raise InputError(
                "no such column", field=name, value=", ".join(stored),
                allowed="label and frequency_hz in a table of one row a mode and time",
                remedy="for one column a mode, name them: --columns f1,f2",
            )  # fmt: skip
    names = {heading: key for key, (heading, _) in told.items()}
    out = {names.get(heading, heading): x for heading, x in stored.items()}
    for key, (_, owned) in told.items():
        if key != "label" and out[key].dtype.kind == "f":
            width = heading_width(owned) if key.endswith(("_std", "_std_hz")) else 1.0
            out[key] = out[key] * heading_scale(key, owned) / width
    if "label" in told and out["label"].dtype.kind == "U":
        out["label"] = np.array([_model_label(word) for word in out["label"]], dtype=np.str_)
    return out


def _model_label(word: str) -> str:
    """Return a mode's label as a structure's modes have it: of ``1st FA`` ``fore_aft_1``, else the word."""
    try:
        return read_mode_label(word)
    except InputError:
        return word


def _in_order(
    stored: Columns, zone: tzinfo | None
) -> tuple[Columns, tuple[str, ...], Stamps, tuple[str, ...]]:
    """Return a table with its oldest row first, and what :func:`table_times` tells of it."""
    try:
        return stored, *table_times(stored, zone)
    except InputError as error:
        newest_last = {name: x[::-1] for name, x in stored.items()}
        try:
            return newest_last, *table_times(newest_last, zone)
        except InputError:
            raise error from None


def _days(stamps: Stamps) -> tuple[FloatArray, datetime]:
    """Return days since the first midnight, and that midnight."""
    midnight = stamps[0].astype("datetime64[D]")
    days = (stamps - midnight) / np.timedelta64(1, "ms") / 86400e3
    return np.asarray(days, dtype=np.float64), _EPOCH + timedelta(days=int(midnight.astype(np.int64)))


def _conditions(
    stored: Columns, time_names: tuple[str, ...], columns: Sequence[str], given: Sequence[str] | None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns that are conditions, and of those that are not taken for such."""
    for name in (*columns, *(given or ())):
        if name not in stored:
            raise InputError(
                "no such column", field=name, allowed=", ".join(stored), remedy=did_you_mean(name, stored)
            )
    if given is not None:
        circular = sorted({*given} & {*time_names, "frequency_hz", *columns})
        if circular:
            raise InputError(
                "a column that is watched, or the times, cannot be a condition", field="--conditions",
                value=", ".join(circular), remedy="name what was measured beside the modes",
            )  # fmt: skip
        return tuple(given), ()
    taken = {*time_names, "label", *QUANTITIES, *(c + s for c in columns for s in _SUFFIXES)}
    free = [n for n in stored if n not in taken and n.lower() not in _STATES]
    left = tuple(
        n for n in free
        if stored[n].dtype.kind != "f" or _MODAL.search(n) or _names_a_mode(n, stored) or _counts(stored[n])
    )  # fmt: skip
    return tuple(n for n in free if n not in left), left


def _counts(x: FloatArray) -> bool:
    """Tell whether a column numbers the rows: as a condition it would explain every slow change away."""
    steps = np.diff(x)
    return steps.size > 1 and bool(steps[0] != 0.0 and (steps == steps[0]).all())


def _names_a_mode(name: str, stored: Columns) -> bool:
    """Tell whether a column is a mode's frequency: by its label, or by the damping or direction beside it.

    A single letter with a number is none: T1 is a temperature.
    """
    letters = re.sub(r"[\W\d_]", "", name)
    if any(name + suffix in stored for suffix in ("_damping", "_angle_deg")):
        return True
    try:
        read_mode_label(name)
    except InputError:
        return False
    return len(letters) > 1 and bool(re.search(r"\d", name))


def _number(stored: Columns, name: str, rows: int) -> FloatArray:
    x = stored.get(name)
    if x is None:
        return np.full(rows, np.nan)
    if x.dtype.kind != "f":
        bad = next((w for w in x if w not in _MISSING and not _is_number(str(w))), x[0])
        raise InputError("is not a number", field=name, value=str(bad), allowed="numbers or empty cells")
    return np.asarray(x)


def _is_number(word: str) -> bool:
    try:
        float(word.replace(",", "."))
    except ValueError:
        return False
    return True


def _states(stored: Columns, rows: int) -> tuple[IntArray, tuple[str, ...]]:
    name = next((n for n in stored if n.lower() in _STATES), None)
    if name is None:
        return np.zeros(rows, dtype=np.intp), ("all",)
    words, number = np.unique(stored[name].astype(np.str_), return_inverse=True)
    return number.astype(np.intp), tuple(map(str, words))


def _wide(
    stored: Columns, days: FloatArray, names: tuple[str, ...], conditions: tuple[str, ...]
) -> tuple[History, tuple[str, ...]]:
    if len(set(names)) < len(names):
        raise InputError("a column is named twice", field="--columns", value=", ".join(names))
    repeated = np.flatnonzero(np.diff(days) == 0.0)
    if repeated.size:
        raise InputError(
            "a time stands twice", field="time", value=f"line {int(repeated[0]) + 3}", allowed="once",
            remedy="leave the second row out",
        )  # fmt: skip
    n = days.size

    def block(suffix: str) -> FloatArray:
        return np.stack([_number(stored, name + suffix, n) for name in names], axis=1)

    states, state_names = _states(stored, n)
    seen = dict(zip(QUANTITIES.values(), map(block, _SUFFIXES), strict=True))
    beside = np.stack([_number(stored, c, n) for c in conditions], axis=1) if conditions else np.zeros((n, 0))
    return _checked(_history(days, names, seen, beside, conditions, states, state_names))


def _history(
    days: FloatArray, labels: tuple[str, ...], seen: dict[str, FloatArray], beside: FloatArray,
    conditions: tuple[str, ...], states: IntArray, state_names: tuple[str, ...],
) -> History:  # fmt: skip
    """Return a history; directions are in degrees until here."""
    seen |= {name: np.radians(seen[name]) for name in ("angle", "angle_std")}
    return History(
        days, labels, conditions=beside, condition_names=conditions, states=states, state_names=state_names,
        **seen,
    )  # fmt: skip


def _long(stored: Columns, days: FloatArray, conditions: tuple[str, ...]) -> tuple[History, tuple[str, ...]]:
    words = np.array([_label(w) for w in stored["label"]], dtype=np.str_)
    if (words == "").any() or (words == "nan").any():
        line = int(np.flatnonzero((words == "") | (words == "nan"))[0]) + 2
        raise InputError(
            "a row without a label", field="label", value=f"line {line}", allowed="a name for each mode",
            remedy="leave the row out, or name its mode",
        )  # fmt: skip
    labels, mode = np.unique(words, return_inverse=True)
    when, row = np.unique(days, return_inverse=True)
    key = row * len(labels) + mode
    keys, count = np.unique(key, return_counts=True)
    if (count > 1).any():
        first = int(np.flatnonzero(np.isin(key, keys[count > 1]))[1])
        raise InputError(
            "a mode stands twice at one time", field="label", value=f"{words[first]}, line {first + 2}",
            allowed="one row a mode and time", remedy="leave the second row out",
        )  # fmt: skip
    n, m = when.size, labels.size

    def block(name: str) -> FloatArray:
        out = np.full((n, m), np.nan)
        out[row, mode] = _number(stored, name, days.size)
        return out

    seen = {of: block(name) for name, of in QUANTITIES.items()}
    states, state_names = _states(stored, days.size)
    first_row = np.zeros(n, dtype=np.intp)
    first_row[row[::-1]] = np.arange(days.size)[::-1]
    beside = np.full((n, len(conditions)), np.nan)
    for k, name in enumerate(conditions):
        x = _number(stored, name, days.size)
        good = np.isfinite(x)
        beside[row[good], k] = x[good]
    order = np.argsort(typical(seen["frequency"]))
    seen = {of: values[:, order] for of, values in seen.items()}
    names = tuple(str(labels[i]) for i in order)
    return _checked(_history(when, names, seen, beside, conditions, states[first_row], state_names))


def _label(word: Any) -> str:
    return f"mode_{int(word)}" if isinstance(word, float) and np.isfinite(word) else str(word)


def _checked(history: History) -> tuple[History, tuple[str, ...]]:
    """Return the history with impossible values missing, and remarks."""
    remarks = []
    usual = float(np.nanmedian(history.damping)) if np.isfinite(history.damping).any() else 0.0
    if usual > _LARGEST_USUAL:
        history = replace(history, damping=0.01 * history.damping, damping_std=0.01 * history.damping_std)
        remarks.append(f"damping of {usual:.2g} in the median is no ratio: taken as per cent")
    arrays: dict[str, Any] = {}
    for what, column in QUANTITIES.items():
        x = getattr(history, column)
        if column.endswith("_std") and (x < 0.0).any():
            raise InputError(
                "a standard deviation below zero", field=what, value=float(x[x < 0.0][0]),
                allowed="> 0, or empty", remedy="leave the column out if it is no such thing",
            )  # fmt: skip
        bad = np.isinf(x) | ((x <= 0.0) & (column != "angle"))
        if bad.any():
            of = ", ".join(label for label, any_ in zip(history.labels, bad.any(0), strict=True) if any_)
            remarks.append(
                f"{int(bad.sum())} values of {what} ({of}) that are not above zero or infinite count as "
                "missing"
            )
            arrays[column] = np.where(bad, np.nan, x)
    endless = np.isinf(history.conditions)
    if endless.any():
        remarks.append(f"{int(endless.sum())} infinite values of conditions count as missing")
        arrays["conditions"] = np.where(endless, np.nan, history.conditions)
    history = replace(history, **arrays)
    if not np.isfinite(history.frequency).any():
        raise InputError("no frequency at all", field="frequency_hz", allowed="> 0 Hz")
    if not np.isfinite(history.frequency_std).any():
        remarks.append("no standard deviations are stated: they are estimated from the scatter of neighbours")
    if not history.condition_names:
        remarks.append(
            "no conditions are given: what they do is part of the unexplained, which all modes share in part"
        )
    empty = [
        name
        for name, column in zip(history.condition_names, history.conditions.T, strict=True)
        if not np.isfinite(column).any()
    ]
    remarks += [f"condition {name} is empty" for name in empty]
    return history, tuple(remarks)
