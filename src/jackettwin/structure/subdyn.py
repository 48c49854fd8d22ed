"""Structures from OpenFAST SubDyn input files, old and new.

Tables are found by the keyword of their count line and columns by their header, so the position of
neither matters (formats of SubDyn 0.4 to OpenFAST 5). SubDyn's frame is ours with z = 0 at the mean
sea level.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.files.yaml import read_text
from jackettwin.structure.model import (
    Material,
    Member,
    PointMass,
    Reaction,
    RigidLink,
    Section,
    Structure,
    Vector,
)

_DOFS = ("x", "y", "z", "tx", "ty", "tz")
_UNSUPPORTED = {"2": "cable", "4": "arbitrary section", "5": "spring", "1r": "rectangular section"}
_BEAMS = ("1", "1c", "-1")
_RIGID = "3"
_THEORY = {"1": "euler-bernoulli", "3": "timoshenko"}


@dataclass(frozen=True)
class _Deck:
    """The lines of a file and how to find things in them."""

    path: Path
    lines: tuple[str, ...]

    def find(self, *keywords: str) -> int | None:
        """Return the number of the first line whose second word is one of the keywords."""
        wanted = {keyword.lower() for keyword in keywords}
        for number, line in enumerate(self.lines):
            words = line.split()
            if len(words) > 1 and words[1].lower() in wanted:
                return number
        return None

    def scalar(self, keyword: str, default: str) -> str:
        """Return the value that stands before a keyword."""
        number = self.find(keyword)
        return default if number is None else self.lines[number].split()[0].strip('"')

    def table(self, *keywords: str, required: bool = False) -> list[dict[str, str]]:
        """Return the rows of the table whose count line has one of the keywords; keys are the header's."""
        number = self.find(*keywords)
        if number is None:
            if required:
                raise InputError(
                    "table is missing",
                    file=self.path,
                    field=keywords[0],
                    remedy="give a complete SubDyn input file",
                )
            return []
        count = _integer(self.lines[number].split()[0], self.path, keywords[0])
        header = (
            [word.lower() for word in self.lines[number + 1].split()] if number + 1 < len(self.lines) else []
        )
        rows = []
        for k in range(count):
            at = number + 3 + k
            words = self.lines[at].split() if at < len(self.lines) else []
            if len(words) < min(len(header), 2) or words[0].startswith("---"):
                raise InputError(
                    "table is shorter than its count",
                    file=self.path,
                    field=keywords[0],
                    value=count,
                    remedy="mend the count or the table",
                )
            rows.append(dict(zip(header, words, strict=False)) | {"#": str(at + 1)})
        return rows


def read_subdyn(path: Path) -> Structure:
    """Read a SubDyn input file with its SSI files.

    Raises
    ------
    InputError
        If the file is incomplete, or holds cables, springs, joints with hinges or non-circular sections.
    """
    deck = _Deck(path, tuple(read_text(path, what="SubDyn file").splitlines()))
    nodes = _joints(deck)
    members, links, link_masses = _members(deck, _sections(deck), nodes)
    femmod = deck.scalar("FEMMod", "1")
    if femmod not in _THEORY:
        raise InputError("unsupported beam model", file=path, field="FEMMod", value=femmod, allowed="1, 3")
    with located(file=path):
        return Structure(
            name=path.stem,
            nodes=nodes,
            members=members,
            masses=_masses(deck) + link_masses,
            rigid_links=links,
            reactions=_reactions(deck),
            interface_nodes=tuple(row["ijointid"] for row in deck.table("NInterf")),
            sea_level_z_m=0.0,
            subdivide=max(1, _integer(deck.scalar("NDiv", "1"), path, "NDiv")),
            beam=_THEORY[femmod],
            rotary_inertia=True,
            shear_in_mass=False,
        )


def _joints(deck: _Deck) -> dict[str, Vector]:
    nodes: dict[str, Vector] = {}
    for row in deck.table("NJoints", required=True):
        name = row["jointid"]
        if row.get("jointtype", "1") != "1":
            raise InputError(
                "only cantilever joints are supported",
                file=deck.path,
                field=f"JointID {name}.JointType",
                value=row["jointtype"],
                allowed="1",
            )
        if name in nodes:
            raise InputError("joint is given twice", file=deck.path, field="JointID", value=name)
        x, y, z = (_number(row, key, deck.path) for key in ("jointxss", "jointyss", "jointzss"))
        nodes[name] = (x, y, z)
    return nodes


def _sections(deck: _Deck) -> dict[str, tuple[Section, Material]]:
    sections = {}
    for row in deck.table("NPropSetsCyl", "NPropSets", required=True):
        E, G, rho, D, t = (
            _number(row, key, deck.path) for key in ("younge", "shearg", "matdens", "xsecd", "xsect")
        )
        with located(file=deck.path, field=f"PropSetID {row['propsetid']}"):
            sections[row["propsetid"]] = (Section(D, t), Material(E, G, rho))
    return sections


def _members(
    deck: _Deck, sections: dict[str, tuple[Section, Material]], nodes: dict[str, Vector]
) -> tuple[tuple[Member, ...], tuple[RigidLink, ...], tuple[PointMass, ...]]:
    members, rigid = [], []
    for row in deck.table("NMembers", required=True):
        kind = row.get("mtype", "1").lower()
        name, ends = row["memberid"], (row["mjointid1"], row["mjointid2"])
        for joint in ends:
            if joint not in nodes:
                raise InputError("no such joint", file=deck.path, field=f"MemberID {name}", value=joint)
        if kind == _RIGID:
            rigid.append((ends, row["mpropsetid1"]))
        elif kind in _BEAMS:
            first, last = row["mpropsetid1"], row["mpropsetid2"]
            for key in (first, last):
                if key not in sections:
                    raise InputError(
                        "no such property set", file=deck.path, field=f"MemberID {name}", value=key
                    )
            members.append(Member(name, *ends, sections[first][0], sections[last][0], sections[first][1]))
        else:
            raise InputError(
                f"unsupported member type ({_UNSUPPORTED.get(kind, 'unknown')})",
                file=deck.path,
                field=f"MemberID {name}.MType",
                value=kind,
                allowed="1, 1c (circular beam), 3 (rigid link)",
            )
    return tuple(members), _link_groups(deck, [ends for ends, _ in rigid]), _link_masses(deck, rigid, nodes)


def _link_groups(deck: _Deck, pairs: list[tuple[str, str]]) -> tuple[RigidLink, ...]:
    """Return links from one leader a rigid group to everybody else in it; a reaction joint leads."""
    neighbours: dict[str, set[str]] = defaultdict(set)
    for a, b in pairs:
        neighbours[a].add(b)
        neighbours[b].add(a)
    leaders_first = [row["rjointid"] for row in deck.table("NReact") if row["rjointid"] in neighbours]
    seen: set[str] = set()
    links = []
    for leader in [*leaders_first, *neighbours]:
        if leader in seen:
            continue
        group, stack = {leader}, [leader]
        while stack:
            for joint in neighbours[stack.pop()] - group:
                group.add(joint)
                stack.append(joint)
        seen |= group
        links += [RigidLink(leader, follower) for follower in sorted(group - {leader})]
    return tuple(links)


def _link_masses(
    deck: _Deck, rigid: list[tuple[tuple[str, str], str]], nodes: dict[str, Vector]
) -> tuple[PointMass, ...]:
    """Return half of each rigid link's mass on either end."""
    density = {row["propsetid"]: _number(row, "matdens", deck.path) for row in deck.table("NRigidPropSets")}
    masses = []
    for (a, b), key in rigid:
        half = 0.5 * density.get(key, 0.0) * float(np.linalg.norm(np.subtract(nodes[b], nodes[a])))
        if half > 0.0:
            masses += [PointMass(a, half), PointMass(b, half)]
    return tuple(masses)


def _masses(deck: _Deck) -> tuple[PointMass, ...]:
    bodies = []
    for row in deck.table("NCmass"):
        value = {key: _number(row, key, deck.path) for key in row if key not in ("#", "cmjointid")}
        offset = [value.get(f"mcg{axis}", value.get(f"cg{axis}", 0.0)) for axis in "xyz"]
        inertia = [value.get(f"jm{axes}", 0.0) for axes in ("xx", "yy", "zz", "xy", "xz", "yz")]
        xx, yy, zz, xy, xz, yz = inertia
        place = (offset[0], offset[1], offset[2])
        with located(file=deck.path, field=f"CMJointID {row['cmjointid']}"):
            bodies.append(PointMass(row["cmjointid"], value["jmass"], place, (xx, yy, zz, xy, xz, yz)))
    return tuple(bodies)


def _reactions(deck: _Deck) -> tuple[Reaction, ...]:
    reactions = []
    for row in deck.table("NReact"):
        flags = [
            row.get(key, "1")
            for key in ("rcttdxss", "rcttdyss", "rcttdzss", "rctrdxss", "rctrdyss", "rctrdzss")
        ]
        x, y, z, rx, ry, rz = (flag not in ("0", "0.0") for flag in flags)
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
    for number, line in enumerate(read_text(path, what="SSI file").splitlines(), start=1):
        words = line.split()
        if line.lstrip().startswith("!") or len(words) < 2:
            continue
        match = re.fullmatch(r"([km])(t?[xyz])(t?[xyz])", words[1].lower())
        if match is None:
            raise InputError(
                "unknown SSI element",
                file=path,
                field=f"line {number}",
                value=words[1],
                allowed="Kxx … Ktztz, Mxx … Mtztz",
            )
        kind, a, b = match.groups()
        value = _to_float(words[0], path, f"line {number}")
        matrices[kind][order[a], order[b]] = matrices[kind][order[b], order[a]] = value
    as_tuple = {
        kind: tuple(tuple(float(v) for v in row) for row in matrix) if matrix.any() else None
        for kind, matrix in matrices.items()
    }
    return as_tuple["k"], as_tuple["m"]


def _number(row: dict[str, str], key: str, path: Path) -> float:
    if key not in row:
        raise InputError("column is missing", file=path, field=f"line {row['#']}.{key}")
    return _to_float(row[key], path, f"line {row['#']}.{key}")


def _to_float(word: str, path: Path, field: str) -> float:
    try:
        value = float(word.lower().replace("d", "e").rstrip(","))
    except ValueError:
        raise InputError("not a number", file=path, field=field, value=word) from None
    if not np.isfinite(value):
        raise InputError("not a finite number", file=path, field=field, value=word)
    return value


def _integer(word: str, path: Path, field: str) -> int:
    value = _to_float(word, path, field)
    if value != int(value) or value < 0:
        raise InputError("not a count", file=path, field=field, value=word, allowed="a whole number ≥ 0")
    return int(value)
