"""Mode shapes as text tables, one row per mode and node, as other programs print them: reader and writer."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, located, require
from jackettwin.files import atomic_path, read_text

COMPONENTS = ("ux", "uy", "uz", "rx", "ry", "rz")
_NEEDED = ("mode", "frequency_hz", "node", *COMPONENTS[:3])
_PLACE = ("x_m", "y_m", "z_m")
_KNOWN = ("stage", *_NEEDED, *COMPONENTS[3:], *_PLACE)


@dataclass(frozen=True)
class NodalModes:
    """Real mode shapes at nodes.

    Attributes
    ----------
    frequency_hz : (n_modes,)
    nodes : names
    shapes : (n_modes, n_nodes, 6), any scale; translations, then rotations, zero where they are not known
    places : (n_nodes, 3) [m] in the structure's frame; None if they are not known
    has_rotations : bool
    """

    frequency_hz: FloatArray
    nodes: tuple[str, ...]
    shapes: FloatArray
    places: FloatArray | None = None
    has_rotations: bool = True


def read_modes(path: Path) -> dict[str, NodalModes]:
    """Return the modes of a CSV file by ``stage``; all under an empty name where it has no such column.

    Columns, in any order: ``mode``, ``frequency_hz``, ``node``, ``ux``, ``uy``, ``uz``; if known ``rx``,
    ``ry``, ``rz``, the node's place ``x_m``, ``y_m``, ``z_m``, and the ``stage``. A row for each mode and
    node.

    Raises
    ------
    InputError
        If a column or a number is missing, or the modes are not all of the same nodes; names line and column.
    """
    with located(file=path):
        reader = csv.DictReader(read_text(path, what="table of modes").splitlines(), skipinitialspace=True)
        header = [name.strip().lower() for name in reader.fieldnames or ()]
        for name in _NEEDED:
            remedy = f"the first line names the columns: {', '.join(_NEEDED)}, …"
            require(name in header, "column is missing", field=name, value=header, remedy=remedy)
        for name in header:
            told = {"field": name, "allowed": ", ".join(_KNOWN)}
            require(name in _KNOWN, "unknown column", remedy=did_you_mean(name, _KNOWN), **told)
        reader.fieldnames = header
        rows = [(reader.line_num, row) for row in reader]
        require(rows, "the table is empty", field="mode", remedy="give a row for each mode and node")
        stages: dict[str, list[tuple[int, dict[str, str]]]] = {}
        for line, row in rows:
            stages.setdefault((row.get("stage") or "").strip(), []).append((line, row))
        return {stage: _modes(own, header) for stage, own in stages.items()}


def _modes(rows: list[tuple[int, dict[str, str]]], header: list[str]) -> NodalModes:
    """Return the modes of one stage."""
    known = [name for name in COMPONENTS if name in header]
    by_mode: dict[str, dict[str, FloatArray]] = {}
    frequency: dict[str, float] = {}
    places: dict[str, list[float]] = {}
    for line, row in rows:
        mode, node = (row["mode"] or "").strip(), (row["node"] or "").strip()
        f = _number(row, "frequency_hz", line)
        require(f > 0.0, "must be positive", field=f"line {line}.frequency_hz", value=f, allowed="> 0")
        same = frequency.setdefault(mode, f) == f
        twice, usual = f"mode {mode} has two frequencies", f"{frequency[mode]:g}"
        require(same, twice, field=f"line {line}.frequency_hz", value=f, allowed=usual)
        shape = by_mode.setdefault(mode, {})
        require(node not in shape, f"mode {mode} has this node twice", field=f"line {line}.node", value=node)
        shape[node] = np.zeros(6)
        shape[node][: len(known)] = [_number(row, name, line) for name in known]
        if all(name in header for name in _PLACE):
            places[node] = [_number(row, name, line) for name in _PLACE]
    nodes = tuple(next(iter(by_mode.values())))
    for mode, shape in by_mode.items():
        odd = sorted({*shape} ^ {*nodes})
        require(not odd, f"mode {mode} is of other nodes than the first", field="node", value=odd[:5])
    shapes = np.array([[shape[node] for node in nodes] for shape in by_mode.values()])
    still = [mode for mode, shape in zip(by_mode, shapes, strict=True) if not np.abs(shape[:, :3]).any()]
    require(not still, "a mode without motion", field="mode", value=still)
    at = np.array([places[node] for node in nodes]) if places else None
    return NodalModes(np.array([*frequency.values()]), nodes, shapes, at, len(known) == len(COMPONENTS))


def _number(row: dict[str, str], name: str, line: int) -> float:
    text = (row.get(name) or "").strip()
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(
            "not a finite number", field=f"line {line}.{name}", value=text, remedy="write e.g. 0.125"
        )
    return value


def write_modes(modes: Iterable[tuple[str, NodalModes]], path: Path) -> Path:
    """Write modes by stage as :func:`read_modes` reads them; an empty name is no stage."""
    every = list(modes)
    staged = any(stage for stage, _ in every)
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        placed = all(own.places is not None for _, own in every)
        header = [*(["stage"] if staged else []), *_NEEDED, *COMPONENTS[3:], *(_PLACE if placed else ())]
        writer.writerow(header)
        for stage, own in every:
            places = np.full((len(own.nodes), 3), np.nan) if own.places is None else own.places
            for k, (f, shape) in enumerate(zip(own.frequency_hz, own.shapes, strict=True), start=1):
                for node, moved, place in zip(own.nodes, shape, places, strict=True):
                    numbers = [f"{v:.9g}" for v in (*moved, *(place if placed else ()))]
                    writer.writerow([*([stage] if staged else []), k, f"{f:.9g}", node, *numbers])
    return path
