"""Place and direction of a channel from its name: ``ACC_088m_E``, ``TT_FA``, ``LAT097_SS``.

Two tables of patterns are used, ignoring case. A name with contradictory parts is ignored.
Whatever is taken from a name is reported (``told``), and a description overrules it.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Vector = tuple[float, float, float]

_ALONE = r"(?<![a-z0-9])(?<![_\s(]-)(?:{})(?![a-z0-9])"
"""Pattern of a separate word. A minus before an axis (``acc_-x``) is not read,
since it may be a sign or a separator."""
_LETTERS = r"(?<![a-z])(?:{})(?![a-z])"
_BESIDE_HEIGHT = (
    r"(?<![a-z0-9])(?:{})[\s_\-](?=(?:h|z|lat)?[\s_]?[+\-]?\d{{1,3}}(?:[.,p]\d+)?\s?m(?:sl)?(?![a-z0-9/^²]))"
)
"""Pattern of a single letter that stands before a height: ``B_Turm_E_65m``. Anywhere else in a name it may
stand for anything."""

DIRECTIONS: tuple[tuple[str, Vector, str], ...] = (
    (_ALONE.format("(?:acc|a|vel|v|disp|u)?x"), (1.0, 0.0, 0.0), "x"),
    (_ALONE.format("(?:acc|a|vel|v|disp|u)?y"), (0.0, 1.0, 0.0), "y"),
    (_ALONE.format("(?:acc|a|vel|v|disp|u)?z"), (0.0, 0.0, 1.0), "z"),
    (_LETTERS.format(r"fa|fore[\s_\-]?aft"), (1.0, 0.0, 0.0), "fore-aft"),
    (_LETTERS.format("longitudinal|l(?:ä|ae|a)ngs"), (1.0, 0.0, 0.0), "lengthwise"),
    (_LETTERS.format("transvers(?:e|al)?|lateral|quer|tv(?:æ|ae)rs"), (0.0, 1.0, 0.0), "crosswise"),
    (_LETTERS.format(r"ss|sts|s2s|side[\s_\-]?(?:to[\s_\-]?)?side"), (0.0, 1.0, 0.0), "side-side"),
    (_LETTERS.format("vert|vertical|heave"), (0.0, 0.0, 1.0), "vertical"),
    (r"(?<![a-z])(?:(?:east|ost)(?![a-z])|[eo]$)", (1.0, 0.0, 0.0), "east"),
    (r"(?<![a-z])(?:(?:north|nord)(?![a-z])|n$)", (0.0, 1.0, 0.0), "north"),
    (_LETTERS.format("west"), (-1.0, 0.0, 0.0), "west"),
    (_LETTERS.format("south|s[uü]e?d"), (0.0, -1.0, 0.0), "south"),
    *(
        (_BESIDE_HEIGHT.format(letters), vector, word)
        for letters, vector, word in (
            ("[eo]", (1.0, 0.0, 0.0), "east"),
            ("n", (0.0, 1.0, 0.0), "north"),
            ("w", (-1.0, 0.0, 0.0), "west"),
            ("s", (0.0, -1.0, 0.0), "south"),
        )
    ),
)
"""Pattern, unit vector in global axes (x east where a name speaks of compass points), what it is called."""

HEADING = re.compile(r"(?<![\d.,])(?P<degrees>\d{1,3})\s?(?:deg|°)(?![a-z])")
"""Compass heading of the x axis in a name of an x or a y, as in ``TW_ACC_LAT41_031deg_X``; z points up."""

LAT = "LAT"
"""Lowest astronomical tide, in names like ``LAT097``: a metre or two below mean sea level."""

HEIGHTS: tuple[tuple[str, str], ...] = (
    (r"(?<![a-z])lat(?P<m>\d{2,3})(?![.,]?\d)", LAT),
    # a small number on its own, as in ``acc_lat_2``, may be that of a lateral sensor
    (
        r"(?<![a-z])lat[\s_]?"
        r"(?P<m>[+\-]?\d{3}|[+\-]\d{1,2}|[+\-]?\d{1,3}[.,]\d+|\d{1,3}(?=\s?m(?![a-z])))(?![.,]?\d)",
        LAT,
    ),
    (
        r"(?<![a-z0-9.,])(?:h|z|el|elev|level|height|(?:acc|a)(?=\d))?"
        r"(?P<m>[+\-]?\d{1,3}(?:[.,p]\d+)?)\s?m(?:sl)?(?![a-z0-9/^²])",
        "",
    ),
    (r"(?<![a-z0-9])(?:h|el|elev|height)[\s_]?(?P<m>[+\-]?\d{2,3}(?:[.,p]\d+)?)(?![a-z0-9])", ""),
)
"""Pattern with the number of metres as ``m``, and the datum if it is not mean sea level."""

LEVELS: tuple[tuple[str, str], ...] = (
    (_LETTERS.format(r"tt|(?:tower|twr)?[\s_]?top|nac|nacelle|rna|yaw[\s_]?br(?:g|ng|ing)?"), "tower top"),
    (_LETTERS.format(r"tm|(?:tower|twr)?[\s_]?mid(?:dle)?"), "tower middle"),
    (_LETTERS.format(r"tp|transition[\s_]?piece"), "transition piece"),
    (_LETTERS.format(r"tb|(?:tower|twr)?[\s_]?(?:bottom|base|bot)"), "tower bottom"),
)
"""Pattern and the part of the structure that a name without a height speaks of."""


@dataclass(frozen=True)
class Reading:
    """Content of a name; None where it says nothing or contradicts itself.

    Attributes
    ----------
    direction : unit vector in global axes
    direction_word : str
        What the direction is called: ``"fore-aft"``, ``"east"``; empty without one.
    height_m : float
        Above mean sea level, as ``datum`` says.
    datum : str
        ``"LAT"`` if the name counts from lowest astronomical tide.
    level : str
        The part of the structure, ``"tower top"``; empty without one.
    unit : str
        Of the stored numbers; filled in by who knows the quantity.
    """

    direction: Vector | None = None
    direction_word: str = ""
    height_m: float | None = None
    datum: str = ""
    level: str = ""
    unit: str = ""


def read_name(name: str) -> Reading:
    """Return place and direction from the name of a channel.

    Examples
    --------
    >>> read_name("ACC_088m_E")
    Reading(direction=(1.0, 0.0, 0.0), direction_word='east', height_m=88.0, datum='', level='', unit='')
    >>> read_name("LAT097_SS").height_m, read_name("acc_x_77m").direction, read_name("TT_FA").level
    (97.0, (1.0, 0.0, 0.0), 'tower top')
    >>> read_name("ss_x").direction is None  # two different things
    True
    """
    lower = name.strip().lower()
    named = [(vector, word) for pattern, vector, word in DIRECTIONS if re.search(pattern, lower)]
    agreed = len({vector for vector, _ in named}) == 1
    direction, word = (named[0][0], named[-1][1]) if agreed else (None, "")
    heading = HEADING.search(lower)
    if direction is not None and heading and word in ("x", "y"):
        east, north = _compass(float(heading["degrees"]))
        direction = (east, north, 0.0) if word == "x" else (-north, east, 0.0)
        word = f"{word} by heading {int(heading['degrees'])}°"
    heights = {
        (float(match["m"].replace(",", ".").replace("p", ".")), datum)
        for pattern, datum in HEIGHTS
        for match in re.finditer(pattern, lower)
    }
    if len({value for value, _ in heights}) > 1:
        heights = set()
    height, datum = next(iter(heights), (None, ""))
    levels = [level for pattern, level in LEVELS if re.search(pattern, lower)]
    return Reading(
        direction=direction,
        direction_word=word,
        height_m=height,
        datum=datum,
        level=levels[0] if len(set(levels)) == 1 else "",
    )


_ACROSS = {"x": ("y", 0), "y": ("x", 1), "n": ("e", 1), "e": ("n", 0), "o": ("n", 0)}
"""Letter of a direction, that of the direction across, and which of x and y it is."""
_LETTER = re.compile(r"(?<![a-z])[xyeno](?![a-z])")


def read_names(names: Iterable[str]) -> dict[str, Reading]:
    """Return place and direction from the names of a record's channels, which may explain each other.

    A letter that alone says nothing is a direction if another name differs by the letter of the direction
    across, and by nothing else.

    Examples
    --------
    >>> both = read_names(["WEA3_E_acc_2", "WEA3_N_acc_2", "WEA3_E_acc_5"])
    >>> [reading.direction_word for reading in both.values()]
    ['east', 'north', '']
    """
    read = {name: read_name(name) for name in names}
    lower = {name.strip().lower() for name in read}
    words = ("x", "y"), ("east", "north")
    for name, reading in read.items():
        text, found = name.strip().lower(), set()
        for match in _LETTER.finditer(text) if reading.direction is None else ():
            letter, at = match.group(), match.start()
            across, axis = _ACROSS[letter]
            others = ("e", "o") if across == "e" else (across,)
            if any(text[:at] + other + text[at + 1 :] in lower for other in others):
                found.add((axis, words[letter not in "xy"][axis]))
        if len(found) == 1:
            ((axis, word),) = found
            vector = (1.0, 0.0, 0.0) if axis == 0 else (0.0, 1.0, 0.0)
            read[name] = replace(reading, direction=vector, direction_word=word)
    return read


def told(used: Mapping[str, Reading]) -> tuple[str, ...]:
    """Return the remark on what was taken from channels' names, None if it is obvious.

    A name that ends in the letter of its axis is obvious and not repeated.

    Parameters
    ----------
    used : mapping
        Channel name → the parts of its reading that were used.
    """
    heights: dict[str, list[str]] = {}
    directions: dict[str, list[str]] = {}
    units: dict[str, list[str]] = {}
    for name, reading in used.items():
        if reading.unit:
            units.setdefault(f"in {reading.unit}", []).append(name)
        if reading.height_m is not None:
            above = " above lowest astronomical tide, taken as mean sea level" if reading.datum == LAT else ""
            heights.setdefault(f"{reading.height_m:g} m{above}", []).append(name)
        if reading.direction is not None and reading.direction_word not in ("x", "y", "z"):
            axis = _axis(reading.direction)
            directions.setdefault(f"{reading.direction_word} is {axis}", []).append(name)
    parts = [
        f"{what} ({_list(names)})" for what, names in (*heights.items(), *directions.items(), *units.items())
    ]
    if not parts:
        return ()
    overrule = "height_m, direction and unit in the JSON beside the file overrule this"
    return (f"read from the channel names: {'; '.join(parts)}; {overrule}",)


def _compass(heading_degrees: float) -> tuple[float, float]:
    """Return how far east and how far north a heading points."""
    angle = math.radians(heading_degrees)
    return round(math.sin(angle), 6), round(math.cos(angle), 6)


def _axis(vector: Vector) -> str:
    axis = max(range(3), key=lambda i: abs(vector[i]))
    if abs(vector[axis]) < 1.0:
        return f"({', '.join(f'{part:.2g}' for part in vector)})"
    return f"{'-' if vector[axis] < 0 else '+'}{'xyz'[axis]}"


def _list(names: list[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
