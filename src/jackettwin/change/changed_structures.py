"""Possible changes of a jacket, each as the changed structure and ground."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from math import pi
from typing import cast

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.ground import ARM_M, UNDESCRIBED, Loss
from jackettwin.constants import SEA_WATER_KG_M3
from jackettwin.errors import require
from jackettwin.plugins import plugins
from jackettwin.soil import feet_in_line
from jackettwin.structure import GROWTH_KG_M3, Material, Member, PointMass, Section, Structure

_LEG = 0.9
"""Smallest rise of a leg over its length; other members are braces."""
_SPLASH = (-3.0, 6.0)
"""Splash zone about mean sea level [m]."""
_WEAKENED = "× 30 % off"
"""Unit of a brace's or a connection's loss: the effect of 30 % less stiffness. Twice the effect is not 60 %,
since load shifts to the neighbours faster the less stiffness is left."""
_ON_BLADES = 2.0
"""Inertia by mass of what lies on blades, as ice does, over that of the whole RNA: the rotor has nearly all
of the inertia and half of the mass."""
_THICKNESSES = (0.1, 0.2, 0.3, 0.4, 0.6, 2.0, 4.0)
"""Multiples of 5 cm of growth for which its effect is computed. Braces with more and more mass have lower and
lower modes of their own, which cross those of the whole structure; on the reference jacket 7 mm take 0.14 %
of a frequency, 10 mm 0.28 % and 15 mm 0.10 %."""
_GONE = 1e-3
"""Share of a lost member's stiffness and mass that is kept, so that every node remains supported."""


@dataclass(frozen=True)
class Standing:
    """A structure and the stiffness of its feet.

    Attributes
    ----------
    horizontal, vertical : (n_feet,) [N/m]
    scour_loss : what a metre of scour takes
    """

    structure: Structure
    horizontal: FloatArray
    vertical: FloatArray
    scour_loss: Loss = field(default_factory=lambda: UNDESCRIBED.scour_loss)

    @property
    def rocking(self) -> FloatArray:
        """Rotational stiffness of every foot [Nm/rad]: none of several, which stand on translations."""
        return self.vertical * (ARM_M**2 if feet_in_line(self.structure) else 0.0)


@dataclass(frozen=True)
class Happening:
    """A possible change.

    Attributes
    ----------
    family : what kind, ``brace lost``
    name : which one
    apply : the structure after it
    per : size at which ``apply`` is evaluated
    median, spread : of its size, lognormal
    unit : of the size
    both_ways : whether it may be negative as well
    damps : damping ratio a unit of the logarithm of frequency lost: friction in a loose joint
    or_else : the structure after another form of it; what happens is any mean of both
    often : the structure after so many times as much, if that is not the change again and again
    largest : no size reaches it
    solved : multiples of it for which its effect is computed as well; few sizes reach beyond five, between
        them cubics have errors of some per cent for a brace or for the splash zone, whose walls are half gone
        by then
    """

    family: str
    name: str
    apply: Callable[[Standing], Standing]
    per: float
    median: float
    spread: float
    unit: str
    both_ways: bool = False
    damps: float = 0.0
    or_else: Callable[[Standing], Standing] | None = None
    often: Callable[[float], Callable[[Standing], Standing]] | None = None
    largest: float = float("inf")
    solved: tuple[float, ...] = (3, 5)


PLUGINS = "jackettwin.causes"
"""Group of entry points, each a function from a :class:`Standing` to further possible changes."""


def happenings(standing: Standing) -> tuple[Happening, ...]:
    """Return all possible changes of a structure, including those of installed packages."""
    structure = standing.structure
    added = cast("Iterable[Callable[[Standing], Iterable[Happening]]]", plugins(PLUGINS).values())
    return (
        *_grounds(structure),
        *_braces(structure),
        Happening(
            "growth", "marine growth", _grown(1.0), 0.05, 0.02, 1.2, "m", often=_grown, solved=_THICKNESSES
        ),
        *_tops(structure),
        Happening("corrosion", "corrosion of the splash zone", _corroded, 0.002, 0.003, 0.8, "m"),
        Happening(
            "connection", "grouted or bolted connection", _loosened, 1.0, 1.0, 0.8, _WEAKENED, damps=0.5
        ),
        *(happening for happenings_of in added for happening in happenings_of(standing)),
    )


def _grounds(structure: Structure) -> Iterator[Happening]:
    yield Happening("scour", "scour at all feet", lambda s: _scoured(s, None), 1.0, 1.0, 0.8, "m")
    feet = structure.reaction_nodes
    for i, node in enumerate(feet if len(feet) > 1 else ()):
        yield Happening("scour at one foot", f"scour at {node}", _scoured_at(i), 1.0, 1.5, 0.8, "m")
    yield Happening(
        "soil", "soil softening", _softened(1), 0.1, 0.1, 0.8, "-", often=_softened, largest=1.0
    )  # fmt: skip


def _scoured_at(foot: int) -> Callable[[Standing], Standing]:
    return lambda s: _scoured(s, foot)


def _scoured(standing: Standing, foot: int | None) -> Standing:
    chosen = np.ones(standing.horizontal.size) if foot is None else np.eye(standing.horizontal.size)[foot]
    loss = standing.scour_loss
    turns = feet_in_line(standing.structure)
    of = (loss.free_sideways, loss.free_turning) if turns else (loss.sideways, loss.axially)
    sideways, axially = (np.exp(-per_m * chosen) for per_m in of)
    return replace(standing, horizontal=standing.horizontal * sideways, vertical=standing.vertical * axially)


def _softened(tenths: float) -> Callable[[Standing], Standing]:
    left = 1.0 - 0.1 * tenths
    return lambda s: replace(s, horizontal=left * s.horizontal, vertical=left * s.vertical)


def _braces(structure: Structure) -> Iterator[Happening]:
    for members in braces(structure):
        name = members[0]
        yield Happening("brace lost", f"{name} lost", _lost(members), 1.0, 1.0, 0.05, "-")
        yield Happening("brace weakened", f"{name} weakened", _scaled(members, 0.7), 1.0, 1.0, 0.8, _WEAKENED)
        yield Happening("flooded", f"{name} flooded", _flooded(members), 1.0, 1.0, 0.05, "-")


def braces(structure: Structure) -> tuple[tuple[str, ...], ...]:
    """Return the names of the members of each brace: those in one line that share nodes."""
    jacket = [m for m in structure.members if m.part in ("jacket", "") and _climb(structure, m) <= _LEG]
    lines: list[list[Member]] = []
    for member in jacket:
        joined = [line for line in lines if any(_in_line(structure, member, other) for other in line)]
        merged = [m for line in joined for m in line] + [member]
        lines = [line for line in lines if line not in joined] + [merged]
    return tuple(tuple(m.name for m in line) for line in lines)


def _direction(structure: Structure, member: Member) -> FloatArray:
    along = np.subtract(structure.nodes[member.end], structure.nodes[member.start])
    return np.asarray(along / np.linalg.norm(along))


def _climb(structure: Structure, member: Member) -> float:
    return float(abs(_direction(structure, member)[2]))


def _in_line(structure: Structure, one: Member, other: Member) -> bool:
    shared = {one.start, one.end} & {other.start, other.end}
    aligned = abs(_direction(structure, one) @ _direction(structure, other))
    return bool(shared) and bool(aligned > 0.999)


def _scaled(members: tuple[str, ...], factor: float) -> Callable[[Standing], Standing]:
    def apply(standing: Standing) -> Standing:
        return _with_members(standing, members, lambda m: _softer(m, factor))

    return apply


def _lost(members: tuple[str, ...]) -> Callable[[Standing], Standing]:
    """Return the change that the members of a line carry nothing; their mass hangs on the line's ends.

    Within members without stiffness it would oscillate by itself, as a severed brace does not.
    """

    def apply(standing: Standing) -> Standing:
        structure = standing.structure
        gone = [m for m in structure.members if m.name in members]
        nodes = Counter(node for m in gone for node in (m.start, m.end))
        ends = [node for node, times in nodes.items() if times == 1]
        mass = sum(_steel_kg(structure, m) for m in gone) / len(ends)
        left = _with_members(standing, members, lambda m: _lighter(_softer(m, _GONE), 1.0 - _GONE))
        hung = (*left.structure.masses, *(PointMass(node, (1.0 - _GONE) * mass) for node in ends))
        return replace(left, structure=left.structure.with_masses(hung))

    return apply


def _softer(member: Member, factor: float) -> Member:
    m = member.material
    softer = Material(m.youngs_modulus_pa * factor, m.shear_modulus_pa * factor, m.density_kg_m3)
    return replace(member, material=softer)


def _with_members(
    standing: Standing, chosen: tuple[str, ...], change: Callable[[Member], Member]
) -> Standing:
    members = tuple(change(m) if m.name in chosen else m for m in standing.structure.members)
    return replace(standing, structure=replace(standing.structure, members=members))


def _flooded(members: tuple[str, ...]) -> Callable[[Standing], Standing]:
    def apply(standing: Standing) -> Standing:
        def inside(member: Member) -> float:
            s = member.section_start
            return SEA_WATER_KG_M3 * 0.25 * pi * (s.outer_diameter_m - 2.0 * s.thickness_m) ** 2

        return with_mass(standing, [m for m in standing.structure.members if m.name in members], inside)

    return apply


def _grown(times: float) -> Callable[[Standing], Standing]:
    """Return the change by so many times 5 cm of growth."""
    thickness = 0.05 * times

    def more(member: Member) -> float:
        outer = member.section_start.outer_diameter_m
        ring = 0.25 * pi * ((outer + 2.0 * thickness) ** 2 - outer**2)
        # marine growth, and the added mass of the water it displaces: C_a = 1
        return ring * (GROWTH_KG_M3 + SEA_WATER_KG_M3)

    return lambda standing: with_mass(standing, standing.structure.members, more)


def with_mass(
    standing: Standing, members: Iterable[Member], per_metre: Callable[[Member], float]
) -> Standing:
    """Return the structure with mass on the submerged length of some members, half at either end.

    A negative mass is a loss, e.g. of anodes: it is taken from the bodies on the node,
    and the rest from the steel of the member.

    Parameters
    ----------
    per_metre : mass of a metre of a member [kg/m]

    Raises
    ------
    InputError
        If a member loses more than there is.
    """
    structure = standing.structure
    masses, steel = list(structure.masses), {m.name: m for m in structure.members}
    for member in members:
        a, b = (np.array(structure.nodes[n]) for n in (member.start, member.end))
        low, high = sorted((a[2], b[2]))
        sea = structure.sea_level_z_m
        wet = 1.0 if high <= sea else max(0.0, (sea - low) / (high - low)) if high > low else 0.0
        mass = 0.5 * wet * float(np.linalg.norm(b - a)) * per_metre(member)
        if mass > 0.0:
            masses += [PointMass(member.start, mass), PointMass(member.end, mass)]
        elif mass < 0.0:
            left = sum(_taken(masses, node, -mass) for node in (member.start, member.end))
            there = _steel_kg(structure, member)
            require(
                left < there or left == 0.0,
                f"{member.name} loses more mass than there is",
                field="mass_kg",
                value=round(left, 1),
                allowed=f"less than {there:.1f} kg, beside what bodies on its nodes weigh",
                remedy="check the loss a metre, and the members that it is of",
            )
            steel[member.name] = _lighter(steel[member.name], left / there)
    return replace(
        standing, structure=replace(structure, members=tuple(steel.values())).with_masses(tuple(masses))
    )


def _taken(masses: list[PointMass], node: str, loss: float) -> float:
    """Take a mass [kg] from the bodies on a node in order, and return the remainder."""
    for i, body in enumerate(masses):
        if body.node == node and loss > 0.0:
            part = min(loss, body.mass_kg)
            masses[i], loss = replace(body, mass_kg=body.mass_kg - part), loss - part
    return loss


def _lighter(member: Member, loss: float) -> Member:
    """Return a member that lacks a share of its mass."""
    steel = member.material
    return replace(member, material=replace(steel, density_kg_m3=steel.density_kg_m3 * (1.0 - loss)))


def _steel_kg(structure: Structure, member: Member) -> float:
    """Return the mass of a member's steel [kg]."""
    ends = member.section_start, member.section_end
    area = 0.5 * pi * sum((end.outer_diameter_m - end.thickness_m) * end.thickness_m for end in ends)
    a, b = (np.array(structure.nodes[n]) for n in (member.start, member.end))
    return float(area * np.linalg.norm(b - a) * member.material.density_kg_m3)


def _tops(structure: Structure) -> Iterator[Happening]:
    if not structure.masses:
        return
    heaviest = max(range(len(structure.masses)), key=lambda i: structure.masses[i].mass_kg)
    mass = structure.masses[heaviest].mass_kg

    def heavier(turning: float) -> Callable[[Standing], Standing]:
        """Return more mass on a body, with ``turning`` times its own inertia by mass."""

        def apply(standing: Standing) -> Standing:
            masses = list(standing.structure.masses)
            body = masses[heaviest]
            more = 1.0 + 0.01 * turning * mass / body.mass_kg
            xx, yy, zz, xy, xz, yz = more * np.array(body.inertia_kg_m2)
            masses[heaviest] = replace(
                body, mass_kg=body.mass_kg + 0.01 * mass, inertia_kg_m2=(xx, yy, zz, xy, xz, yz)
            )
            return replace(standing, structure=standing.structure.with_masses(tuple(masses)))

        return apply

    turns = any(structure.masses[heaviest].inertia_kg_m2)
    yield Happening(
        "mass", "mass of the RNA", heavier(0.0), 0.01 * mass, 0.01 * mass, 0.8, "kg", both_ways=True,
        or_else=heavier(_ON_BLADES) if turns else None,
    )  # fmt: skip


def _corroded(standing: Standing) -> Standing:
    structure = standing.structure
    low, high = (structure.sea_level_z_m + z for z in _SPLASH)

    def inside(member: Member) -> bool:
        z = sorted(structure.nodes[n][2] for n in (member.start, member.end))
        return member.part in ("jacket", "") and z[0] < high and z[1] > low

    def thinner(section: Section) -> Section:
        return Section(section.outer_diameter_m, max(section.thickness_m - 0.002, 0.2 * section.thickness_m))

    chosen = tuple(m.name for m in structure.members if inside(m))
    return _with_members(
        standing,
        chosen,
        lambda m: replace(m, section_start=thinner(m.section_start), section_end=thinner(m.section_end)),
    )


def _loosened(standing: Standing) -> Standing:
    structure = standing.structure
    piece = tuple(m.name for m in structure.members if m.part == "transition_piece")
    near = tuple(m.name for m in structure.members if {m.start, m.end} & set(structure.interface_nodes))
    return _with_members(standing, piece or near, lambda m: _softer(m, 0.7))
