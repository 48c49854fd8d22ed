"""Change of one property of a structure: of the steel of a part, a body, a spring, or its own feet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from typing import cast

import numpy as np
import scipy.sparse as sp

from jackettwin.errors import look_up, require
from jackettwin.structure.assemble import Assembly
from jackettwin.structure.mesh import discretise
from jackettwin.structure.model import Inertia, Member, PointMass, Section, Structure, Vector
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

    def thicker(section: Section) -> Section:
        return replace(section, thickness_m=section.thickness_m * factor)

    def changed(m: Member) -> Member:
        return replace(m, section_start=thicker(m.section_start), section_end=thicker(m.section_end))

    return _with_members(structure, part, changed)


def _added_mass(structure: Structure, part: str, mass_kg: float) -> Structure:
    """Return the part with a mass spread over its outer surface, as growth and water are, in its density."""
    mesh = discretise(structure, subdivide=1)
    p = mesh.properties
    members = {m.name: i for i, m in enumerate(structure.members)}
    chosen = [members[m.name] for m in _members(structure, part)]
    wide = np.array([_width(structure.members[i]) for i in chosen])
    surface = pi * wide * p.L[chosen]
    density = mass_kg * surface / surface.sum() / (p.A[chosen] * p.L[chosen])
    extra = {structure.members[i].name: float(rho) for i, rho in zip(chosen, density, strict=True)}

    def changed(m: Member) -> Member:
        rho = m.material.density_kg_m3 + extra[m.name]
        require(
            rho >= 0.0,
            "takes off more than the part weighs",
            field="added_mass_kg",
            value=mass_kg,
            remedy="raise the lower bound",
        )
        return replace(m, material=replace(m.material, density_kg_m3=rho))

    return _with_members(structure, part, changed)


def _growth(structure: Structure, part: str, thickness_m: float) -> Structure:
    """Return the part with marine growth of a thickness on it below still water, in its density.

    ρ π t (D + t) of a metre of tube in water: its own mass, not that of the water it moves along.
    """
    require(
        thickness_m >= 0.0, "growth is not negative", field="growth_m", value=thickness_m, allowed=">= 0 m"
    )
    p = discretise(structure, subdivide=1).properties
    places = {m.name: i for i, m in enumerate(structure.members)}

    def changed(m: Member) -> Member:
        ends = (structure.nodes[m.start][2], structure.nodes[m.end][2])
        layer = GROWTH_KG_M3 * pi * thickness_m * (_width(m) + thickness_m)
        wet = _wet_share(*ends, structure.sea_level_z_m)
        rho = m.material.density_kg_m3 + layer * wet / float(p.A[places[m.name]])
        return replace(m, material=replace(m.material, density_kg_m3=rho))

    return _with_members(structure, part, changed)


def _wet_share(a: float, b: float, surface: float) -> float:
    """Return which share of a member from height a to height b is below the surface.

    >>> _wet_share(-30.0, 10.0, 0.0), _wet_share(-5.0, -5.0, 0.0), _wet_share(2.0, 9.0, 0.0)
    (0.75, 1.0, 0.0)
    """
    low, high = min(a, b), max(a, b)
    if high <= surface:
        return 1.0
    return 0.0 if low >= surface else (surface - low) / (high - low)


def _width(member: Member) -> float:
    return 0.5 * (member.section_start.outer_diameter_m + member.section_end.outer_diameter_m)


def _members(structure: Structure, part: str) -> tuple[Member, ...]:
    look_up({m.part: m for m in structure.members}, part, "part", field="part")
    return tuple(m for m in structure.members if m.part == part)


def _with_members(structure: Structure, part: str, changed: Callable[[Member], Member]) -> Structure:
    _members(structure, part)
    return replace(structure, members=tuple(changed(m) if m.part == part else m for m in structure.members))


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
