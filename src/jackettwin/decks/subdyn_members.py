"""Members of a SubDyn deck: tubes, beams of any section, cables, springs, rigid links, joints that turn.

SubDyn's local axes have z along the member; its x and y are our y and z.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast import Deck, DeckRow, to_float
from jackettwin.decks.subdyn_joints import link_groups, member_ends, member_rows, read_joints, with_hinges
from jackettwin.errors import InputError, located, look_up, require
from jackettwin.structure import (
    Beam,
    BeamSection,
    Material,
    Member,
    RigidLink,
    Section,
    TwoNodeElement,
    Vector,
    rectangular_section,
    spring_matrix,
    two_node_element,
)
from jackettwin.structure.mesh import beam_axes
from jackettwin.structure.two_node import bar_mass, cable_matrices

_TUBE, _RECTANGLE, _CABLE, _RIGID, _ARBITRARY, _SPRING = ("1", "1c"), "1r", "2", "3", "4", "5"
_BEAMS = (*_TUBE, _RECTANGLE, _ARBITRARY)
_REFUSED = {"-1": "rectangular section by its older number"}
_RECTANGLE_KEYS = ("younge", "shearg", "matdens", "xsecsa", "xsecsb", "xsect")
_TUBE_KEYS = ("younge", "shearg", "matdens", "xsecd", "xsect")
_ARBITRARY_KEYS = (
    "younge", "shearg", "matdens", "xseca", "xsecasx", "xsecasy", "xsecjxx", "xsecjyy", "xsecj0",
)  # fmt: skip
_SPRING_KEYS = tuple(f"k{i}{j}" for i in range(1, 7) for j in range(i, 7))


@dataclass
class Parts:
    """Nodes, members, other elements and links of a deck, while they are read."""

    nodes: dict[str, Vector]
    members: list[Member] = field(default_factory=list)
    beams: list[Beam] = field(default_factory=list)
    elements: list[TwoNodeElement] = field(default_factory=list)
    links: list[RigidLink] = field(default_factory=list)


def read_parts(deck: Deck, *, divisions: int) -> Parts:
    """Return nodes, tubes, beams, other elements and links of a deck.

    Raises
    ------
    InputError
        If a member is of a kind that cannot be read, or names what is not there.
    """
    rows = member_rows(deck)
    nodes = read_joints(deck)
    beams = [row["memberid"] for row in rows if _kind(row) in _BEAMS]
    nodes, ends, links, springs = with_hinges(deck, nodes, member_ends(deck, nodes), beams)
    pieces = {row["memberid"]: _pieces(row, nodes, ends, divisions) for row in rows}
    parts = Parts(nodes, elements=springs, links=links)
    tables = _tables(deck)
    rigid = []
    for row in rows:
        kind, name = _kind(row), row["memberid"]
        start, end = ends[name]
        own = None if pieces[name] == divisions else pieces[name]
        if kind in _TUBE:
            parts.members.append(_tube(tables, row, (start, end), own))
        elif kind in (_RECTANGLE, _ARBITRARY):
            parts.beams.append(_beam(parts, tables, row, (start, end), own))
        elif kind == _CABLE:
            parts.elements.append(_cable(parts, tables, row, (start, end)))
        elif kind == _SPRING:
            parts.elements.append(_spring(parts, tables, row, (start, end)))
        elif kind == _RIGID:
            rigid.append((start, end))
            parts.elements += _rigid_mass(parts, tables, row, (start, end))
        else:
            raise _unsupported(row, kind)
    parts.links += link_groups(deck, rigid)
    return parts


def _kind(row: DeckRow) -> str:
    return row.get("mtype", "1").lower().strip("\"'")


def _unsupported(row: DeckRow, kind: str) -> InputError:
    return InputError(
        f"unsupported member type ({_REFUSED.get(kind, 'unknown')})",
        field=f"MemberID {row['memberid']}.MType",
        value=kind,
        allowed="1, 1c (circular beam), 1r (rectangle), 2 (cable), 3 (rigid link), 4 (any beam), 5 (spring)",
        remedy="give a rectangular section as 1r",
    )


Tables = dict[str, dict[str, DeckRow]]
"""Property sets of a deck by number, of each of the tables below."""
_TABLES: dict[str, tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]] = {
    "tube": (("NPropSetsCyl", "NPropSets"), _TUBE_KEYS, ()),
    "any": (("NXPropSets",), _ARBITRARY_KEYS, ("xsecjt",)),
    "cable": (("NCablePropSets",), ("ea", "matdens", "t0"), ()),
    "rigid": (("NRigidPropSets",), ("matdens",), ()),
    "spring": (("NSpringPropSets",), _SPRING_KEYS, ()),
    "cosines": (("NCOSMs",), tuple(f"cosm{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), ()),
}
"""Keywords of the count line, columns behind the number, and those of newer formats."""


def _tables(deck: Deck) -> Tables:
    rows = {
        name: deck.table(*keywords, columns=("propsetid", *columns), optional=more)
        for name, (keywords, columns, more) in _TABLES.items()
    }
    # OpenFAST 4 gave both tables of sections one keyword
    keyword, nth = ("NPropSetsRec", 0) if deck.find("NPropSetsRec") is not None else ("NPropSets", 1)
    rows["rectangle"] = deck.table(keyword, columns=("propsetid", *_RECTANGLE_KEYS), nth=nth)
    return {name: {row["propsetid"]: row for row in table} for name, table in rows.items()}


def _properties(tables: Tables, name: str, row: DeckRow, key: str = "mpropsetid1") -> DeckRow:
    """Return the property set that a member names."""
    return look_up(tables[name], row[key], "property set", field=f"MemberID {row['memberid']}")


def _pieces(row: DeckRow, nodes: dict[str, Vector], ends: dict[str, tuple[str, str]], divisions: int) -> int:
    """Return how many elements a beam has: MDivSize overrides NDiv."""
    size = row.get("mdivsize", "")
    if _kind(row) not in _BEAMS or not size[:1].isdigit():
        return divisions
    start, end = ends[row["memberid"]]
    length = float(np.linalg.norm(np.subtract(nodes[end], nodes[start])))
    longest = to_float(size, row.place("MDivSize"))
    return divisions if longest == 0.0 else ceil(length / longest - 1e-9)


def _tube(tables: Tables, row: DeckRow, ends: tuple[str, str], elements: int | None) -> Member:
    name = row["memberid"]
    sections, materials = [], []
    for key in ("mpropsetid1", "mpropsetid2"):
        E, G, rho, D, t = _properties(tables, "tube", row, key).numbers(*_TUBE_KEYS)
        with located(field=f"PropSetID {row[key]}"):
            # SubDyn takes a wall of zero as solid
            sections.append(Section(D, t or 0.5 * D))
            materials.append(Material(E, G, rho))
    require(
        materials[0] == materials[1],
        "E, G and density must be the same at both ends of a member",
        field=f"MemberID {name}",
        value=[row["mpropsetid1"], row["mpropsetid2"]],
    )
    return Member(name, *ends, sections[0], sections[1], materials[0], elements=elements)


def _beam(parts: Parts, tables: Tables, row: DeckRow, ends: tuple[str, str], elements: int | None) -> Beam:
    """Return a beam of any section; both ends must name one property set."""
    name, shape = row["memberid"], "rectangle" if _kind(row) == _RECTANGLE else "any section"
    sets = [row["mpropsetid1"], row["mpropsetid2"]]
    place = f"MemberID {name}"
    require(sets[0] == sets[1], "such a section cannot change along a member", field=place, value=sets)
    (E, G, rho), section = _rectangle(tables, row) if shape == "rectangle" else _any_section(tables, row)
    with located(field=f"PropSetID {sets[0]}"):
        material = Material(E, G, rho)
    twist = _twist(parts, _axes(parts, tables, row, ends), ends)
    return Beam(name, *ends, section, material, twist, shape=shape, elements=elements)


def _twist(parts: Parts, axes: FloatArray, ends: tuple[str, str]) -> float:
    """Return by how much a section is turned from our own axes about the beam [rad]."""
    start, end = (np.array(parts.nodes[node]) for node in ends)
    _, y, z = beam_axes(start, end, 0.0)
    return float(np.arctan2(axes[1] @ z, axes[1] @ y))


def _any_section(tables: Tables, row: DeckRow) -> tuple[list[float], BeamSection]:
    """Return E, G, ρ and the section of an arbitrary beam."""
    p = _properties(tables, "any", row)
    E, G, rho, A, A_x, A_y, I_x, I_y, I_p = p.numbers(*_ARBITRARY_KEYS)
    # decks before OpenFAST 4.1 have one number for inertia and torsion
    J = p.number("xsecjt", I_p)
    return [E, G, rho], BeamSection(A, A_x, A_y, I_x, I_y, I_p, J)


def _rectangle(tables: Tables, row: DeckRow) -> tuple[list[float], BeamSection]:
    """Return E, G, ρ and the section of a rectangular beam."""
    E, G, rho, a, b, t = _properties(tables, "rectangle", row).numbers(*_RECTANGLE_KEYS)
    with located(field=f"PropSetID {row['mpropsetid1']}"):
        return [E, G, rho], rectangular_section(a, b, t, poisson_ratio=0.5 * E / G - 1.0)


def _axes(parts: Parts, tables: Tables, row: DeckRow, ends: tuple[str, str]) -> FloatArray:
    """Return (3, 3): along the member, then the section's x and y, in rows."""
    spin, chosen = row.get("mspin/cosmid", row.get("cosmid/mspin", "0")), row.get("cosmid", "-1")
    if chosen != "-1" and chosen in tables["cosines"]:
        keys = [f"cosm{i}{j}" for i in (3, 1, 2) for j in (1, 2, 3)]
        return np.array(tables["cosines"][chosen].numbers(*keys)).reshape(3, 3)
    a, b = (np.array(parts.nodes[node]) for node in ends)
    return deck_axes(a, b, 0.0 if "cosmid" in row else to_float(spin, row.place("MSpin")))


def deck_axes(a: FloatArray, b: FloatArray, spin_deg: float) -> FloatArray:
    """Return SubDyn's axes of a member from a to b, (3, 3): along it, then its section's x and y, in rows."""
    z = (b - a) / np.linalg.norm(b - a)
    level = float(np.hypot(z[0], z[1]))
    x = np.array([z[1], -z[0], 0.0]) / level if level > 0.0 else np.array([1.0, 0.0, 0.0])
    y = np.cross(z, x)
    angle = np.radians(spin_deg)
    return np.array([z, np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x])


def _cable(parts: Parts, tables: Tables, row: DeckRow, ends: tuple[str, str]) -> TwoNodeElement:
    EA, rho, T = _properties(tables, "cable", row).numbers("ea", "matdens", "t0")
    a, b = (np.array(parts.nodes[node]) for node in ends)
    K, M = cable_matrices(a, b, EA=EA, tension=T, mass_per_m=rho)
    return two_node_element(row["memberid"], "cable", ends, K, M)


def _spring(parts: Parts, tables: Tables, row: DeckRow, ends: tuple[str, str]) -> TwoNodeElement:
    k = np.zeros((6, 6))
    k[np.triu_indices(6)] = _properties(tables, "spring", row).numbers(*_SPRING_KEYS)
    k = k + np.triu(k, 1).T
    chosen = row.get("cosmid", row.get("mspin/cosmid", row.get("cosmid/mspin", "-1")))
    apart = np.linalg.norm(np.subtract(parts.nodes[ends[1]], parts.nodes[ends[0]])) > 0.0
    require(
        chosen in tables["cosines"] or apart,
        "a spring between joints at one place needs its axes",
        field=f"MemberID {row['memberid']}.COSMID",
        value=chosen,
        allowed=", ".join(tables["cosines"]) or None,
        remedy="give a cosine matrix",
    )
    axes = _axes(parts, tables, DeckRow({**row, "cosmid": chosen}, row.line), ends)
    # a spring's own order is x, y, z with z along it
    return two_node_element(row["memberid"], "spring", ends, spring_matrix(k, np.roll(axes, -1, axis=0)))


def _rigid_mass(parts: Parts, tables: Tables, row: DeckRow, ends: tuple[str, str]) -> list[TwoNodeElement]:
    p = tables["rigid"].get(row["mpropsetid1"])
    density = p.number("matdens") if p else 0.0
    if density == 0.0:
        return []
    a, b = (np.array(parts.nodes[node]) for node in ends)
    M = bar_mass(a, b, mass=density * float(np.linalg.norm(b - a)))
    return [two_node_element(row["memberid"], "rigid link", ends, np.zeros((12, 12)), M)]
