"""Series of Bladed: a header ``NAME.%NN`` in words, and its numbers in ``NAME.$NN``, binary or text.

Keys of the header and the order of the numbers are those that DNV explains ("Converting ASCII outputs to
binary", Bladed Knowledge Base): the last axis, of time here, varies slowest, the variables fastest.
"""

from __future__ import annotations

import re
import shlex
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require
from jackettwin.records.readers import openfast
from jackettwin.records.readers.description import ChannelEntry
from jackettwin.records.readers.table import ReadTable

if TYPE_CHECKING:
    from pathlib import Path

_HEADER = re.compile(r"\.%\d+$")
_NUMBERS = {"R*4": "<f4", "R*8": "<f8"}
_UNITS = {
    "N": "", "T": "s", "L": "m", "A": "rad", "F": "N", "FL": "N m", "M": "kg", "P": "W", "A/T": "rad/s",
    "L/T": "m/s", "A/TT": "rad/s^2", "L/TT": "m/s^2", "F/LL": "Pa",
}  # fmt: skip
"""SI units of Bladed's dimensions: length, time, angle, force, mass, power."""
_EVEN = 2
"""AXIMETH of an axis that is told by ``MIN`` and ``STEP``."""
_MOST_AXES = 3


def read_output(path: Path) -> ReadTable:
    """Read what another program computed: Bladed's header (``.%NN``), else OpenFAST's text or binary.

    Raises
    ------
    InputError
        If the file is damaged, or Bladed's numbers are missing or not over time.
    """
    return read_bladed(path) if _HEADER.search(path.name) else openfast.read_text(path)


def read_bladed(path: Path) -> ReadTable:
    """Read a header of Bladed with its numbers beside it.

    With stations along a part, each variable becomes a channel at each: ``Mx @ 10``.

    Raises
    ------
    InputError
        If a key is missing, the numbers are missing or cut off, or the last axis is not even time.
    """
    with located(file=path):
        keys = _keys(path)
        sizes = [int(n) for n in _words(keys, "DIMENS")]
        require(
            2 <= len(sizes) <= _MOST_AXES and min(sizes) > 0,
            "holds no series",
            field="DIMENS",
            value=sizes,
            allowed="variables and times, or variables, stations and times",
        )
        labels, units = _words(keys, "VARIAB"), _words(keys, "VARUNIT")
        require(
            len(labels) == len(units) == sizes[0],
            "names and units differ in number",
            field="VARIAB",
            value=(len(labels), len(units)),
            allowed=str(sizes[0]),
        )
        times = _time(keys, sizes[-1])
        values = _numbers(path, keys, prod(sizes)).reshape(sizes[::-1])
        stations = [""] if len(sizes) == 2 else [f" @ {name}" for name in _stations(keys, sizes[1])]
    names = tuple(label + station for station in stations for label in labels)
    entries = {
        name: ChannelEntry(unit=_UNITS.get(unit, unit))
        for name, unit in zip(names, units * len(stations), strict=True)
    }
    return ReadTable(names, np.asarray(values.reshape(sizes[-1], -1).T), entries, times_s=times)


def _keys(path: Path) -> dict[str, list[str]]:
    """Return what stands behind each key, once for every time that it does."""
    found: dict[str, list[str]] = {}
    for line in path.read_text("latin-1").splitlines():
        key, _, rest = line.strip().partition(" ") if "\t" not in line else line.strip().partition("\t")
        if key:
            found.setdefault(key.upper(), []).append(rest.strip())
    return found


def _words(keys: dict[str, list[str]], key: str, at: int = 0) -> list[str]:
    require(len(keys.get(key, [])) > at, "a key is missing", field=key, remedy="is this a header of Bladed?")
    try:
        return shlex.split(keys[key][at], posix=True)
    except ValueError as error:
        raise InputError(
            f"is not readable: {error}",
            field=key,
            value=keys[key][at],
            remedy="close its quotation marks as Bladed writes them",
        ) from None


def _time(keys: dict[str, list[str]], n: int) -> FloatArray:
    """Return the times of the last axis."""
    methods = [int(_words(keys, "AXIMETH", at)[0]) for at in range(len(keys.get("AXIMETH", [])))]
    require(
        bool(methods) and methods[-1] == _EVEN and _words(keys, "AXIUNIT", len(methods) - 1) == ["T"],
        "the last axis is not even time",
        field="AXIMETH",
        value=methods[-1:],
        allowed=f"{_EVEN} with AXIUNIT T, MIN and STEP",
    )
    first, step = (float(_words(keys, key, len(keys.get(key, [""])) - 1)[0]) for key in ("MIN", "STEP"))
    return first + step * np.arange(n, dtype=np.float64)


def _stations(keys: dict[str, list[str]], n: int) -> list[str]:
    """Return the names of the stations: their ticks, or their places."""
    named = _words(keys, "AXITICK") if "AXITICK" in keys else []
    places = named or [f"{float(word):g}" for word in (_words(keys, "AXIVAL") if "AXIVAL" in keys else [])]
    return places if len(places) == n else [str(k + 1) for k in range(n)]


def _numbers(path: Path, keys: dict[str, list[str]], n: int) -> FloatArray:
    beside = path.with_name(path.name.replace(".%", ".$"))
    require(
        beside.is_file(),
        "its numbers are missing",
        field="FILE",
        value=beside.name,
        remedy="lay them beside it",
    )
    if _words(keys, "FORM") == ["F"]:
        found = np.array(beside.read_text("latin-1").split(), dtype=np.float64)
    else:
        kind = "".join(_words(keys, "FORMAT")) or "R*4"
        require(kind in _NUMBERS, "unknown numbers", field="FORMAT", value=kind, allowed=", ".join(_NUMBERS))
        raw = beside.read_bytes()
        found = np.frombuffer(
            raw[: len(raw) // 8 * 8 if kind == "R*8" else len(raw) // 4 * 4], _NUMBERS[kind]
        )
    require(
        found.size == n, "has another number of values", field="DIMENS", value=int(found.size), allowed=str(n)
    )
    return found.astype(np.float64)
