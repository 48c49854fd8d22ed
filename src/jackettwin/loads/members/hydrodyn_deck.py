"""Reader of OpenFAST HydroDyn files: coefficients, marine growth, ends and filled members.

Members are matched by the positions of their joints, so that the file may be that of any deck with the
structure's members. Geometry, waves and data of floating platforms are not read.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks import Deck, DeckRow, read_deck, to_float
from jackettwin.errors import located, require
from jackettwin.loads.members.coefficients import Coefficients, GrowthBand, Strip, StripTable, growth_bands
from jackettwin.loads.members.ends import EndCoefficients
from jackettwin.structure import Structure

_SAME_PLACE_M = 0.3
"""Largest distance between matched joints: HydroDyn's files extend feet slightly into the bed, to exclude
pressure on their ends."""
_SAME_DENSITY = 0.01
_SIMPLE, _BY_DEPTH, _BY_MEMBER = 1, 2, 3


class HydroDynMembers(NamedTuple):
    """Coefficients and growth, coefficients of ends, and the members filled up to still water."""

    coefficients: Coefficients
    ends: EndCoefficients
    flooded: tuple[str, ...]


@dataclass(frozen=True)
class _Tubes:
    """The file's members: rows, ends (n, 2, 3) [m] from still water, matching members of the structure."""

    rows: tuple[DeckRow, ...]
    ends: Mapping[str, FloatArray]
    names: Mapping[str, str]


def read_hydrodyn(path: Path, structure: Structure, *, density_kg_m3: float) -> HydroDynMembers:
    """Read a HydroDyn input file (v2.03 to OpenFAST 5) for the members of a structure.

    Raises
    ------
    InputError
        If the file is missing or lacks a table, if required members do not match the structure's, or if it
        needs features that are not modelled: different ends, partly filled members, potential flow.
    """
    deck = read_deck(path, "HydroDyn file")
    with located(file=path):
        tubes = _tubes(deck, structure)
        bare, grown = _simple(deck)
        tables = (*_by_depth(deck, tubes), *_by_member(deck, tubes))
        coefficients = Coefficients(
            bare.drag, bare.added_mass, bare.pressure, _growth(deck), grown, tables, density_kg_m3
        )
        return HydroDynMembers(coefficients, _ends(deck), _flooded(deck, tubes, density_kg_m3))


def _tubes(deck: Deck, structure: Structure) -> _Tubes:
    joints = {
        row["jointid"]: np.array(row.numbers("jointxi", "jointyi", "jointzi"))
        for row in deck.table("NJoints", required=True)
    }
    rows = deck.table("NMembers", required=True)
    ends = {}
    for row in rows:
        potential = row.get("proppot", "F").strip('"').upper().startswith("T")
        require(not potential, "potential flow is not modelled", field=row.place("PropPot"))
        pair = row["mjointid1"], row["mjointid2"]
        for joint in pair:
            require(joint in joints, "no such joint", field=row.place("MJointID"), value=joint)
        ends[row["memberid"]] = np.array([joints[joint] for joint in pair])
    return _Tubes(rows, ends, _matched(ends, structure))


def _matched(ends: Mapping[str, FloatArray], structure: Structure) -> dict[str, str]:
    """Return the structure's member at the position of each of the file's members, without unmatched ones."""
    if not structure.members:
        return {}
    places = np.array([[structure.nodes[m.start], structure.nodes[m.end]] for m in structure.members])
    places = places - [0.0, 0.0, structure.sea_level_z_m]
    found = {}
    for name, pair in ends.items():
        off = [np.abs(places - way).max(axis=(1, 2)) for way in (pair, pair[::-1])]
        nearest = np.minimum(*off)
        if nearest.min() < _SAME_PLACE_M:
            found[name] = structure.members[int(nearest.argmin())].name
    return found


def _simple(deck: Deck) -> tuple[Strip, Strip]:
    """Return the simple coefficients without and with growth."""
    rows = deck.table_below("SimplCd", 1)
    require(rows, "table is missing", field="SimplCd", remedy="give a HydroDyn input file")
    return _strip(rows[0], "simpl", ""), _strip(rows[0], "simpl", "mg")


def _strip(row: DeckRow, prefix: str, suffix: str) -> Strip:
    cd, ca, cp = row.numbers(*(f"{prefix}{name}{suffix}" for name in ("cd", "ca", "cp")))
    return Strip(cd, ca, cp)


def _of_model(tubes: _Tubes, model: int) -> list[str]:
    return [row["memberid"] for row in tubes.rows if row.get("mcoefmod", "1") == str(model)]


def _names(tubes: _Tubes, ids: list[str], field: str) -> tuple[str, ...]:
    """Return the structure's members that match some of the file's."""
    for one in ids:
        require(
            one in tubes.names,
            "the structure has no such member",
            field=field,
            value=one,
            remedy="give the file of this structure, or its coefficients in the scenario",
        )
    return tuple(tubes.names[one] for one in ids)


def _by_depth(deck: Deck, tubes: _Tubes) -> tuple[StripTable, ...]:
    ids = _of_model(tubes, _BY_DEPTH)
    rows = deck.table("NCoefDpth", "NCoefDpthCyl")
    if not ids:
        return ()
    require(rows, "table is missing", field="NCoefDpth", remedy="give its rows")
    members = () if len(ids) == len(tubes.rows) else _names(tubes, ids, "MCoefMod")
    return (
        StripTable(
            tuple(row.number("dpth") for row in rows),
            tuple(_strip(row, "dpth", "") for row in rows),
            tuple(_strip(row, "dpth", "mg") for row in rows),
            members,
        ),
    )


def _by_member(deck: Deck, tubes: _Tubes) -> tuple[StripTable, ...]:
    """Return tables of single members: coefficients at both ends, interpolated linearly."""
    wanted = _of_model(tubes, _BY_MEMBER)
    rows = {next(iter(row.values())): row for row in deck.table("NCoefMembers", "NCoefMembersCyl")}
    tables = []
    for one in wanted:
        require(one in rows, "member is missing", field="NCoefMembers", value=one)
        heights = tubes.ends[one][:, 2]
        bare, grown = ([_strip(rows[one], "member", f"{mg}{end}") for end in (1, 2)] for mg in ("", "mg"))
        if abs(heights[0] - heights[1]) < 1e-6:  # horizontal: the mean of both ends
            z: tuple[float, ...] = (float(heights[0]),)
            bare, grown = [_mean(bare)], [_mean(grown)]
        else:
            z = (float(heights[0]), float(heights[1]))
        tables.append(StripTable(z, tuple(bare), tuple(grown), _names(tubes, [one], "NCoefMembers")))
    return tuple(tables)


def _mean(strips: list[Strip]) -> Strip:
    drag, added, pressure = np.mean([strip.row() for strip in strips], axis=0)
    return Strip(float(drag), float(added), float(pressure))


def _growth(deck: Deck) -> tuple[GrowthBand, ...]:
    """Return the bands between the heights of the table, from the top."""
    columns = ("mgdpth", "mgthck", "mgdens")
    rows = [row.numbers(*columns) for row in deck.table("NMGDepths")]
    return growth_bands(sorted(((z, thickness, density) for z, thickness, density in rows), reverse=True))


def _ends(deck: Deck) -> EndCoefficients:
    rows = {row["axcoefid"]: row for row in deck.table("NAxCoef")}
    used = {row.get("jointaxid", "1") for row in deck.table("NJoints")}
    found = {tuple(rows[one].numbers("axcp", "axca", "axcd")) for one in used & set(rows)}
    require(
        len(found) <= 1,
        "joints with different axial coefficients",
        field="JointAxID",
        value=sorted(used),
        remedy="give one set, or the rest of the file's coefficients in the scenario",
    )
    pressure, added, drag = found.pop() if found else (0.0, 0.0, 0.0)
    return EndCoefficients(pressure, added, drag)


def _flooded(deck: Deck, tubes: _Tubes, density: float) -> tuple[str, ...]:
    """Return the filled members; a row has a count, members, level and density.

    The count is ignored, since public decks number the groups there.
    """
    ids: list[str] = []
    for row in deck.table("NFillGroups"):
        words = list(takewhile(_is_entry, deck.lines[row.line - 1].split()))
        require(len(words) >= 4, "row is too short", field=row.place("FillMList"), value=" ".join(words))
        level, filling = words[-2:]
        place = row.place("FillFSLoc")
        full = to_float(level, place) >= 0.0
        require(full, "members filled below still water", field=place, value=level)
        if not _is_default(filling):
            place = row.place("FillDens")
            weight = to_float(filling, place)
            require(
                abs(weight / density - 1.0) <= _SAME_DENSITY,
                "members filled with something else than this water",
                field=place,
                value=weight,
                allowed=f"{density:g}",
            )
        ids += words[1:-2]
    return tuple(dict.fromkeys(_names(tubes, ids, "FillMList")))


def _is_default(word: str) -> bool:
    return word.strip('"').lower() == "default"


def _is_entry(word: str) -> bool:
    """Whether a word is a number or a default: what follows is a comment."""
    try:
        float(word)
    except ValueError:
        return _is_default(word)
    return True
