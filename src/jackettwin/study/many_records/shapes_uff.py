"""Mode shapes in the universal file format: units (data set 164), nodes (15) and modes (55).

Layout after the SDRC descriptions of these data sets. A place with sensors is a node; the readings of its
sensors along their directions become one translation of the node, the smallest that gives them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import require

STRUCTURAL, COMPLEX_MODE, TRANSLATIONS, COMPLEX = 1, 3, 2, 5
"""Record 6 of data set 55: model, analysis and data characteristic, type of the numbers."""
QUANTITIES = {"displacement": 8, "velocity": 11, "acceleration": 12}
"""Record 6, field 4: what the numbers are."""
_END = "    -1"


def write_shapes_uff(document: Mapping[str, Any], path: Path) -> None:
    """Write the modes of a document of ``jackettwin identify``, one record's or those fused over several.

    Raises
    ------
    InputError
        If no channel of motion says in which direction it points.
    """
    channels = pointing(document["channels"])
    places: dict[tuple[Any, Any], list[str]] = {}
    for name, about in channels.items():
        places.setdefault((about["node"], about["height_m"]), []).append(name)
    kinds = {about["quantity"] for about in channels.values()}
    kind = QUANTITIES[kinds.pop()] if len(kinds) == 1 else QUANTITIES["acceleration"]
    lines = [*_units(), *_nodes(list(places))]
    for number, mode in enumerate(document["modes"], start=1):
        moved = [
            (node, _translation(mode["mode_shape"], names, channels))
            for node, names in enumerate(places.values(), start=1)
        ]
        lines += _mode(mode, number, kind, [(node, u) for node, u in moved if u is not None])
    path.write_text("".join(f"{line}\n" for line in lines), encoding="ascii", errors="replace")


def pointing(channels: Mapping[str, Any]) -> dict[str, Any]:
    """Return the channels of motion, by name with quantity and direction, that say where they point.

    Raises
    ------
    InputError
        If none does.
    """
    known = {
        name: about
        for name, about in channels.items()
        if about["quantity"] in QUANTITIES and any(about["direction"])
    }
    require(
        known,
        "shapes in UFF need channels that say in which direction they point",
        field="channels",
        value=list(channels),
        remedy='state "direction" of each in the JSON beside the record, or choose .json, .csv or .nc',
    )
    return known


def _translation(
    shape: Mapping[str, Any], names: list[str], channels: Mapping[str, Any]
) -> ComplexArray | None:
    """Return the motion (3,) of a node by its sensors; None if none of them is in the shape."""
    seen = [name for name in names if name in shape]
    if not seen:
        return None
    directions: FloatArray = np.array([channels[name]["direction"] for name in seen], dtype=np.float64)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.asarray(np.linalg.pinv(directions) @ [complex(*shape[name]) for name in seen])


def _units() -> Iterator[str]:
    yield from (_END, f"{164:6d}", f"{1:10d}{'SI: m, N, K':>20}{2:10d}")
    yield f"{1.0:25.17E}{1.0:25.17E}{1.0:25.17E}".replace("E", "D")
    yield f"{273.15:25.17E}".replace("E", "D")
    yield _END


def _nodes(places: list[tuple[Any, Any]]) -> Iterator[str]:
    """Yield the nodes; only heights on the axis of the tower are known here."""
    yield from (_END, f"{15:6d}")
    for number, (_, height_m) in enumerate(places, start=1):
        z = 0.0 if height_m is None else height_m
        yield f"{number:10d}{0:10d}{0:10d}{11:10d}{0.0:13.5E}{0.0:13.5E}{z:13.5E}"
    yield _END


def _mode(
    mode: Mapping[str, Any], number: int, kind: int, moved: list[tuple[int, ComplexArray]]
) -> Iterator[str]:
    """Yield a mode with its pole λ; without a known mass modal A is one, and modal B is −λ A."""
    ratio = mode["damping_ratio"] or 0.0
    omega = 2.0 * np.pi * mode["frequency_hz"]
    pole = omega * complex(-ratio, np.sqrt(max(1.0 - ratio**2, 0.0)))
    yield from (_END, f"{55:6d}", f"Mode {number}: {mode['frequency_hz']:.6g} Hz, {mode['status']}")
    yield from ("NONE", "NONE", "NONE", "NONE")
    yield "".join(f"{n:10d}" for n in (STRUCTURAL, COMPLEX_MODE, TRANSLATIONS, kind, COMPLEX, 3))
    yield f"{2:10d}{6:10d}{0:10d}{number:10d}"
    yield _numbers([pole, 1.0 + 0.0j, -pole])
    for node, translation in moved:
        yield f"{node:10d}"
        yield _numbers(translation)
    yield _END


def _numbers(values: Any) -> str:
    return "".join(f"{value.real:13.5E}{value.imag:13.5E}" for value in values)
