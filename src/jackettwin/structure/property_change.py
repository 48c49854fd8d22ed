"""Change of one property of a structure: of the steel of a part, a body, a spring, or its own feet."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import dist, pi, sqrt
from typing import cast

import numpy as np
import scipy.sparse as sp

from jackettwin.errors import look_up, require
from jackettwin.structure.assemble import Assembly
from jackettwin.structure.check import few
from jackettwin.structure.mesh import discretise
from jackettwin.structure.model import Beam, Inertia, Member, PointMass, Section, Structure, T, Vector
from jackettwin.structure.two_node import Matrix

GROWTH_KG_M3 = 1325.0
"""Density of marine growth, ISO 19901-1 (2015) annex: 1325 kg/m³ unless measured."""
RNA = "rna"
"""Also the name of the body on the top node."""


@dataclass(frozen=True)
class Property:
    """Something of a structure that can be changed by a number.

    Attributes
    ----------
    is_factor : bool
        Whether the number multiplies what is there; else it is added, in the unit of the name.
    apply : function of (structure, name of the part or body, number) to the changed structure
    """

    is_factor: bool
    apply: Callable[[Structure, str, float], Structure]


def adjusted(structure: Structure, of: str, name: str, what: str, value: float) -> Structure:
    """Return the structure with one property changed.

    Parameters
    ----------
    of : {"part", "body", "spring", "foot"}
    name : str
        A part; a node that carries bodies, ``rna`` for the top; a spring; a foot, ``all`` for every one.
    what : str
        A key of :data:`PROPERTIES` that fits ``of``.
    value : float
        The factor, or what is added.

    Raises
    ------
    InputError
        If there is no such thing or property, or the value leaves none of it.
    """
    return look_up(PROPERTIES[of], what, "property", field="property").apply(structure, name, value)


def _walls(structure: Structure, part: str, factor: float) -> Structure:
    """Return the part's walls times a factor, outer diameters as they are."""
    _require_tubes(structure, part, "a wall")

    def thicker(section: Section) -> Section:
        return replace(section, thickness_m=section.thickness_m * factor)

    def changed(m: Member) -> Member:
        if m.part != part:
            return m
        return replace(m, section_start=thicker(m.section_start), section_end=thicker(m.section_end))

    return replace(structure, members=tuple(map(changed, structure.members)))


def _added_mass(structure: Structure, part: str, mass_kg: float) -> Structure:
    """Return the part with a mass spread over its outer surface, as growth and water are, in its density."""
    bars = _bars(structure, part)
    surface = np.array([_width(bar) * _length(structure, bar) for bar in bars])
    return _heavier(
        structure, {b.name: m for b, m in zip(bars, mass_kg * surface / surface.sum(), strict=True)}
    )


def _growth(structure: Structure, part: str, thickness_m: float) -> Structure:
    """Return the part with marine growth of a thickness on it below still water, in its density.

    ρ π t (D + t) of a metre of tube in water: its own mass, not that of the water it moves along.
    """
    require(
        thickness_m >= 0.0, "growth is not negative", field="growth_m", value=thickness_m, allowed=">= 0 m"
    )
    _require_tubes(structure, part, "growth")
    masses = {}
    for m in _bars(structure, part):
        ends = (structure.nodes[m.start][2], structure.nodes[m.end][2])
        wet_m = _wet_share(*ends, structure.sea_level_z_m) * _length(structure, m)
        masses[m.name] = GROWTH_KG_M3 * pi * thickness_m * (_width(m) + thickness_m) * wet_m
    return _heavier(structure, masses)


def _heavier(structure: Structure, added_kg: Mapping[str, float]) -> Structure:
    """Return the structure with masses added to bars, by name, in their densities."""
    mesh = discretise(structure)
    p = mesh.properties
    tubes = np.bincount(mesh.member, weights=p.A * p.L, minlength=len(structure.members)).tolist()
    volumes = dict(zip((m.name for m in structure.members), tubes, strict=True))
    volumes |= {b.name: b.section.A * _length(structure, b) for b in structure.beams}

    def changed(bar: T) -> T:
        if bar.name not in added_kg:
            return bar
        rho = bar.material.density_kg_m3 + added_kg[bar.name] / volumes[bar.name]
        require(
            rho >= 0.0,
            "takes off more than the part weighs",
            field="added_mass_kg",
            value=sum(added_kg.values()),
            remedy="raise the lower bound",
        )
        return replace(bar, material=replace(bar.material, density_kg_m3=rho))

    members, beams = tuple(map(changed, structure.members)), tuple(map(changed, structure.beams))
    return replace(structure, members=members, beams=beams)


def _wet_share(a: float, b: float, surface: float) -> float:
    """Return which share of a member from height a to height b is below the surface.

    >>> _wet_share(-30.0, 10.0, 0.0), _wet_share(-5.0, -5.0, 0.0), _wet_share(2.0, 9.0, 0.0)
    (0.75, 1.0, 0.0)
    """
    low, high = min(a, b), max(a, b)
    if high <= surface:
        return 1.0
    return 0.0 if low >= surface else (surface - low) / (high - low)


def _width(bar: Member | Beam) -> float:
    """Return the mean diameter of a tube; of another section that of the thin tube of its polar radius."""
    if isinstance(bar, Beam):
        return 2.0 * sqrt(bar.section.I_p / bar.section.A)
    return 0.5 * (bar.section_start.outer_diameter_m + bar.section_end.outer_diameter_m)


def _length(structure: Structure, bar: Member | Beam) -> float:
    return dist(structure.nodes[bar.start], structure.nodes[bar.end])


def _bars(structure: Structure, part: str) -> tuple[Member | Beam, ...]:
    look_up({bar.part: bar for bar in structure.bars}, part, "part", field="part")
    return tuple(bar for bar in structure.bars if bar.part == part)


def _require_tubes(structure: Structure, part: str, what: str) -> None:
    """Refuse a change of tubes for a part that has other sections, too."""
    bars = _bars(structure, part)
    others = [bar.name for bar in bars if isinstance(bar, Beam)]
    weighs = any(bar.material.density_kg_m3 > 0.0 for bar in bars)
    require(
        not others,
        f"only tubes have {what} to change, and this part has members of another section",
        field="property",
        value=few(others),
        allowed="youngs_modulus, density, added_mass_kg" if weighs else "youngs_modulus, added_mass_kg",
        remedy="change one of these, or give its tubes a part of their own",
    )


def _with_bodies(structure: Structure, name: str, changed: Callable[[PointMass], PointMass]) -> Structure:
    node = structure.top_node if name == RNA else name
    bodies = {m.node: m for m in structure.masses}
    look_up(bodies, node, "body", field="body", remedy="name the node of a mass; added_mass_kg makes one")
    return replace(structure, masses=tuple(changed(m) if m.node == node else m for m in structure.masses))


def _body_mass(structure: Structure, name: str, factor: float) -> Structure:
    """Return the bodies on a node as much heavier, inertia included, their centre where it was."""

    def heavier(m: PointMass) -> PointMass:
        return replace(m, mass_kg=m.mass_kg * factor, inertia_kg_m2=_times(m.inertia_kg_m2, factor))

    return _with_bodies(structure, name, heavier)


def _body_inertia(structure: Structure, name: str, factor: float) -> Structure:
    """Return the bodies on a node with their inertia about their own centres times a factor."""
    return _with_bodies(structure, name, lambda m: replace(m, inertia_kg_m2=_times(m.inertia_kg_m2, factor)))


def _times(values: Inertia, factor: float) -> Inertia:
    return cast("Inertia", tuple(factor * value for value in values))


def _shift(axis: int) -> Callable[[Structure, str, float], Structure]:
    def shifted(structure: Structure, name: str, metres: float) -> Structure:
        def moved(m: PointMass) -> PointMass:
            offset = tuple(v + metres * (i == axis) for i, v in enumerate(m.cg_offset_m))
            return replace(m, cg_offset_m=cast("Vector", offset))

        return _with_bodies(structure, name, moved)

    return shifted


def _extra_body(structure: Structure, name: str, mass_kg: float) -> Structure:
    """Return the structure with a mass more on a node; a negative one makes what is there lighter."""
    node = structure.top_node if name == RNA else name
    look_up(structure.nodes, node, "node", field="body")
    if mass_kg >= 0.0:
        return structure.with_masses((*structure.masses, PointMass(node, mass_kg)))
    there = sum(m.mass_kg for m in structure.masses if m.node == node)
    require(
        there + mass_kg > 0.0,
        "takes off more than the bodies weigh",
        field="added_mass_kg",
        value=mass_kg,
        allowed=f"> {-there:g} kg",
    )
    return _body_mass(structure, name, 1.0 + mass_kg / there)


def _springs(structure: Structure, name: str, factor: float) -> Structure:
    known = {element.name: element for element in structure.elements}
    look_up(known, name, "spring", field="spring", remedy="springs and cables of a deck have names")
    return replace(
        structure,
        elements=tuple(
            replace(e, stiffness=_scaled(e.stiffness, factor)) if e.name == name else e
            for e in structure.elements
        ),
    )


def _feet(structure: Structure, name: str, factor: float) -> Structure:
    """Return the structure with the 6×6 stiffness of feet, which its own file gives, times a factor."""
    known = {reaction.node: reaction for reaction in structure.reactions if reaction.stiffness is not None}
    require(
        known if name == "all" else name in known,
        "the structure's file gives this foot no stiffness",
        field="foot",
        value=name,
        allowed=", ".join(known) or "none: its feet are pinned",
        remedy="update the support from records, or leave it out",
    )
    return replace(
        structure,
        reactions=tuple(
            replace(r, stiffness=_scaled(r.stiffness, factor))
            if r.stiffness is not None and name in ("all", r.node)
            else r
            for r in structure.reactions
        ),
    )


def _scaled(matrix: Matrix, factor: float) -> Matrix:
    return tuple(tuple(factor * value for value in row) for row in matrix)


def _stiffness(structure: Structure, part: str, factor: float) -> Structure:
    return structure.with_material(part, youngs_modulus=factor)


def _density(structure: Structure, part: str, factor: float) -> Structure:
    return structure.with_material(part, density=factor)


PROPERTIES: dict[str, dict[str, Property]] = {
    "part": {
        "youngs_modulus": Property(True, _stiffness),
        "density": Property(True, _density),
        "wall_thickness": Property(True, _walls),
        "added_mass_kg": Property(False, _added_mass),
        "growth_m": Property(False, _growth),
    },
    "body": {
        "mass": Property(True, _body_mass),
        "inertia": Property(True, _body_inertia),
        "added_mass_kg": Property(False, _extra_body),
        "cg_shift_x_m": Property(False, _shift(0)),
        "cg_shift_y_m": Property(False, _shift(1)),
        "cg_shift_z_m": Property(False, _shift(2)),
    },
    "spring": {"stiffness": Property(True, _springs)},
    "foot": {"stiffness": Property(True, _feet)},
}
"""Properties that can be changed: of a part, of the bodies on a node, of a spring, of a foot."""


def foot_stiffness(assembly: Assembly) -> sp.csc_array:
    """Return the stiffness that the structure's own file gives its feet, (n_dof, n_dof)."""
    total = sp.lil_array((assembly.n_dof, assembly.n_dof))
    for reaction in assembly.structure.reactions:
        if reaction.stiffness is not None:
            dofs = assembly.dofs(reaction.node)
            total[dofs[:, None], dofs] = np.array(reaction.stiffness)
    return sp.csc_array(total)
