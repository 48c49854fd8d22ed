"""Jackets that are not as drawn: each kind of wrongness planted by building the asset anew.

Nothing here calls what the updating knows of tolerances: members are chosen by their heights, masses and
walls are other numbers, and the poles of the asset come from a model of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment

from jackettwin.decks import read_structure
from jackettwin.loads import Coefficients, GrowthBand, Water
from jackettwin.soil import family
from jackettwin.structure import Assembly, Material, Member, PointMass, Rayleigh, Section, Structure, assemble
from jackettwin.twin.water import WaterConfig, moving_mass
from jackettwin.updating import SupportModel, support_model

DECKS = Path(__file__).parents[1] / "decks"
STEEL = {"ratio": 0.0055, "frequency_hz": 0.2}
HIGHEST, OF_ASSET = 7, 12
"""Modes of a drawing that are measured, and modes of an asset among which they are looked for: growth brings
modes of single braces down among them."""


@dataclass(frozen=True)
class Site:
    """A drawn jacket: its file, its interface, whether its steel's density holds the water already."""

    name: str
    source: str
    interface_z_m: float
    column_z_m: float
    holds_water: bool


SITES = (
    Site("jacket15", "jacket15", 100.0, 94.0, True),
    Site("oc4_jacket", str(DECKS / "oc4_jacket.dat"), 20.15, 16.0, False),
    Site("three_legs", str(DECKS / "three_legs.yaml"), 64.0, 58.0, False),
    Site("four_legs", str(DECKS / "four_legs.yaml"), 76.0, 70.0, False),
)
"""Two that others published, two of our own."""
RNA = PointMass("", 9.0e5, (-5.0, 0.0, 4.0), (3.5e8, 2.2e8, 2.2e8, 0.0, 0.0, 0.0))
"""On the jacket whose file has none."""


@dataclass(frozen=True)
class World:
    """An asset as it stands.

    Attributes
    ----------
    horizontal, vertical : (n_feet,) storage stiffness at the first pinned frequency [N/m]
    law : of all feet
    """

    site: Site
    structure: Structure
    water: WaterConfig
    horizontal: np.ndarray
    vertical: np.ndarray
    loss: float
    law: str = "maxwell-3"
    on_axis: bool = False


def drawn(site: Site, *, on_axis: bool = False) -> Structure:
    """Return the structure as drawn, with a rotor–nacelle assembly, on request a symmetric one."""
    structure = read_structure(site.source)
    heaviest = max((body.mass_kg for body in structure.masses), default=0.0)
    if heaviest < 1e4:
        structure = structure.with_masses((replace(RNA, node=structure.top_node),))
    if on_axis:
        structure = structure.with_masses(
            tuple(_on_axis(b) if b.node == structure.top_node else b for b in structure.masses)
        )
    return structure


def _on_axis(body: PointMass) -> PointMass:
    """Return a body above the tower's axis, with one inertia about all axes."""
    return replace(
        body,
        cg_offset_m=(0.0, 0.0, body.cg_offset_m[2]),
        inertia_kg_m2=(*(body.inertia_kg_m2[1],) * 3, 0.0, 0.0, 0.0),
    )


def drawn_water(structure: Structure) -> WaterConfig:
    """Return clean members in the sea."""
    depth = structure.sea_level_z_m - min(structure.nodes[n][2] for n in structure.reaction_nodes)
    return WaterConfig(depth, Coefficients(), Water(), adds_mass=True, sea=None)


def assembly_of(world: World) -> Assembly:
    """Return the assembled asset; where the drawn steel holds the water, what differs from it is added."""
    plain = assemble(world.structure, gravity=True)
    mass = moving_mass(world.water, plain)
    if world.site.holds_water:
        mass = mass - moving_mass(drawn_water(world.structure), plain)
    return replace(plain, mass=(plain.mass + mass).tocsc())


def _members(
    world: World, where: Callable[[float, float], bool], change: Callable[[Member], Member]
) -> World:
    nodes = world.structure.nodes

    def own(member: Member) -> Member:
        low, high = sorted(nodes[node][2] for node in (member.start, member.end))
        return change(member) if where(low, high) else member

    members = tuple(own(member) for member in world.structure.members)
    return replace(world, structure=replace(world.structure, members=members))


def _steel(e: float = 1.0, rho: float = 1.0, wall: float = 1.0) -> Callable[[Member], Member]:
    def change(member: Member) -> Member:
        m = member.material
        material = Material(m.youngs_modulus_pa * e, m.shear_modulus_pa * e, m.density_kg_m3 * rho)
        bottom, top = (
            Section(s.outer_diameter_m, s.thickness_m * wall)
            for s in (member.section_start, member.section_end)
        )
        return Member(member.name, member.start, member.end, bottom, top, material, member.part)

    return change


def tower(world: World, **factors: float) -> World:
    """Return the asset with other steel above the interface."""
    return _members(world, lambda low, high: low >= world.site.interface_z_m - 0.1, _steel(**factors))


def jacket(world: World, **factors: float) -> World:
    """Return the asset with other steel below the transition piece."""
    return _members(world, lambda low, high: high <= world.site.column_z_m + 0.1, _steel(**factors))


def piece(world: World, **factors: float) -> World:
    """Return the asset with other steel between jacket and tower."""
    low_z, high_z = world.site.column_z_m, world.site.interface_z_m
    return _members(world, lambda low, high: low >= low_z - 0.1 and high <= high_z + 0.1, _steel(**factors))


def top(world: World, mass: float = 1.0, inertia: float = 1.0, up: float = 0.0, out: float = 0.0) -> World:
    """Return the asset with another rotor–nacelle assembly."""
    bodies = []
    for b in world.structure.masses:
        if b.node == world.structure.top_node:
            x, y, z = b.cg_offset_m
            tensor = tuple(inertia * mass * i for i in b.inertia_kg_m2)
            b = PointMass(b.node, mass * b.mass_kg, (x - out, y, z + up), tensor, b.part)  # type: ignore[arg-type]
        bodies.append(b)
    return replace(world, structure=world.structure.with_masses(tuple(bodies)))


def grown(world: World, thickness_m: float, density: float = 1325.0) -> World:
    """Return the asset with growth from the surface to the bed."""
    band = GrowthBand(1.0, -world.water.depth_m, thickness_m, density_kg_m3=density)
    given = world.water.coefficients
    return replace(world, water=replace(world.water, coefficients=replace(given, growth=(band,))))


def added(world: World, factor: float) -> World:
    """Return the asset in water of another C_a."""
    given = world.water.coefficients
    return replace(world, water=replace(world.water, coefficients=replace(given, added_mass=factor)))


def flooded(world: World, foot: int) -> World:
    """Return the asset with water in the leg above a foot."""
    nodes, structure = world.structure.nodes, world.structure
    at = np.array(nodes[structure.reaction_nodes[foot]])
    axis = np.array(nodes[structure.top_node])

    def in_leg(m: Member) -> bool:
        a, b = np.array(nodes[m.start]), np.array(nodes[m.end])
        steep = abs(b[2] - a[2]) > 0.9 * np.linalg.norm(b - a)
        out, foot_out = (0.5 * (a + b) - axis)[:2], (at - axis)[:2]
        same_side = out @ foot_out > 0.9 * np.linalg.norm(out) * np.linalg.norm(foot_out) > 0.0
        return bool(steep and same_side and max(a[2], b[2]) < world.site.column_z_m)

    names = tuple(m.name for m in structure.members if in_leg(m))
    return replace(world, water=replace(world.water, carried=Water(names)))


def deeper(world: World, by_m: float) -> World:
    """Return the asset whose feet, and the bed, lie deeper: longer legs."""
    nodes = dict(world.structure.nodes)
    for node in world.structure.reaction_nodes:
        x, y, z = nodes[node]
        nodes[node] = (x, y, z - by_m)
    depth = world.water.depth_m + by_m
    return replace(
        world,
        structure=replace(world.structure, nodes=nodes),
        water=replace(world.water, depth_m=depth),
    )


def braces(world: World) -> list[Member]:
    """Return the inclined members of the jacket that are no legs."""
    nodes, found = world.structure.nodes, []
    for m in world.structure.members:
        along = np.subtract(nodes[m.end], nodes[m.start])
        rise = abs(along[2]) / np.linalg.norm(along)
        if 0.2 < rise < 0.9 and max(nodes[m.start][2], nodes[m.end][2]) < world.site.column_z_m:
            found.append(m)
    return found


def brace_lost(world: World, rng: np.random.Generator) -> World:
    """Return the asset without one piece of a brace."""
    gone = rng.choice([m.name for m in braces(world)])
    weak = _steel(e=1e-3)
    members = tuple(weak(m) if m.name == gone else m for m in world.structure.members)
    return replace(world, structure=replace(world.structure, members=members))


def softer_joints(world: World, factor: float) -> World:
    """Return the asset whose braces are softer, as flexible joint cans make them."""
    names, soft = {m.name for m in braces(world)}, _steel(e=factor)
    members = tuple(soft(m) if m.name in names else m for m in world.structure.members)
    return replace(world, structure=replace(world.structure, members=members))


def feet(world: World, horizontal: np.ndarray | float, vertical: np.ndarray | float) -> World:
    """Return the asset whose feet are changed by factors."""
    return replace(world, horizontal=world.horizontal * horizontal, vertical=world.vertical * vertical)


def _one(n: int, rng: np.random.Generator, factor: float) -> np.ndarray:
    factors = np.ones(n)
    factors[rng.integers(n)] = factor
    return factors


def _unlike(w: World, r: np.random.Generator, s: float) -> World:
    factor = np.exp(r.normal(0.0, 0.15 * s, w.vertical.size))
    return feet(w, factor, factor)


def _rna(w: World, r: np.random.Generator, s: float) -> World:
    return top(w, mass=1.0 + s * r.normal(0.0, 0.015), inertia=1.0 + s * r.normal(0.0, 0.03))


def _arm(w: World, r: np.random.Generator, s: float) -> World:
    return top(w, up=s * r.normal(0.0, 0.2), out=s * r.normal(0.0, 0.2))


def _growth(w: World, r: np.random.Generator, s: float) -> World:
    # where the drawn steel holds the water, its growth too, a quarter of that is left
    most = 0.01 if w.site.holds_water else 0.04
    return grown(w, s * abs(r.normal(0.0, most)), r.uniform(1100.0, 1400.0))


def _steel_of_jacket(w: World, r: np.random.Generator, s: float) -> World:
    e, rho, wall = 1.0 + s * r.normal(0.0, [0.01, 0.02, 0.01])
    return jacket(w, e=e, rho=rho, wall=wall)


def _mixed(w: World, r: np.random.Generator, s: float) -> World:
    w = _steel_of_jacket(_growth(_arm(_rna(w, r, s), r, s), r, s), r, s)
    w = tower(w, e=1.0 + s * r.normal(0.0, 0.015), rho=1.0 + s * r.normal(0.0, 0.01))
    return _unlike(added(w, 1.0 + s * r.normal(0.0, 0.1)), r, s)


Plant = Callable[[World, np.random.Generator, float], World]
COVERED: dict[str, Plant] = {
    "nothing wrong": lambda w, r, s: w,
    "RNA mass and inertia": _rna,
    "RNA arm": _arm,
    "tower stiffness": lambda w, r, s: tower(w, e=1.0 + s * r.normal(0.0, 0.015)),
    "tower mass": lambda w, r, s: tower(w, rho=1.0 + s * r.normal(0.0, 0.01)),
    "jacket steel and walls": _steel_of_jacket,
    "transition piece": lambda w, r, s: piece(w, e=1.0 + s * r.normal(0.0, 0.1)),
    "marine growth": _growth,
    "added mass": lambda w, r, s: added(w, 1.0 + s * r.normal(0.0, 0.1)),
    "one leg flooded": lambda w, r, s: flooded(w, int(r.integers(w.vertical.size))),
    "feet unlike each other": _unlike,
    "depth wrong by 1 m": lambda w, r, s: deeper(w, s * r.choice([-1.0, 1.0])),
    "everything a little": _mixed,
}
"""Within what drawings and the sea leave open; sizes are drawn with the tolerances' deviations times s."""
OUTSIDE: dict[str, Plant] = {
    "another law of the ground": lambda w, r, s: replace(w, law=r.choice(["kelvin-voigt", "springpot"])),
    "soft horizontal feet": lambda w, r, s: feet(w, r.uniform(0.15, 0.3), 1.0),
    "one leg at half": lambda w, r, s: feet(w, f := _one(w.vertical.size, r, 0.5), f),
    "scour at one leg": lambda w, r, s: feet(w, _one(w.vertical.size, r, 0.5), 1.0),
    "brace missing": lambda w, r, s: brace_lost(w, r),
    "softer joint cans": lambda w, r, s: softer_joints(w, r.uniform(0.8, 0.95)),
}
"""What no tolerance stands for."""
KINDS = {**COVERED, **OUTSIDE}


def true_modes(world: World, wanted: tuple[int, ...]) -> tuple[np.ndarray, tuple[int, ...], np.ndarray]:
    """Return the poles (n,) of the asset's modes, named as drawn by their shapes, and their own numbers.

    Also their shapes (n, n_dof).
    """
    assembly = assembly_of(world)
    poles, own = _shapes(world, assembly, OF_ASSET)
    n = world.vertical.size
    plain = replace(
        world,
        structure=drawn(world.site, on_axis=world.on_axis),
        water=drawn_water(drawn(world.site)),
        horizontal=np.full(n, world.horizontal.mean()),
        vertical=np.full(n, world.vertical.mean()),
    )
    _, plan = _shapes(plain, assembly_of(plain), HIGHEST)
    like = np.abs(plan.conj() @ (assembly.mass @ own.T)) ** 2
    sizes = (np.einsum("mi,im->m", one.conj(), assembly.mass @ one.T).real for one in (plan, own))
    _, match = linear_sum_assignment(-like / np.outer(*sizes))
    own_numbers = [int(match[m - 1]) for m in wanted]
    return poles[own_numbers], tuple(number + 1 for number in own_numbers), own[own_numbers]


def _shapes(world: World, assembly: Assembly, highest: int) -> tuple[np.ndarray, np.ndarray]:
    """Return poles (n_modes,) and shapes (n_modes, n_dof) of the asset's first modes."""
    model = _true_model(world, assembly, highest)
    found = model.predict(true_theta(world, model), tuple(range(1, highest + 1))).numbered
    shapes = [
        model.condensed.expand(pole, x) for pole, x in zip(found.poles[0], found.shapes[0], strict=True)
    ]
    return found.poles[0], np.array(shapes)


def _true_model(world: World, assembly: Assembly, highest: int) -> SupportModel:
    return support_model(
        assembly,
        family=family(world.law),
        rayleigh=Rayleigh.minimum(STEEL["ratio"], STEEL["frequency_hz"]),
        tie="per-leg-horizontal-vertical",
        highest_mode=highest,
    )


def true_theta(world: World, model: SupportModel) -> np.ndarray:
    """Return the parameters of every foot's law, with the stiffness and loss of the world."""
    omega = 2.0 * np.pi * model.reference_hz
    per_foot = np.stack([world.horizontal, world.vertical], axis=1).ravel()
    if world.law == "kelvin-voigt":
        return np.stack([per_foot, per_foot * world.loss / omega], axis=1).ravel()
    if world.law == "springpot":
        # its k is the magnitude at the reference frequency, its phase απ/2
        alpha = 2.0 / np.pi * np.arctan(world.loss)
        own = np.stack([per_foot * np.hypot(1.0, world.loss), np.full(per_foot.size, alpha)], axis=1)
        return np.asarray(own.ravel())
    return np.stack([per_foot, np.full(per_foot.size, world.loss)], axis=1).ravel()
