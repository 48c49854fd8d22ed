"""Structures from OpenFAST SubDyn input files, old and new, with their SSI files, and the damping they state.

SubDyn's frame is ours with z = 0 at the mean sea level.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast import Deck, read_deck, to_float, to_integer
from jackettwin.decks.subdyn_members import read_parts
from jackettwin.errors import InputError, located, require
from jackettwin.structure import PointMass, Reaction, Structure

_DOFS = ("x", "y", "z", "tx", "ty", "tz")
_FLAGS = ("tdxss", "tdyss", "tdzss", "rdxss", "rdyss", "rdzss")
_THEORY = {"1": "euler-bernoulli", "3": "timoshenko"}
_NO_DAMPING, _RAYLEIGH, _MATRIX = "0", "1", "2"


def read_subdyn(path: Path) -> Structure:
    """Read a SubDyn input file with its SSI files.

    Raises
    ------
    InputError
        If the file is incomplete, or holds what has no equal here: universal joints, several transition
        pieces.
    """
    deck = read_deck(path)
    with located(file=path):
        theory = deck.scalar("FEMMod", "1")
        require(theory in _THEORY, "unsupported beam model", field="FEMMod", value=theory, allowed="1, 3")
        divisions = max(1, to_integer(deck.scalar("NDiv", "1"), "NDiv"))
        parts = read_parts(deck, divisions=divisions)
        return Structure(
            name=path.stem,
            nodes=parts.nodes,
            members=tuple(parts.members),
            masses=_masses(deck),
            rigid_links=tuple(parts.links),
            reactions=_reactions(deck),
            interface_nodes=_interface(deck),
            sea_level_z_m=0.0,
            subdivide=divisions,
            beam=_THEORY[theory],
            rotary_inertia=True,
            shear_in_mass=False,
            elements=tuple(parts.elements),
            beams=tuple(parts.beams),
        )


def _interface(deck: Deck) -> tuple[str, ...]:
    keys = ("ijointid", *(f"itf{key}" for key in _FLAGS))
    rows = deck.table("NInterf", columns=keys[:1], optional=keys[1:] + ("tpid",))
    if any("tpid" in row for row in rows):
        # OpenFAST 5 has the transition piece before the flags, one number more
        rows = deck.table("NInterf", columns=keys[:1], optional=("tpid", *keys[1:]))
    for row in rows:
        place, piece = f"IJointID {row['ijointid']}", row.get("tpid", "1")
        require(
            all(row.flag(key, default=True) for key in keys[1:]),
            "an interface joint must be locked to the transition piece in all six motions",
            field=place,
            value=[row.get(key, "1") for key in keys[1:]],
        )
        require(
            piece == rows[0].get("tpid", "1"),
            "several transition pieces",
            field=f"{place}.TPID",
            value=piece,
            remedy="give the joints of one transition piece",
        )
    return tuple(row["ijointid"] for row in rows)


def _masses(deck: Deck) -> tuple[PointMass, ...]:
    bodies = []
    needed = ("jmass", *(f"jm{axes}" for axes in ("xx", "yy", "zz")))
    more = (*(f"jm{axes}" for axes in ("xy", "xz", "yz")), *(f"mcg{axis}" for axis in "xyz"))
    for row in deck.table("NCmass", columns=("cmjointid", *needed), optional=more):
        mass, xx, yy, zz = row.numbers(*needed)
        xy, xz, yz, x, y, z = (row.number(key, 0.0) for key in more)
        with located(field=f"CMJointID {row['cmjointid']}"):
            bodies.append(PointMass(row["cmjointid"], mass, (x, y, z), (xx, yy, zz, xy, xz, yz)))
    return tuple(bodies)


def _reactions(deck: Deck) -> tuple[Reaction, ...]:
    reactions = []
    keys = tuple(f"rct{key}" for key in _FLAGS)
    for row in deck.table("NReact", columns=("rjointid",), optional=(*keys, "ssifile")):
        x, y, z, rx, ry, rz = (row.flag(key, default=True) for key in keys)
        ssi = row.get("ssifile", "").strip("\"'")
        is_file = bool(ssi) and not ssi.startswith(("!", "-", "#"))
        stiffness, mass = _read_ssi(deck.path.parent / ssi) if is_file else (None, None)
        reactions.append(Reaction(row["rjointid"], (x, y, z, rx, ry, rz), stiffness, mass))
    return tuple(reactions)


Matrix = tuple[tuple[float, ...], ...]


def _read_ssi(path: Path) -> tuple[Matrix | None, Matrix | None]:
    """Return the 6×6 pile-head stiffness and mass of an SSI file (``1E9 Kzz`` a line)."""
    matrices = {"k": np.zeros((6, 6)), "m": np.zeros((6, 6))}
    for at, line in enumerate(read_deck(path, "SSI file").lines, start=1):
        words = line.split()
        if line.lstrip().startswith("!") or len(words) < 2:
            continue
        with located(file=path, field=f"line {at}"):
            match = re.fullmatch(r"([km])(t?[xyz])(t?[xyz])", words[1].lower())
            if match is None:
                raise InputError("unknown SSI element", value=words[1], allowed="Kxx … Ktztz, Mxx … Mtztz")
            i, j = (_DOFS.index(dof) for dof in match.groups()[1:])
            matrix = matrices[match[1]]
            matrix[i, j] = matrix[j, i] = to_float(words[0], "")
    stiffness, mass = (
        tuple(tuple(float(v) for v in row) for row in matrix) if matrix.any() else None
        for matrix in matrices.values()
    )
    return stiffness, mass


@dataclass(frozen=True)
class DeckDamping:
    """Damping that a deck states beside its matrices: JDampings, and what GuyanDampMod chooses.

    Attributes
    ----------
    modal : damping ratios of the internal modes; the last counts for all that follow
    alpha, beta : Rayleigh factors of the interface's six coordinates
    interface : (6, 6) damping of the interface [N·s/m, N·s, N·m·s]
    """

    modal: tuple[float, ...]
    alpha: float
    beta: float
    interface: FloatArray

    def ratios(self, number: int) -> FloatArray:
        """Return the damping ratio of the first internal modes."""
        given = self.modal or (0.0,)
        return np.array([given[min(k, len(given) - 1)] for k in range(number)])


def read_deck_damping(path: Path) -> DeckDamping:
    """Read how a SubDyn input file damps its reduced matrices.

    Raises
    ------
    InputError
        If it is none of SubDyn's ways, or incomplete.
    """
    deck = read_deck(path)
    with located(file=path):
        kind, known = deck.scalar("GuyanDampMod", _NO_DAMPING), (_NO_DAMPING, _RAYLEIGH, _MATRIX)
        told = {"field": "GuyanDampMod", "value": kind, "allowed": ", ".join(known)}
        require(kind in known, "unknown damping of the interface", **told)
        factors = deck.numbers("RayleighDamp") if kind == _RAYLEIGH else (0.0, 0.0)
        told = {"field": "RayleighDamp", "value": str(list(factors)), "allowed": "α, β"}
        require(len(factors) == 2, "two factors are needed", **told)
        alpha, beta = factors
        return DeckDamping(
            modal=tuple(0.01 * percent for percent in deck.numbers("JDampings")),
            alpha=alpha,
            beta=beta,
            interface=_interface_damping(deck) if kind == _MATRIX else np.zeros((6, 6)),
        )


def _interface_damping(deck: Deck) -> FloatArray:
    at = deck.find("GuyanDampSize")
    lines = () if at is None else deck.lines[at + 1 : at + 7]
    rows = [line.replace(",", " ").split()[:6] for line in lines]
    require(
        [len(row) for row in rows] == [6] * 6,
        "a 6×6 matrix is needed",
        field="GuyanDampSize",
        remedy="write six rows of six numbers below it",
    )
    return np.array([[to_float(word, "Guyan damping matrix") for word in row] for row in rows])
