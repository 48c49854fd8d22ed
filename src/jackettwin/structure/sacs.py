"""SACS model files: JOINT, MEMBER, GRUP, SECT and joint LOAD cards, in the fixed columns of its manuals.

Units follow the OPTIONS card: EN is feet, inches, ksi, kips and lb/ft³; MN and ME are metres, centimetres,
kN/cm², kN (ME: kg) and t/m³. What is not understood is kept as a list, never left out silently.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.structure.model import Material, Member, PointMass, Reaction, Section, Structure

_G = 9.80665
_SILENT = {"END", "LDOPT", "LOADLB", "LCSEL", "LCOMB", "UCPART", "LIVE", "HYDRO", "TITLE"}
"""Cards that hold no structure: combinations, code checks, titles."""
_PINNED = (True, True, True, False, False, False)
_HELD = {"FIXED": (True, True, True, True, True, True), "PINNED": _PINNED, "PILEHD": _PINNED}
"""Words for what holds a joint; a pile head is held by the supports that are updated."""
_TUBE = "TUB"


@dataclass(frozen=True)
class _Units:
    """Factors to SI: long and short lengths, moduli as written (in thousands), densities, forces to mass."""

    long: float
    short: float
    modulus: float
    density: float
    mass: float


_ENGLISH = _Units(0.3048, 0.0254, 6.894757293e9, 16.01846337, 4448.2216152605 / _G)
_METRIC = {
    "MN": _Units(1.0, 0.01, 1e10, 1000.0, 1000.0 / _G),
    "ME": _Units(1.0, 0.01, 9.80665e7, 1000.0, 1.0),
}
"""Moduli are in 1000 ksi, 1000 kN/cm² and 1000 kg/cm²."""


@dataclass
class _Deck:
    """What the cards of a deck say, in SI units."""

    units: _Units = _ENGLISH
    nodes: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    held: dict[str, str] = field(default_factory=dict)
    groups: dict[str, list[tuple[Section, Material, float | None]]] = field(default_factory=dict)
    tubes: dict[str, Section] = field(default_factory=dict)
    shapes: set[str] = field(default_factory=set)
    members: list[tuple[str, str, str]] = field(default_factory=list)
    masses: dict[str, float] = field(default_factory=dict)
    remarks: Counter[str] = field(default_factory=Counter)


def read_sacs(path: Path) -> Structure:
    """Read a SACS model file; ``sacs_remarks`` says what of it was not understood.

    Raises
    ------
    InputError
        If a card cannot be read, or no member is a tube; names line and columns.
    """
    deck = _cards(path)
    with located(file=path):
        return _structure(deck, path.stem)


def is_sacs(path: Path) -> bool:
    """Return whether a file's name is that of a SACS model: ``sacinp.*``, ``*.sacs``, ``*.sacinp``."""
    name = path.name.lower()
    return name.startswith("sacinp") or name.endswith((".sacs", ".sacinp"))


def sacs_remarks(path: Path) -> tuple[str, ...]:
    """Return what of a deck was not understood, each with how often."""
    deck = _cards(path)
    with located(file=path):
        _structure(deck, path.stem)
    return tuple(f"{text} ({n} times)" if n > 1 else text for text, n in deck.remarks.items())


def _cards(path: Path) -> _Deck:
    deck = _Deck()
    lines = path.read_text(encoding="latin-1").splitlines()
    readers = {"JOINT": _joint, "MEMBER": _member, "GRUP": _group, "SECT": _section, "LOAD": _load}
    for number, line in enumerate(lines, start=1):
        word = line[:6].split(" ")[0].strip() if line[:1].isalpha() else ""
        word = "LOADCN" if line.startswith("LOADCN") else word
        if not word or word in _SILENT or not line[len(word) :].strip():
            continue
        if word == "OPTIONS"[:6]:
            deck.units = _units(line)
        elif word in readers:
            with located(file=path, field=f"line {number}"):
                readers[word](deck, line)
        elif word != "LOADCN":
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
        return float(text)
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
        deck.remarks["member offsets are not read: members run from joint to joint"] += 1
        return
    a, b, group = line[7:11].strip(), line[11:15].strip(), line[16:19].strip()
    if a and b and group:
        deck.members.append((a, b, group))


def _group(deck: _Deck, line: str) -> None:
    name, label, u = line[5:8].strip(), line[9:16].strip(), deck.units
    E = u.modulus * _number(line, 31, 35, "E", 29.0 if u is _ENGLISH else 20.5)
    G = u.modulus * _number(line, 36, 40, "G", 11.6 if u is _ENGLISH else 8.0)
    rho = u.density * _number(line, 71, 76, "density", 490.0 if u is _ENGLISH else 7.849)
    material = Material(E, G, rho)
    length = _number(line, 77, 80, "segment length", 0.0) * u.long or None
    if label and label not in deck.tubes:
        deck.shapes.add(name)
        deck.remarks[f"group {name}: section {label} is no tube of this deck; its members are left out"] += 1
        return
    section = (
        deck.tubes[label]
        if label
        else Section(
            u.short * _number(line, 18, 23, "outer diameter"),
            u.short * _number(line, 25, 29, "wall thickness"),
        )
    )
    deck.groups.setdefault(name, []).append((section, material, length))


def _section(deck: _Deck, line: str) -> None:
    name, shape, u = line[5:12].strip(), line[15:18].strip(), deck.units.short
    if shape == _TUBE:
        deck.tubes[name] = Section(u * _number(line, 50, 55, "A"), u * _number(line, 56, 60, "B"))
    else:
        deck.remarks[f"section {name}: shape {shape or 'unknown'} is not read"] += 1


def _load(deck: _Deck, line: str) -> None:
    """Take what a joint load pulls down as mass; loads on members are listed."""
    if "JOIN" not in line[60:72]:
        deck.remarks["LOAD on members is not read as mass"] += 1
        return
    down = -_number(line, 31, 37, "FZ", 0.0)
    if down > 0.0:
        node = line[7:11].strip()
        deck.masses[node] = deck.masses.get(node, 0.0) + down * deck.units.mass


def _structure(deck: _Deck, name: str) -> Structure:
    nodes = dict(deck.nodes)
    members: list[Member] = []
    for a, b, group in deck.members:
        if group in deck.shapes:
            continue
        if group not in deck.groups:
            raise InputError(
                "a member of no group", field=f"member {a}-{b}", value=group, allowed="a GRUP card's"
            )
        members += _segments(nodes, a, b, group, deck.groups[group])
    if not members:
        raise InputError("no member of the deck is a tube", field="MEMBER", value=len(deck.members))
    used = {node for m in members for node in (m.start, m.end)}
    return Structure(
        name=name,
        nodes={node: at for node, at in nodes.items() if node in used},
        members=tuple(members),
        masses=tuple(PointMass(node, mass) for node, mass in deck.masses.items() if node in used),
        reactions=tuple(_reactions(deck.held, used)),
    )


def _segments(
    nodes: dict[str, tuple[float, float, float]], a: str, b: str, group: str,
    parts: list[tuple[Section, Material, float | None]],
) -> Iterable[Member]:  # fmt: skip
    """Return a member, cut where its group changes; the segment without a length takes what is left."""
    start, end = (np.asarray(_place(nodes, node, a, b)) for node in (a, b))
    whole = float(np.linalg.norm(end - start))
    left = whole - sum(length or 0.0 for _, _, length in parts)
    open_ = sum(length is None for _, _, length in parts)
    at, previous = 0.0, a
    for i, (section, material, length) in enumerate(parts, start=1):
        at += length if length is not None else left / open_
        node = b if i == len(parts) else f"{a}-{b}.{i}"
        if node != b:
            x, y, z = map(float, start + (end - start) * min(at / whole, 1.0))
            nodes[node] = (x, y, z)
        suffix = f".{i}" if len(parts) > 1 else ""
        yield Member(f"{a}-{b}{suffix}", previous, node, section, section, material, group)
        previous = node


def _place(
    nodes: Mapping[str, tuple[float, float, float]], node: str, a: str, b: str
) -> tuple[float, float, float]:
    if node not in nodes:
        raise InputError(
            "a member of no joint", field=f"member {a}-{b}", value=node, allowed="a JOINT card's"
        )
    return nodes[node]


def _reactions(held: Mapping[str, str], used: set[str]) -> Iterable[Reaction]:
    for node, word in held.items():
        if node not in used:
            continue
        if word in _HELD:
            yield Reaction(node, _HELD[word])
        elif set(word) <= {"0", "1"}:
            x, y, z, rx, ry, rz = (c == "1" for c in word.ljust(6, "0"))
            yield Reaction(node, (x, y, z, rx, ry, rz))
