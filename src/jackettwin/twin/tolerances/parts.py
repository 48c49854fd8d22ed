"""Assignment of members to tower, transition piece and jacket."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jackettwin.structure import Material, Member, PointMass, Section, Structure

TOWER, PIECE, JACKET = "tower", "transition_piece", "jacket"
_OFF_AXIS_M = 1.0
"""Distance from the tower's axis above which a node belongs to the jacket or transition piece."""
_LEG = 0.9
"""Ratio of height to length above which a member is a leg."""


def part_of(structure: Structure) -> dict[str, str]:
    """Return the part of each member by its name: as the file states, otherwise by its position.

    Members wholly above the interface are the tower's. Without an interface, these are the members above the
    highest node off the tower's axis.
    """
    if any(member.part == TOWER for member in structure.members):
        return {member.name: member.part or JACKET for member in structure.members}
    top = np.array(structure.nodes[structure.top_node])
    beside = [z for x, y, z in structure.nodes.values() if np.hypot(x - top[0], y - top[1]) > _OFF_AXIS_M]
    heights = [structure.nodes[node][2] for node in structure.interface_nodes] or beside
    foot = max(heights, default=-np.inf)

    def stands_above(member: Member) -> bool:
        return min(structure.nodes[node][2] for node in (member.start, member.end)) >= foot - 1e-6

    return {m.name: TOWER if stands_above(m) else JACKET for m in structure.members}


def legs(structure: Structure) -> tuple[str, ...]:
    """Return the names of the jacket's leg members."""
    parts = part_of(structure)

    def climbs(member: Member) -> bool:
        along = np.subtract(structure.nodes[member.end], structure.nodes[member.start])
        return bool(abs(along[2]) > _LEG * np.linalg.norm(along))

    return tuple(m.name for m in structure.members if parts[m.name] == JACKET and climbs(m))


def legs_by_foot(structure: Structure) -> tuple[tuple[str, ...], ...]:
    """Return the names of the members of each foot's leg, in the order of the reaction nodes.

    A member belongs to the foot in the nearest horizontal direction from the tower's axis.
    """
    axis, climbing = np.array(structure.nodes[structure.top_node])[:2], set(legs(structure))
    feet = np.array([structure.nodes[node][:2] for node in structure.reaction_nodes]) - axis
    found: list[list[str]] = [[] for _ in feet]
    for m in structure.members:
        if m.name in climbing:
            middle = 0.5 * np.add(structure.nodes[m.start], structure.nodes[m.end])[:2] - axis
            found[int(np.argmax(feet @ middle))].append(m.name)
    return tuple(tuple(names) for names in found)


def with_braces(structure: Structure, change: Callable[[Member], Member]) -> Structure | None:
    """Return the structure with all braces of the jacket changed; None without any."""
    parts, climbing = part_of(structure), set(legs(structure))
    chosen = {m.name for m in structure.members if parts[m.name] == JACKET} - climbing
    if not chosen:
        return None
    members = tuple(change(m) if m.name in chosen else m for m in structure.members)
    return replace(structure, members=members)


def with_part(structure: Structure, part: str, change: Callable[[Member], Member]) -> Structure | None:
    """Return the structure with every member of a part changed; None if the part has no member."""
    parts = part_of(structure)
    if part not in parts.values():
        return None
    members = tuple(change(m) if parts[m.name] == part else m for m in structure.members)
    return replace(structure, members=members)


def stiffer(factor: float) -> Callable[[Member], Member]:
    """Return the change that multiplies the stiffness of a member's steel."""

    def change(member: Member) -> Member:
        m = member.material
        steel = Material(m.youngs_modulus_pa * factor, m.shear_modulus_pa * factor, m.density_kg_m3)
        return replace(member, material=steel)

    return change


def heavier(factor: float) -> Callable[[Member], Member]:
    """Return the change that multiplies the density of a member's steel."""

    def change(member: Member) -> Member:
        density = member.material.density_kg_m3 * factor
        return replace(member, material=replace(member.material, density_kg_m3=density))

    return change


def thicker(factor: float) -> Callable[[Member], Member]:
    """Return the change that multiplies a member's wall thickness at constant outer diameter."""

    def wall(section: Section) -> Section:
        diameter = section.outer_diameter_m
        return Section(diameter, min(section.thickness_m * factor, 0.5 * diameter))

    def change(member: Member) -> Member:
        return replace(member, section_start=wall(member.section_start), section_end=wall(member.section_end))

    return change


def with_lower_feet(structure: Structure, by_m: float) -> Structure | None:
    """Return the structure with its feet, and the ends of members there, lowered; None without feet."""
    if not structure.reaction_nodes:
        return None
    nodes = dict(structure.nodes)
    for node in structure.reaction_nodes:
        x, y, z = nodes[node]
        nodes[node] = (x, y, z - by_m)
    return replace(structure, nodes=nodes)


def with_top_bodies(structure: Structure, change: Callable[[PointMass], PointMass]) -> Structure | None:
    """Return the structure with the bodies on its top node changed; None if there are none."""
    if all(body.node != structure.top_node for body in structure.masses):
        return None
    bodies = (change(body) if body.node == structure.top_node else body for body in structure.masses)
    return structure.with_masses(tuple(bodies))
