"""SACS model files: JOINT, MEMBER with offsets, GRUP, SECT and joint LOAD cards, in fixed columns.

The columns are those of its manuals and agree with two public programs that read and write them (sacs2abaqus,
Golden Beach) and with two public decks of wind turbines' jackets (OC4, INNWIND). Units follow the OPTIONS
card: EN is feet, inches, ksi, kips and lb/ft³; MN and ME are metres, centimetres, kN/cm², kN (ME: kg) and
t/m³. What is not understood is logged as a warning, never left out silently.
"""

from __future__ import annotations

import logging
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import radians
from pathlib import Path

import numpy as np

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.decks.sacs_sections import NAMES, sacs_section
from jackettwin.errors import InputError, located, require
from jackettwin.structure import (
    Beam,
    BeamSection,
    Material,
    Member,
    PointMass,
    Reaction,
    RigidLink,
    Section,
    Structure,
    Vector,
)

log = logging.getLogger(__name__)
_SILENT = {"END", "LDOPT", "LOADLB", "LCSEL", "LCOMB", "UCPART", "LIVE", "HYDRO", "TITLE"}
"""Cards that hold no structure: combinations, code checks, titles."""
_PINNED = (True, True, True, False, False, False)
_HELD = {"FIXED": (True, True, True, True, True, True), "PINNED": _PINNED, "PILEHD": _PINNED}
"""DOFs that each fixity word fixes at a joint; a pile head is on the supports that are updated."""
_ENVIRONMENT = {"CDM", "MGROV", "GRPOV", "GRPOVA", "WAVE", "WAVE1", "WIND", "CURR", "DEAD", "TIDE", "CENTER"}
"""Cards of the sea, of growth on members and of the self-weight's direction."""
_WEIGHTS = ("WGT", "SURFWT")
"""Prefixes of the cards of weight groups, whose columns are not documented publicly."""
_GLOBAL = "1"
"""In column 7 of a MEMBER card: the offsets on the card behind it are in global axes."""
_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d+)$")
"""Exponents stand without their letter: ``1.64+4`` is 16400."""


@dataclass(frozen=True)
class _Units:
    """Factors to SI: long and short lengths, moduli as written (in thousands), densities, forces to mass."""

    long: float
    short: float
    modulus: float
    density: float
    mass: float


_ENGLISH = _Units(0.3048, 0.0254, 6.894757293e9, 16.01846337, 4448.2216152605 / GRAVITY_M_S2)
_METRIC = {
    "MN": _Units(1.0, 0.01, 1e10, 1000.0, 1000.0 / GRAVITY_M_S2),
    "ME": _Units(1.0, 0.01, 1e7 * GRAVITY_M_S2, 1000.0, 1.0),
}
"""Moduli are in 1000 ksi, 1000 kN/cm² and 1000 kg/cm²."""


@dataclass
class _Part:
    """A length of a group's members, None where it takes the rest: a tube, a cone, or another section."""

    start: Section | BeamSection
    end: Section | BeamSection
    material: Material
    length: float | None
    shape: str = ""


_HERE = (0.0, 0.0, 0.0)


@dataclass
class _Bar:
    """A member between two joints; its ends may lie beside them, by ``shifts`` in the axes of ``code``."""

    a: str
    b: str
    group: str
    code: str = ""
    shifts: tuple[Vector, Vector] | None = None
    twist: float = 0.0
    """Chord angle [rad]: how far the section is turned about the member."""


@dataclass
class _Deck:
    """Contents of the cards of a deck, in SI units."""

    units: _Units = _ENGLISH
    nodes: dict[str, Vector] = field(default_factory=dict)
    held: dict[str, str] = field(default_factory=dict)
    groups: dict[str, list[_Part]] = field(default_factory=dict)
    tubes: dict[str, tuple[Section, Section]] = field(default_factory=dict)
    beams: dict[str, tuple[BeamSection, str]] = field(default_factory=dict)
    shapes: set[str] = field(default_factory=set)
    members: list[_Bar] = field(default_factory=list)
    loads: dict[str, dict[str, float]] = field(default_factory=dict)
    condition: str = ""
    remarks: Counter[str] = field(default_factory=Counter)


def read_sacs(path: Path) -> Structure:
    """Read a SACS model file; what of it is not understood is logged, as ``sacs_remarks`` returns it.

    Raises
    ------
    InputError
        If a card cannot be read, or no member is a tube; names line and columns.
    """
    structure, remarks = _read(path)
    for remark in remarks:
        log.warning("%s: %s", path.name, remark)
    return structure


def is_sacs(path: Path) -> bool:
    """Return whether a file's name is that of a SACS model: ``sacinp.*``, ``*.sacs``, ``*.sacinp``."""
    name = path.name.lower()
    return name.startswith("sacinp") or name.endswith((".sacs", ".sacinp"))


def sacs_remarks(path: Path) -> tuple[str, ...]:
    """Return what of a deck was not understood, each with how often."""
    return _read(path)[1]


def _read(path: Path) -> tuple[Structure, tuple[str, ...]]:
    deck = _cards(path)
    with located(file=path):
        structure = _structure(deck, path.stem)
    remarks = deck.remarks.items()
    return structure, tuple(f"{text} ({n} times)" if n > 1 else text for text, n in remarks)


def _cards(path: Path) -> _Deck:
    deck = _Deck()
    lines = path.read_text(encoding="latin-1").splitlines()
    readers = {"JOINT": _joint, "MEMBER": _member, "GRUP": _group, "SECT": _section, "LOAD": _load}
    for number, line in enumerate(lines, start=1):
        word = line[:6].split(" ")[0].strip() if line[:1].isalpha() else ""
        if not word or word in _SILENT or not line[len(word) :].strip():
            continue
        if word == "OPTION":
            deck.units = _units(line)
        elif word == "LOADCN":
            deck.condition = line[6:10].strip()
        elif word in readers:
            with located(file=path, field=f"line {number}"):
                readers[word](deck, line)
        elif word.split(".")[0] in _ENVIRONMENT:
            deck.remarks["cards of waves, wind, current and marine growth are not read"] += 1
        elif word.startswith(_WEIGHTS):
            deck.remarks[f"{word} cards, weights, are not read: add their mass"] += 1
        else:
            deck.remarks[f"{word} cards are not read"] += 1
    return deck


def _units(line: str) -> _Units:
    words = line[7:20].split()
    return next((_METRIC[word] for word in words if word in _METRIC), _ENGLISH)


def _number(line: str, first: int, last: int, what: str, default: float | None = None) -> float:
    """Return the number in columns ``first`` to ``last``, counted from one."""
    text = line[first - 1 : last].strip()
    if not text and default is not None:
        return default
    try:
        return float(_EXPONENT.sub(r"e\1", text))
    except ValueError:
        raise InputError(
            f"no number for {what} in columns {first} to {last}",
            value=text,
            remedy="check the card's columns",
        ) from None


def _joint(deck: _Deck, line: str) -> None:
    name = line[6:10].strip()
    if len(line) > 54 and line[54:60].strip() in ("PERSET", "ELASTI"):
        deck.remarks[f"joint {name}: {line[54:60].strip()} is not read"] += 1
        return
    long, short = deck.units.long, deck.units.short
    x, y, z = (
        long * _number(line, 12 + 7 * i, 18 + 7 * i, "xyz"[i], 0.0)
        + short * _number(line, 33 + 7 * i, 39 + 7 * i, "xyz"[i], 0.0)
        for i in range(3)
    )
    deck.nodes[name] = (x, y, z)
    if line[54:60].strip():
        deck.held[name] = line[54:60].strip()


def _member(deck: _Deck, line: str) -> None:
    if "OFFSETS" in line[:16]:
        _offsets(deck, line)
        return
    a, b, group = line[7:11].strip(), line[11:15].strip(), line[16:19].strip()
    if "1" in line[22:34]:
        deck.remarks["members' end releases are not read: ends are rigid"] += 1
    if a and b and group:
        twist = radians(_number(line, 36, 41, "chord angle", 0.0))
        deck.members.append(_Bar(a, b, group, line[6:7], twist=twist))


def _offsets(deck: _Deck, line: str) -> None:
    """Keep where the ends of the member before lie beside its joints, in global axes."""
    if not deck.members or deck.members[-1].code != _GLOBAL:
        deck.remarks["member offsets in axes of the member are not read: it runs from joint to joint"] += 1
        return
    xyz = [deck.units.short * _number(line, 36 + 6 * i, 41 + 6 * i, "an offset", 0.0) for i in range(6)]
    deck.members[-1].shifts = (xyz[0], xyz[1], xyz[2]), (xyz[3], xyz[4], xyz[5])


def _group(deck: _Deck, line: str) -> None:
    name, taper, label, u = line[5:8].strip(), line[8:9].strip(), line[9:16].strip(), deck.units
    E = u.modulus * _number(line, 31, 35, "E", 29.0 if u is _ENGLISH else 20.5)
    G = u.modulus * _number(line, 36, 40, "G", 11.6 if u is _ENGLISH else 8.0)
    rho = u.density * _number(line, 71, 76, "density", 490.0 if u is _ENGLISH else 7.849)
    material = Material(E, G, rho)
    length = _number(line, 77, 80, "segment length", 0.0) * u.long or None
    if label and label not in deck.tubes and label not in deck.beams:
        deck.shapes.add(name)
        deck.remarks[f"group {name}: section {label} is no tube of this deck; its members are left out"] += 1
        return
    start: Section | BeamSection
    end: Section | BeamSection
    if label in deck.beams:
        start = end = deck.beams[label][0]
    elif label:
        start, end = deck.tubes[label]
    else:
        start = end = Section(
            u.short * _number(line, 18, 23, "outer diameter"),
            u.short * _number(line, 24, 29, "wall thickness"),
        )
    parts = deck.groups.setdefault(name, [])
    if taper == "E" and parts:  # a pair of cards, B and E, is one cone from the one section to the other
        parts[-1].end = end
    else:
        parts.append(_Part(start, end, material, length, deck.beams.get(label, (None, ""))[1]))


def _section(deck: _Deck, line: str) -> None:
    """Read a tube, a cone whose far end has another diameter, or what is known of another shape."""
    name, shape, u = line[5:12].strip(), line[15:18].strip(), deck.units.short
    if shape not in ("TUB", "CON"):
        other = _other_shape(line, shape, u)
        if other is None:
            deck.remarks[f"section {name}: shape {shape or 'unknown'} is not read"] += 1
        else:
            deck.beams[name] = other, NAMES.get(shape, "any section")
        return
    start = Section(u * _number(line, 50, 55, "A"), u * _number(line, 56, 60, "B"))
    far = u * _number(line, 61, 66, "C", 0.0) if shape == "CON" else 0.0
    deck.tubes[name] = (start, Section(far, start.thickness_m) if far else start)


def _other_shape(line: str, shape: str, unit: float) -> BeamSection | None:
    """Return a section by its properties, or by its sides."""
    area, J, about_y, about_z = (
        _number(line, first, last, what, 0.0)
        for first, last, what in ((19, 24, "AX"), (25, 32, "J"), (33, 40, "IY"), (41, 48, "IZ"))
    )
    a, b, c, d = (
        unit * _number(line, first, last, what, 0.0)
        for first, last, what in ((50, 55, "A"), (56, 60, "B"), (61, 66, "C"), (67, 71, "D"))
    )
    fourth = unit**4
    return sacs_section(shape, (area * unit**2, J * fourth, about_y * fourth, about_z * fourth), (a, b, c, d))


def _load(deck: _Deck, line: str) -> None:
    """Add a joint's downward load in the current load condition; loads on members are only listed."""
    if "JOIN" not in line[60:72]:
        deck.remarks["loads on members are not read as mass"] += 1
        return
    down = -_number(line, 31, 37, "FZ", 0.0)
    if down > 0.0:
        of_joint = deck.loads.setdefault(line[7:11].strip(), {})
        of_joint[deck.condition] = of_joint.get(deck.condition, 0.0) + down


def _masses(deck: _Deck, used: set[str]) -> tuple[PointMass, ...]:
    """Return what pulls joints down as masses.

    The same weight is often repeated in the conditions of several directions: equal forces count once.
    """
    loads = {node: forces for node, forces in deck.loads.items() if node in used}
    found = {node: deck.units.mass * sum(set(forces.values())) for node, forces in loads.items()}
    if found:
        conditions = ", ".join(dict.fromkeys(c for forces in loads.values() for c in forces))
        tonnes = sum(found.values()) / 1000.0
        deck.remarks[
            f"joint loads of {conditions} are taken as {tonnes:.4g} t of mass, equal ones on a joint once: "
            "check it"
        ] += 1
    return tuple(PointMass(node, mass) for node, mass in found.items())


def _structure(deck: _Deck, name: str) -> Structure:
    nodes = dict(deck.nodes)
    members: list[Member | Beam] = []
    links: list[RigidLink] = []
    for bar in deck.members:
        if bar.group in deck.shapes:
            continue
        if bar.group not in deck.groups:
            raise InputError(
                "a member of no group",
                field=f"member {bar.a}-{bar.b}",
                value=bar.group,
                allowed="a GRUP card's",
            )
        ends = _ends(nodes, bar)
        links += [
            RigidLink(joint, end) for joint, end in zip((bar.a, bar.b), ends, strict=True) if joint != end
        ]
        members += _segments(nodes, bar, ends, deck.groups[bar.group])
    require(
        members, "no member of the deck has a section that is read", field="MEMBER", value=len(deck.members)
    )
    used = {node for m in members for node in (m.start, m.end)} | {link.leader for link in links}
    return Structure(
        name=name,
        nodes={node: at for node, at in nodes.items() if node in used},
        members=tuple(m for m in members if isinstance(m, Member)),
        beams=tuple(m for m in members if isinstance(m, Beam)),
        masses=_masses(deck, used),
        rigid_links=tuple(links),
        reactions=tuple(_reactions(deck.held, used)),
    )


def _ends(nodes: dict[str, Vector], bar: _Bar) -> tuple[str, str]:
    """Return the nodes between which a member runs: its joints, or new ones beside them."""
    names = []
    for joint, letter, shift in zip((bar.a, bar.b), "AB", bar.shifts or (_HERE, _HERE), strict=True):
        x, y, z = _place(nodes, joint, bar.a, bar.b)
        names.append(joint if shift == _HERE else f"{bar.a}-{bar.b}:{letter}")
        nodes[names[-1]] = (x + shift[0], y + shift[1], z + shift[2])
    return names[0], names[1]


def _segments(
    nodes: dict[str, Vector], bar: _Bar, ends: tuple[str, str], parts: Sequence[_Part]
) -> Iterable[Member | Beam]:
    """Return a member, cut where its group changes; the segment without a length takes what is left."""
    (a, b), name = ends, f"{bar.a}-{bar.b}"
    start, end = (np.asarray(nodes[node]) for node in ends)
    whole = float(np.linalg.norm(end - start))
    left = whole - sum(part.length or 0.0 for part in parts)
    open_ = sum(part.length is None for part in parts)
    at, previous = 0.0, a
    for i, part in enumerate(parts, start=1):
        at += part.length if part.length is not None else left / open_
        node = b if i == len(parts) else f"{name}.{i}"
        if node != b:
            x, y, z = map(float, start + (end - start) * min(at / whole, 1.0))
            nodes[node] = (x, y, z)
        suffix = f".{i}" if len(parts) > 1 else ""
        own, between = f"{name}{suffix}", (previous, node)
        if isinstance(part.start, Section) and isinstance(part.end, Section):
            yield Member(own, *between, part.start, part.end, part.material, bar.group)
        elif isinstance(part.start, BeamSection):
            yield Beam(own, *between, part.start, part.material, bar.twist, bar.group, part.shape)
        previous = node


def _place(nodes: Mapping[str, Vector], node: str, a: str, b: str) -> Vector:
    require(
        node in nodes, "a member of no joint", field=f"member {a}-{b}", value=node, allowed="a JOINT card's"
    )
    return nodes[node]


def _reactions(held: Mapping[str, str], used: set[str]) -> Iterable[Reaction]:
    for node, word in held.items():
        if node not in used:
            continue
        if word in _HELD:
            yield Reaction(node, _HELD[word])
        elif set(word) <= {"0", "1", "2"} and "1" in word:  # 2: kept in a dynamic analysis, not held
            x, y, z, rx, ry, rz = (c == "1" for c in word.ljust(6, "0"))
            yield Reaction(node, (x, y, z, rx, ry, rz))
