"""Forces at nodes that a scenario states: a file of series, and a pull with release."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, look_up, require
from jackettwin.files import Schema, read_text as read_lines
from jackettwin.quantities import plain_unit, to_si
from jackettwin.records import read_output
from jackettwin.structure import Structure

COMPONENTS = ("fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
"""Of a column of a file of forces, behind the node: forces and moments about it along global axes."""
_TIME = "time_s"
_LONGEST = 2_000_000
"""Rows that a file of forces may have."""
_LARGEST = 1e10
"""No push has more newtons, or newton metres."""
Component = Literal["fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m"]
Part = Annotated[float, Field(ge=-1e3, le=1e3)]


@dataclass(frozen=True, eq=False)
class GivenForces:
    """Forces and moments at nodes, straight between growing times; none before the first and after the last.

    Attributes
    ----------
    time_s : (n,) from the start of the record
    nodes : tuple of str
    values : (n, n_nodes, 6) [N, N·m]
    """

    time_s: FloatArray
    nodes: tuple[str, ...]
    values: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Return forces (n_times, n_nodes, 6) at times [s] of the record."""
        flat = self.values.reshape(self.time_s.size, -1)
        found = np.stack([np.interp(t, self.time_s, row, left=0.0, right=0.0) for row in flat.T], axis=1)
        return found.reshape(t.size, *self.values.shape[1:])


class StartSchema(Schema):
    """``start``: a node pulled aside, until it is let go ``release_s`` after the record begins."""

    node: str
    direction: tuple[Part, Part, Part]
    displacement_m: Annotated[float, Field(ge=-100.0, le=100.0)] | None = None
    force_n: Annotated[float, Field(ge=-_LARGEST, le=_LARGEST)] | None = None
    release_s: Annotated[float, Field(ge=0.0, le=86400.0)] = 0.0

    def build(self, structure: Structure, *, duration_s: float) -> Pull:
        """Return the pull.

        Raises
        ------
        InputError
            If the node is none of the structure, the direction is nil, or not one of force and displacement
            is given.
        """
        with located(field="start"):
            look_up(structure.nodes, self.node, "node", field="node")
            length = float(np.linalg.norm(self.direction))
            require(
                length > 0.0,
                "has no length",
                field="direction",
                value=self.direction,
                remedy="e.g. [1, 0, 0]",
            )
            require(
                (self.displacement_m is None) != (self.force_n is None),
                "needs either a displacement or a force",
                field="displacement_m",
                value=self.displacement_m,
                remedy="displacement_m: 0.2, or force_n: 5.0e5",
            )
            require(
                self.release_s < duration_s,
                "is not let go within the record",
                field="release_s",
                value=self.release_s,
                allowed=f"< {duration_s:g}",
            )
        x, y, z = (float(v) / length for v in self.direction)
        return Pull(self.node, (x, y, z), self.displacement_m, self.force_n, self.release_s)


@dataclass(frozen=True)
class Pull:
    """A node pulled along a unit direction, by a force or so far as a displacement, and let go."""

    node: str
    direction: tuple[float, float, float]
    displacement_m: float | None
    force_n: float | None
    release_s: float


class OutputForcesSchema(Schema):
    """``forces`` of OpenFAST's or Bladed's output: which channels act on which node, in the file's units.

    Channels are what acts on the structure along its global axes; ``factor`` −1 turns reactions about.
    ``discard_s`` is left out of the file's beginning, whose rest begins with the record.
    """

    file: str
    node: str
    channels: Annotated[dict[Component, str], Field(min_length=1)]
    factor: Annotated[float, Field(ge=-100.0, le=100.0)] = 1.0
    discard_s: Annotated[float, Field(ge=0.0, le=86400.0)] = 0.0

    def build(self, structure: Structure, folder: Path) -> GivenForces:
        """Return the forces.

        Raises
        ------
        InputError
            If the file is no output of OpenFAST or Bladed, lacks a channel, or its unit is no force's.
        """
        path = folder / self.file
        with located(field="forces"):
            look_up(structure.nodes, self.node, "node", field="node")
            require(path.is_file(), "no such file", field="file", value=str(path), remedy="check the path")
        with located(file=path, field="forces"):
            found = read_output(path)
            assert found.times_s is not None
            kept = found.times_s >= found.times_s[0] + self.discard_s
            t = found.times_s[kept] - found.times_s[kept][0] if kept.any() else np.empty(0)
            require(
                t.size > 1, "nothing is left", field="discard_s", value=self.discard_s, remedy="discard less"
            )
            values = np.zeros((t.size, 1, 6))
            for component, channel in self.channels.items():
                look_up(dict.fromkeys(found.names), channel, "channel", field=f"channels.{component}")
                unit = plain_unit(found.channels[channel].unit or "")
                with located(field=f"channels.{component}"):
                    scale = self.factor * to_si("moment" if component.startswith("m") else "force", unit)
                values[:, 0, COMPONENTS.index(component)] = (
                    scale * found.data[found.names.index(channel)][kept]
                )
            _check(t, values)
        return GivenForces(t, (self.node,), values)


def read_forces(path: Path, structure: Structure) -> GivenForces:
    """Read a CSV with the columns ``time_s`` and ``NODE.fx_n`` (…``fz_n``, ``mx_n_m``…``mz_n_m``).

    Raises
    ------
    InputError
        Names the file, and the column that is missing, unknown or no number.
    """
    reader = csv.reader(read_lines(path, what="file of forces").splitlines()[: _LONGEST + 1])
    header = [name.strip() for name in next(reader, [])]
    with located(file=path, field="forces"):
        try:
            table = np.array([[float(cell) for cell in row] for row in reader if row])
        except ValueError as error:
            raise InputError("not a number", value=str(error)) from None
        require(
            table.ndim == 2 and table.shape[1] == len(header) and table.shape[0] > 1,
            "no rows, or rows of other lengths",
            value=len(table),
            allowed=f"two rows or more of {len(header)} numbers",
        )
        require(
            _TIME in header and len({*header}) == len(header) > 1,
            "columns are missing or there twice",
            value=header,
            allowed=f"{_TIME}, and columns like tower_top.{COMPONENTS[0]}",
            remedy="name the columns in the first line",
        )
        places = [_place(name, structure) for name in header if name != _TIME]
        nodes = tuple(dict.fromkeys(node for node, _ in places))
        values = np.zeros((table.shape[0], len(nodes), 6))
        given = np.delete(table, header.index(_TIME), axis=1)
        for (node, component), column in zip(places, given.T, strict=True):
            values[:, nodes.index(node), component] = column
        t = table[:, header.index(_TIME)]
        _check(t, values)
    return GivenForces(t, nodes, values)


def _place(column: str, structure: Structure) -> tuple[str, int]:
    """Return node and component of a column."""
    node, _, component = column.rpartition(".")
    require(
        component in COMPONENTS,
        "is no force at a node",
        value=column,
        allowed=f"{_TIME}, NODE.{', NODE.'.join(COMPONENTS)}",
        remedy="units are in the name: newtons and newton metres",
    )
    look_up(structure.nodes, node, "node")
    return node, COMPONENTS.index(component)


def _check(t: FloatArray, values: FloatArray) -> None:
    require(
        bool(np.all(np.diff(t) > 0.0)),
        "times must grow",
        value=t[:5].tolist(),
        remedy="sort the rows by time_s, seconds from the start of the record",
    )
    require(
        bool(np.isfinite(values).all()) and float(np.abs(values).max()) <= _LARGEST,
        "is no force, or one beyond reason",
        value=float(np.abs(values).max()),
        allowed=f"up to {_LARGEST:g} N or N·m",
        remedy="fill gaps; give newtons",
    )
