"""The motion of a foundation's interface as another program computed it: OpenFAST, Bladed, or a CSV."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, look_up, require
from jackettwin.files import read_text as read_lines
from jackettwin.quantities import plain_unit
from jackettwin.records import read_output

MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""What channels of a program that names them freely are of."""
CSV_COLUMNS = ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
_OF_PROGRAMS = (
    # SubDyn's transition piece, in its own frame at rest
    ("intftdxss", "intftdyss", "intftdzss", "intfrdxss", "intfrdyss", "intfrdzss"),
    # ElastoDyn's platform reference point
    ("ptfmsurge", "ptfmsway", "ptfmheave", "ptfmroll", "ptfmpitch", "ptfmyaw"),
)
_UNITS = {"m": 1.0, "rad": 1.0, "deg": np.pi / 180.0}
_EVEN = 1e-3
"""Of a step: times of a file are printed with few digits."""
_LARGEST = (50.0, 0.5)
"""No interface moves further [m, rad]: rotations are small."""


@dataclass(frozen=True, eq=False)
class InterfaceMotion:
    """Displacements and small rotations (n_times, 6) [m, rad] along and about global axes, in even steps."""

    values: FloatArray
    step_s: float


def read_interface_motion(path: Path, channels: Mapping[str, str] | None = None) -> InterfaceMotion:
    """Read OpenFAST's .out or .outb (``PtfmSurge`` …, else SubDyn's ``IntfTDXss`` …), Bladed's, or a CSV.

    A CSV has the columns ``time_s``, ``x_m``, ``y_m``, ``z_m``, ``rx_rad``, ``ry_rad`` and ``rz_rad``.
    Bladed's series (a header ``.%NN``) have the names of who wrote them.

    Parameters
    ----------
    channels : {one of MOTIONS: channel}, optional
        Which channels of a program's output move along and turn about the global axes; needed for Bladed.

    Raises
    ------
    InputError
        If columns are missing, units are unknown, or steps are not even.
    """
    with located(file=path, field="motion"):
        require(path.is_file(), "no such file", value=str(path), remedy="check the path")
        t, values = _of_csv(path) if path.suffix.lower() == ".csv" else _of_program(path, channels)
        require(t.size > 2, "too few rows", value=int(t.size), allowed="three or more")
        step = float((t[-1] - t[0]) / (t.size - 1))
        uneven = np.abs(np.diff(t) - step).max() if np.isfinite(step) else np.inf
        require(
            step > 0.0 and uneven < max(_EVEN * step, 2e-4),
            "times must grow in even steps",
            value=t[:4].tolist(),
            remedy="write the output at one step",
        )
        reach = np.abs(values).reshape(t.size, 2, 3).max(axis=(0, 2))
        require(
            bool(np.isfinite(values).all() and (reach <= _LARGEST).all()),
            "is no small motion",
            value=reach.tolist(),
            allowed=f"up to {_LARGEST[0]:g} m and {_LARGEST[1]:g} rad, without gaps",
        )
    return InterfaceMotion(values, step)


def _of_csv(path: Path) -> tuple[FloatArray, FloatArray]:
    lines = read_lines(path, what="file of motion").splitlines()
    header = [name.strip() for name in lines[0].split(",")] if lines else []
    wanted = ("time_s", *CSV_COLUMNS)
    missing = [name for name in wanted if name not in header]
    require(not missing, "columns are missing", value=missing, allowed=", ".join(wanted))
    rows = [line.split(",") for line in lines[1:] if line.strip()]
    require(
        bool(rows) and all(len(row) == len(header) for row in rows),
        "no rows, or rows of other lengths",
        value=len(rows),
        allowed=f"rows of {len(header)} numbers",
    )
    try:
        table = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise InputError("not a number, or a gap", value=str(error)) from None
    columns = table[:, [header.index(name) for name in wanted]]
    return columns[:, 0], columns[:, 1:]


def _of_program(path: Path, named: Mapping[str, str] | None) -> tuple[FloatArray, FloatArray]:
    found = read_output(path)
    assert found.times_s is not None
    rows = {name.lower(): i for i, name in enumerate(found.names)}
    wanted: tuple[str, ...] | None
    wanted = next((names for names in _OF_PROGRAMS if all(name in rows for name in names)), None)
    if named is not None:
        missing = [one for one in MOTIONS if one not in named]
        require(not missing, "motions without a channel", value=missing, allowed=", ".join(MOTIONS))
        wanted = tuple(named[one].lower() for one in MOTIONS)
        for name in wanted:
            look_up(rows, name, "channel", field="--channel")
    require(
        wanted is not None,
        "has no motion of the interface",
        value=", ".join(found.names[:8]),
        allowed="PtfmSurge, PtfmSway, PtfmHeave, PtfmRoll, PtfmPitch, PtfmYaw, or IntfTDXss … IntfRDZss",
        remedy="add them to the OutList of ElastoDyn or SubDyn, or name the channels: --channel x=NAME …",
    )
    assert wanted is not None
    values = []
    for motion, name in zip(MOTIONS, wanted, strict=True):
        unit = plain_unit(found.channels[found.names[rows[name]]].unit or "")
        of_kind = {"m"} if motion in MOTIONS[:3] else {"rad", "deg"}
        require(
            unit in of_kind, "another unit", value=f"{name} ({unit})", allowed=" or ".join(sorted(of_kind))
        )
        values.append(_UNITS[unit] * found.data[rows[name]])
    return found.times_s, np.stack(values, axis=1)
