"""Structures from OpenFAST SubDyn input files, old and new, with their SSI files.

SubDyn's frame is ours with z = 0 at the mean sea level.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from jackettwin.decks.openfast_tables import Deck, SubdynRow, flag, number, read_deck, to_float, to_integer
from jackettwin.decks.subdyn_members import read_parts
from jackettwin.errors import InputError, located
from jackettwin.files.yaml import read_text
from jackettwin.structure import Structure
from jackettwin.structure.model import PointMass, Reaction

_DOFS = ("x", "y", "z", "tx", "ty", "tz")
_FLAGS = ("tdxss", "tdyss", "tdzss", "rdxss", "rdyss", "rdzss")
_THEORY = {"1": "euler-bernoulli", "3": "timoshenko"}


def read_subdyn(path: Path) -> Structure:
    """Read a SubDyn input file with its SSI files.

    Raises
    ------
    InputError
        If the file is incomplete, or holds what has no equal here: universal joints, several transition
        pieces.
    """
    deck = read_deck(path)
    femmod = deck.scalar("FEMMod", "1")
    if femmod not in _THEORY:
        raise InputError("unsupported beam model", file=path, field="FEMMod", value=femmod, allowed="1, 3")
    divisions = max(1, to_integer(deck.scalar("NDiv", "1"), path, "NDiv"))
    parts = read_parts(deck, divisions=divisions, shear=femmod == "3")
    with located(file=path):
        return Structure(
            name=path.stem,
            nodes=parts.nodes,
            members=tuple(parts.members),
            masses=_masses(deck),
            rigid_links=tuple(parts.links),
            reactions=_reactions(deck),
            interface_nodes=_interface(deck),
            sea_level_z_m=0.0,
            subdivide=parts.subdivide,
            beam=_THEORY[femmod],
            rotary_inertia=True,
            shear_in_mass=False,
            elements=tuple(parts.elements),
        )


def _interface(deck: Deck) -> tuple[str, ...]:
    keys = ("ijointid", *(f"itf{key}" for key in _FLAGS))
    rows = deck.table("NInterf", columns=keys[:1], optional=keys[1:] + ("tpid",))
    if any("tpid" in row for row in rows):
        # OpenFAST 5 has the transition piece before the flags, one number more
        rows = deck.table("NInterf", columns=keys[:1], optional=("tpid", *keys[1:]))
    for row in rows:
        if not all(flag(row, key, deck.path, default=True) for key in keys[1:]):
            raise InputError(
                "an interface joint must be locked to the transition piece in all six motions",
                file=deck.path,
                field=f"IJointID {row['ijointid']}",
                value=[row.get(key, "1") for key in keys[1:]],
            )
        if row.get("tpid", "1") != rows[0].get("tpid", "1"):
            raise InputError(
                "several transition pieces",
                file=deck.path,
                field=f"IJointID {row['ijointid']}.TPID",
                value=row["tpid"],
                remedy="give the joints of one transition piece",
            )
    return tuple(row["ijointid"] for row in rows)


def _masses(deck: Deck) -> tuple[PointMass, ...]:
    bodies = []
    inertias = tuple(f"jm{axes}" for axes in ("xx", "yy", "zz"))
    more = (*(f"jm{axes}" for axes in ("xy", "xz", "yz")), *(f"mcg{axis}" for axis in "xyz"))
    for row in deck.table("NCmass", columns=("cmjointid", "jmass", *inertias), optional=more):
        mass, xx, yy, zz = (number(row, key, deck.path) for key in ("jmass", "jmxx", "jmyy", "jmzz"))
        xy, xz, yz = (_optional(row, f"jm{axes}", deck) for axes in ("xy", "xz", "yz"))
        x, y, z = (_optional(row, f"mcg{axis}", deck) for axis in "xyz")
        with located(file=deck.path, field=f"CMJointID {row['cmjointid']}"):
            bodies.append(PointMass(row["cmjointid"], mass, (x, y, z), (xx, yy, zz, xy, xz, yz)))
    return tuple(bodies)


def _optional(row: SubdynRow, key: str, deck: Deck) -> float:
    """Return the number in a column that older formats do not have."""
    return number(row, key, deck.path) if key in row else 0.0


def _reactions(deck: Deck) -> tuple[Reaction, ...]:
    reactions = []
    keys = tuple(f"rct{key}" for key in _FLAGS)
    for row in deck.table("NReact", columns=("rjointid",), optional=(*keys, "ssifile")):
        x, y, z, rx, ry, rz = (flag(row, key, deck.path, default=True) for key in keys)
        ssi = row.get("ssifile", "").strip("\"'")
        stiffness, mass = _read_ssi(deck.path.parent / ssi) if _is_file_name(ssi) else (None, None)
        reactions.append(Reaction(row["rjointid"], (x, y, z, rx, ry, rz), stiffness, mass))
    return tuple(reactions)


def _is_file_name(word: str) -> bool:
    return bool(word) and not word.startswith(("!", "-", "#"))


Matrix = tuple[tuple[float, ...], ...]


def _read_ssi(path: Path) -> tuple[Matrix | None, Matrix | None]:
    """Return the 6×6 pile-head stiffness and mass of an SSI file (``1E9 Kzz`` a line)."""
    matrices = {"k": np.zeros((6, 6)), "m": np.zeros((6, 6))}
    order = {dof: i for i, dof in enumerate(_DOFS)}
    for at, line in enumerate(read_text(path, what="SSI file").splitlines(), start=1):
        words = line.split()
        if line.lstrip().startswith("!") or len(words) < 2:
            continue
        match = re.fullmatch(r"([km])(t?[xyz])(t?[xyz])", words[1].lower())
        if match is None:
            raise InputError(
                "unknown SSI element",
                file=path,
                field=f"line {at}",
                value=words[1],
                allowed="Kxx … Ktztz, Mxx … Mtztz",
            )
        kind, a, b = match.groups()
        value = to_float(words[0], path, f"line {at}")
        matrices[kind][order[a], order[b]] = matrices[kind][order[b], order[a]] = value
    as_tuple = {
        kind: tuple(tuple(float(v) for v in row) for row in matrix) if matrix.any() else None
        for kind, matrix in matrices.items()
    }
    return as_tuple["k"], as_tuple["m"]
