"""Conversion of a table of measured modes, as a consultant delivers it, to the ``targets`` of a twin.

Each row is a mode: its name or number, frequency and damping, whose standard deviations are in their own
columns or follow ``±``. Separator and decimal sign are detected; units are in the names of the columns.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located
from jackettwin.headings import (
    IN_PERCENT,
    INTERVAL_95,
    PERCENT,
    heading_key,
    heading_scale,
    heading_width,
    with_owners,
)
from jackettwin.records import MISSING, text_table

log = logging.getLogger(__name__)
_CELL = re.compile(
    r"^\s*(?P<value>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>%|Hz)?"
    r"\s*(?:(?:±|\+/?-|\()\s*(?P<std>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*\)?\s*(?P<unit2>%|Hz)?)?\s*$"
)
MOST_RATIO = 0.2
"""Damping ratio above which the value must be a percentage without its unit."""


def read_targets_table(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table as ``targets`` of a twin file.

    Raises
    ------
    InputError
        If a cell is not understood; the error names file, line and cell.
    """
    try:
        raw = path.read_bytes()
    except OSError:
        raise InputError(
            "no such table of modes", file=path, field="targets", remedy="check the path"
        ) from None
    with located(file=path):
        return _targets(raw)


def _targets(raw: bytes) -> list[dict[str, Any]]:
    table = text_table(raw)
    rows, delimiter = table.rows, table.delimiter
    if len(rows) < 2:
        raise InputError(
            "contains no modes", field="targets", allowed="names of columns, then a row for each mode"
        )
    names = with_owners(rows[0])
    columns = {i: key for i, name in enumerate(names) if (key := heading_key(name)) is not None}
    strangers = len(columns) < len(rows[0])  # one of them may contain the modes' names
    for needed, what in (("mode", "name of the mode"), ("frequency_hz", "frequency")):
        if needed not in columns.values() and (needed != "mode" or strangers):
            raise InputError(
                f"has no column for the {what}",
                field="columns",
                value=", ".join(rows[0]),
                allowed="mode, frequency [Hz], std [Hz], damping [%], std damping [%]",
                remedy="name the columns so",
            )
    unused = [name for i, name in enumerate(rows[0]) if i not in columns and name]
    if unused:
        log.warning("table of modes: columns that are not used: %s", ", ".join(unused))
    targets = []
    for number, row in enumerate(rows[1:], start=2):
        with located(field=f"row {number}"):
            target = _target(row, names, columns, delimiter)
            if target.keys() - {"mode"}:  # a row without numbers is a mode that was not identified
                targets.append(target)
    return targets


def _target(row: list[str], names: list[str], columns: dict[int, str], delimiter: str) -> dict[str, Any]:
    target: dict[str, Any] = {}
    if any(row[len(names) :]):
        raise InputError(
            "has more cells than named columns",
            value=delimiter.join(row),
            allowed=f"{len(names)} cells",
            remedy="with decimal commas, separate the columns by semicolons",
        )
    for i, key in columns.items():
        cell = row[i] if i < len(row) else ""
        if cell.lower() in MISSING:
            continue
        if key == "mode":
            # a name takes precedence over the table's own numbering
            if "mode" not in target or not cell.isdigit():
                target["mode"] = int(cell) if cell.isdigit() else cell
            continue
        target.update(_values(key, cell if delimiter == "," else cell.replace(",", "."), names[i]))
    return target


def _values(key: str, cell: str, column: str) -> dict[str, float]:
    """Return a cell's value under its key, and a number after ± under that of its standard deviation."""
    match = _CELL.match(cell)
    if match is None:
        raise InputError(
            "is not a number",
            field=column,
            value=cell,
            allowed="0.3123, 0.3123 ± 0.0008, or 1.2 %",
            remedy="correct the cell, or leave it empty",
        )
    damps = key.startswith("damping")
    if key == "frequency_std_hz" and IN_PERCENT.search(column) and not INTERVAL_95.search(column):
        raise InputError(
            "is in per cent of the frequency", field=column, value=cell, allowed="Hz", remedy="give it in Hz"
        )
    percent = damps and bool(PERCENT.search(column) or match["unit"] == "%" or match["unit2"] == "%")
    scale = heading_scale(key, column)
    if percent and not PERCENT.search(column):
        scale *= 0.01
    if not damps and match["unit"] == "Hz":
        scale = 1.0
    if damps and not percent and scale * float(match["value"]) > MOST_RATIO:
        raise InputError(
            "seems to be a percentage without its unit",
            field=column,
            value=cell,
            allowed=f"a ratio up to {MOST_RATIO}, or a column named damping [%]",
            remedy="write the unit into the name of the column",
        )
    value = float(match["value"]) * scale
    width = heading_width(column)
    if key.endswith(("_std", "_std_hz")):
        return {key: value / width}
    std = {"frequency_hz": "frequency_std_hz", "damping_ratio": "damping_ratio_std"}[key]
    spread = {} if match["std"] is None else {std: float(match["std"]) * scale / width}
    return {key: value, **spread}


LEAST_SHARE, MOST_SHARE = 0.5, 1.15
"""Range of a frequency relative to that on rigid feet: soft soil lowers it, errors of the model may raise
it."""
_ABOVE = 2.0
"""Factor on the distance of a frequency above its mode's on rigid feet, as no support can raise it."""
_NEVER = 1e6
"""The distance from an excluded mode, finite as the assignment requires."""


def assigned_modes(frequency_hz: FloatArray, pinned_hz: FloatArray, taken: Collection[int]) -> list[int]:
    """Return the mode numbers assigned to frequencies, each mode once, at the least total distance.

    Parameters
    ----------
    frequency_hz : (n_frequencies,)
    pinned_hz : (n_modes,)
        Of the modes on rigid feet, numbered from 1.
    taken : numbers of the modes that already have a target

    Raises
    ------
    InputError
        If a frequency is near no free mode; the error names the nearest.

    Examples
    --------
    >>> assigned_modes(np.array([0.72, 0.182]), np.array([0.183, 0.186, 0.572, 0.749]), taken=())
    [4, 1]
    """
    apart = np.log(np.asarray(frequency_hz)[:, None] / pinned_hz)
    distance = np.where(apart > 0.0, _ABOVE * apart, -apart) ** 2
    distance[:, [mode - 1 for mode in taken if mode <= len(pinned_hz)]] = _NEVER
    rows, columns = scipy.optimize.linear_sum_assignment(distance)
    modes = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    for k, f in enumerate(frequency_hz):
        if k not in modes or not LEAST_SHARE <= f / pinned_hz[modes[k]] <= MOST_SHARE:
            nearest = int(np.argmin(np.abs(apart[k])))
            raise InputError(
                "is near no mode of the model that is still free",
                field="frequency_hz",
                value=float(f),
                allowed=f"{LEAST_SHARE} to {MOST_SHARE} times a mode's frequency on rigid feet",
                remedy=f"the nearest is mode {nearest + 1} with {pinned_hz[nearest]:.4g} Hz: name modes "
                "(mode: fore_aft_1), check the unit and the structure",
            )
    return [modes[k] + 1 for k in range(len(frequency_hz))]
