"""Checks of a model before it is used: its mass, its rigid-body modes, improbable sections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import require
from jackettwin.structure.assemble import Assembly, assemble
from jackettwin.structure.eigen import lowest_modes
from jackettwin.structure.masses import rigid_transfer
from jackettwin.structure.model import PILES, Beam, Member, Structure, Vector

SLENDER_WALLS = (10.0, 300.0)
"""Diameter over wall of offshore tubes, from thick-walled piles to thin towers."""
_WIDEST_BODY_M = 100.0
"""Radius of gyration; a rotor of 240 m has 20 m to 30 m about the tower top."""
_COMPACT = (0.01, 5.0)
"""Radius of gyration over the root of the area: a plate of 100 to 1 has 0.03 and 2.9, a thin tube 3.5."""
_LIGHTEST_TOP = 0.002
"""Share of the whole mass; a rotor and nacelle have a few hundredths at least."""


@dataclass(frozen=True)
class ModelCheck:
    """Properties that an engineer checks before using a model.

    Attributes
    ----------
    mass_kg : float
        Of what stands: without the mass that supports bring along.
    support_mass_kg : float
        That of the supports (an SSI file's matrix), which vibrates with it.
    center_of_mass_m : (x, y, z) of what stands, in the structure's frame
    rigid_body_modes : int
        Of the free structure without gravity; six for anything in one piece.
    warnings : tuple of str
        One sentence for each kind of oddity, naming the members.
    """

    mass_kg: float
    support_mass_kg: float
    center_of_mass_m: Vector
    rigid_body_modes: int
    warnings: tuple[str, ...]


def check(assembly: Assembly) -> ModelCheck:
    """Return the check of a model. Nodes that hang on nothing never get this far: a Structure refuses them.

    Raises
    ------
    InputError
        If the structure has no mass.
    """
    motion = rigid_body_motion(assembly)
    ground = _supports(assembly.structure)
    body = motion.T @ (assembly.mass @ motion) - ground
    mass = float(body[2, 2])
    require(mass > 0.0, "the structure has no mass", field="materials", value=mass, allowed="> 0 kg")
    centre = np.array([body[1, 5], body[2, 3], body[0, 4]]) / mass
    return ModelCheck(
        mass_kg=mass,
        support_mass_kg=float(ground[2, 2]),
        center_of_mass_m=(float(centre[0]), float(centre[1]), float(centre[2])),
        rigid_body_modes=_rigid_body_modes(assembly),
        warnings=(
            *posture(assembly.structure),
            *_warnings(assembly.structure),
            *_bodies(assembly.structure, mass),
        ),
    )


def _supports(structure: Structure) -> FloatArray:
    """Return the rigid-body mass (6, 6) about the origin of the masses that come with the reactions."""
    total = np.zeros((6, 6))
    for reaction in structure.reactions:
        if reaction.mass is not None:
            move = rigid_transfer(np.array(structure.nodes[reaction.node]))
            total += move.T @ np.array(reaction.mass) @ move
    return total


def rigid_body_motion(assembly: Assembly) -> FloatArray:
    """Return (n_dof, 6): unit translations along and rotations about the axes of the structure's frame."""
    everywhere = np.vstack([rigid_transfer(point) for point in assembly.mesh.coordinates])
    motion = everywhere[assembly.independent]
    followers = [link.follower for link in assembly.structure.rigid_links]
    hinges = [assembly.mesh.node_names.index(name) for name in followers]
    motion[np.isin(assembly.independent // DOFS_PER_NODE, hinges)] = 0.0  # hinges stay as they are
    return np.asarray(motion)


def _rigid_body_modes(assembly: Assembly) -> int:
    """Return how many modes of the free structure have next to no frequency beside its first elastic one."""
    free = assemble(assembly.structure) if assembly.gravity else assembly
    omega, _ = lowest_modes(free.stiffness, free.mass, 7)
    return int(np.sum(omega < 1e-3 * omega[-1]))


def _warnings(structure: Structure) -> Iterator[str]:
    low, high = SLENDER_WALLS

    def wall(m: Member) -> bool:
        return any(not low <= s.slenderness <= high for s in (m.section_start, m.section_end))

    def stubby(m: Member) -> bool:
        if m.part == PILES:  # cut where the ground acts on it
            return False
        length = np.linalg.norm(np.subtract(structure.nodes[m.end], structure.nodes[m.start]))
        return bool(length < 0.5 * max(m.section_start.outer_diameter_m, m.section_end.outer_diameter_m))

    def gyration(m: Member | Beam) -> bool:
        if isinstance(m, Member):
            return False
        radii = [np.sqrt(inertia) / m.section.A for inertia in (m.section.I_x, m.section.I_y)]
        return not _COMPACT[0] <= min(radii) <= max(radii) <= _COMPACT[1]

    oddities: tuple[tuple[str, Callable[[Any], bool]], ...] = (
        (f"diameter over wall thickness outside {low:g} to {high:g}", wall),
        ("shorter than half the diameter", stubby),
        (
            f"radius of gyration of the section outside {_COMPACT[0]:g} to {_COMPACT[1]:g} times the root of "
            "its area (is it in m² and m⁴?)",
            gyration,
        ),
        ("Young's modulus below 1 GPa (is it in Pa?)", lambda m: m.material.youngs_modulus_pa < 1e9),
        (
            "density below 500 kg/m³ (is it in kg/m³?)",
            lambda m: 0.0 < m.material.density_kg_m3 < 500.0,
        ),
        ("without mass", lambda m: m.material.density_kg_m3 == 0.0),
        ("Poisson's ratio outside 0 to 0.5", lambda m: not 0.0 <= m.material.poisson_ratio <= 0.5),
    )
    for what, is_odd in oddities:
        every = structure.members if is_odd in (wall, stubby) else structure.bars
        names = [member.name for member in every if is_odd(member)]
        if names:
            yield f"{what}: {few(names)}"
    between: dict[frozenset[str], list[str]] = {}
    for m in structure.bars:
        between.setdefault(frozenset((m.start, m.end)), []).append(m.name)
    if twice := [" and ".join(names) for names in between.values() if len(names) > 1]:
        yield f"between the same two nodes (is it given twice?): {few(twice)}"


def posture(structure: Structure) -> tuple[str, ...]:
    """Return what is odd about how a structure stands in the sea: on its head, or below still water."""
    z = {name: at[2] for name, at in structure.nodes.items()}
    feet = {reaction.node for reaction in structure.reactions}
    others = [height for name, height in z.items() if name not in feet]
    top, sea = structure.top_node, structure.sea_level_z_m
    found = []
    if feet and others and min(z[name] for name in feet) > max(others):
        lowest = min(z[name] for name in feet)
        found.append(
            f"its feet, at z = {lowest:g} m and higher, are above all its other nodes: it hangs upside down "
            "(z is upwards: is it given as a depth?)"
        )
    elif z[top] < sea:
        found.append(
            f"its highest node, {top}, is at z = {z[top]:g} m, {sea - z[top]:g} m below still water "
            f"(sea_level_z_m: {sea:g}; is z upwards, and in metres?)"
        )
    return tuple(found)


def _bodies(structure: Structure, mass_kg: float) -> Iterator[str]:
    """Yield what is odd about rigid bodies; mostly their masses are in tonnes."""
    for body in structure.masses:
        about = np.linalg.eigvalsh(body.inertia_tensor)
        gyration = float(np.sqrt(about[-1] / max(body.mass_kg, 1e-9)))
        if body.mass_kg > 0.0 and gyration > _WIDEST_BODY_M:
            yield (
                f"radius of gyration of {gyration:.0f} m: the body of {body.mass_kg:g} kg on {body.node} "
                "(is its mass in kg?)"
            )
        if about[-1] > 1.01 * about[:2].sum():
            yield (
                f"inertia of the body on {body.node} that no mass has: {about[-1]:.3g} kg·m² about one axis "
                f"is more than {about[0]:.3g} and {about[1]:.3g} about the other two together"
            )
    top = sum(body.mass_kg for body in structure.masses if body.node == structure.top_node)
    if 0.0 < top < _LIGHTEST_TOP * mass_kg:
        yield (
            f"{top:g} kg on the highest node, {structure.top_node}, is next to nothing beside "
            f"{mass_kg:.3g} kg in all (is it in kg?)"
        )


def few(names: Sequence[str], limit: int = 5) -> str:
    """Return the first names of a list, and how many more there are.

    >>> few(["a", "b", "c"], limit=2)
    'a, b and 1 more'
    """
    more = f" and {len(names) - limit} more" if len(names) > limit else ""
    return ", ".join(names[:limit]) + more
