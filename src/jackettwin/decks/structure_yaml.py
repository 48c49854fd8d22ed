"""Structures from YAML: explicit (nodes and members) or parametric (``jacket:``)."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.decks.blade_files import read_flexible_rotor
from jackettwin.decks.sections_yaml import SHAPES, SectionInFile, TubeSchema, build_tube
from jackettwin.decks.tower import TowerSchema
from jackettwin.errors import InputError, located, look_up, require
from jackettwin.files import Angle, Placed, Schema, read_yaml, validate
from jackettwin.structure import (
    STEEL,
    Beam,
    FlexibleRotor,
    Member,
    PointMass,
    Reaction,
    RigidLink,
    Structure,
    Vector,
    body_from_static_moments,
    jacket,
    with_rotor,
    without_rotor,
)
from jackettwin.structure.appurtenances import Appurtenance
from jackettwin.structure.jacket import Lattice, MaterialInFile, Tower, TransitionPiece
from jackettwin.structure.model import Inertia

Arm = Annotated[float, Field(ge=-1e3, le=1e3)]
"""From a node to a centre of gravity [m]."""


class BodySchema(Schema):
    """A rigid body: by its centre of gravity, or by static moments and inertia about its node."""

    mass_kg: Annotated[float, Field(ge=0.0, le=1e9)]
    cg_offset_m: tuple[Arm, Arm, Arm] | None = None
    inertia_about_cg_kg_m2: Inertia | None = None
    static_moment_kg_m: Vector | None = None
    inertia_about_node_kg_m2: Inertia | None = None

    def build(self, node: str, part: str = "", *, field: str) -> PointMass:
        """Return the point mass on ``node``."""
        with located(field=field), self._own_keys():
            if self.static_moment_kg_m is None and self.inertia_about_node_kg_m2 is None:
                return PointMass(
                    node,
                    self.mass_kg,
                    self.cg_offset_m or (0.0, 0.0, 0.0),
                    self.inertia_about_cg_kg_m2 or (0.0,) * 6,
                    part,
                )
            require(
                self.cg_offset_m is None and self.inertia_about_cg_kg_m2 is None and self.mass_kg > 0.0,
                "give a body either by its centre of gravity or by its moments about the node",
                field="mass_kg",
                value=self.mass_kg,
                remedy="keep cg_offset_m and inertia_about_cg_kg_m2, or the other two",
            )
            return body_from_static_moments(
                node=node,
                mass_kg=self.mass_kg,
                static_moment_kg_m=self.static_moment_kg_m or (0.0, 0.0, 0.0),
                inertia_about_node_kg_m2=self.inertia_about_node_kg_m2 or (0.0,) * 6,
                part=part,
            )

    @contextmanager
    def _own_keys(self) -> Iterator[None]:
        """Name the key of the file in an error on the inertia."""
        try:
            yield
        except InputError as error:
            if error.field == "inertia_kg_m2":
                about = "cg" if self.inertia_about_node_kg_m2 is None else "node"
                error.field = f"inertia_about_{about}_kg_m2"
            raise


class BladesSchema(Schema):
    """Bending blades of a rotor–nacelle assembly: a turbine's file, and how they are pitched."""

    rotor: str
    pitch_deg: Annotated[float, Field(ge=-180.0, le=180.0)] | None = None
    damping_ratio: Annotated[float, Field(ge=0.0, le=0.5)] | None = None

    def build(self, folder: Path | None) -> FlexibleRotor:
        """Return the rotor."""
        with located(field="rna.blades"):
            rotor = read_flexible_rotor(self.rotor, folder=folder)
        if self.damping_ratio is not None:
            rotor = replace(rotor, blade=replace(rotor.blade, damping_ratio=self.damping_ratio))
        return rotor if self.pitch_deg is None else replace(rotor, pitch=radians(self.pitch_deg))


class RnaSchema(BodySchema):
    """A rotor–nacelle assembly: a rigid body, blades included, and how these bend."""

    blades: BladesSchema | None = None

    def stand_on(self, structure: Structure, *, folder: Path | None) -> Structure:
        """Return the structure with this in the place of what stood on its top."""
        top = structure.top_node
        others = tuple(mass for mass in structure.masses if mass.node != top)
        bare = without_rotor(structure).with_masses((*others, self.build(top, part="rna", field="rna")))
        return bare if self.blades is None else with_rotor(bare, self.blades.build(folder), top)


class MassSchema(BodySchema):
    """A rigid body on a named node."""

    node: str


class BarSchema(Schema):
    """Sections of a bar: one, or two if conical; ``twist_deg`` turns other sections than tubes."""

    section: str | None = None
    sections: tuple[str, str] | None = None
    twist_deg: Angle | None = None
    material: str = "steel"


class MemberSchema(BarSchema):
    """A member and where it stands."""

    name: str | None = None
    nodes: tuple[str, str]
    part: str = ""


class LinkSchema(Schema):
    """A rigid link."""

    leader: str
    follower: str


class JacketSchema(Schema):
    """The parametric form."""

    lattice: Placed[Lattice]
    transition_piece: Placed[TransitionPiece]
    tower: Placed[Tower]
    rna: RnaSchema | None = None
    appurtenances: dict[str, Placed[Appurtenance]] = {}
    members: dict[str, BarSchema] = {}


class StructureSchema(Schema):
    """A structure file."""

    name: str = ""
    sea_level_z_m: float = 0.0
    jacket: JacketSchema | None = None
    foundation: str | None = None
    tower: TowerSchema | None = None
    materials: dict[str, MaterialInFile] = {}
    sections: dict[str, SectionInFile] = {}
    nodes: dict[str, Vector] = {}
    members: list[MemberSchema] = []
    masses: list[MassSchema] = []
    rna: RnaSchema | None = None
    rigid_links: list[LinkSchema] = []
    reaction_nodes: list[str] = []
    interface_nodes: list[str] = []
    beam: Literal["euler-bernoulli", "timoshenko"] = "euler-bernoulli"
    rotary_inertia: bool = False
    subdivide: Annotated[int, Field(ge=1, le=1000)] = 1


Read = Callable[[str, Path | None], Structure]
"""Reads a structure of any format, by its name and the folder that this is relative to."""


def read_yaml_structure(path: Path, read: Read) -> Structure:
    """Read a structure from a YAML file; ``read`` reads the foundation that it names.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    schema = validate(StructureSchema, read_yaml(path, what="structure file"), file=path)
    with located(file=path):
        return build_structure(schema, read, default_name=path.stem, folder=path.parent)


def build_structure(
    schema: StructureSchema, read: Read, *, default_name: str, folder: Path | None = None
) -> Structure:
    """Return the structure a checked file describes."""
    name = schema.name or default_name
    if schema.foundation is not None or schema.tower is not None:
        return replace(_on_foundation(schema, read, folder), name=name)
    if schema.jacket is not None:
        own = {"nodes", "members", "rna", "rigid_links"} & schema.model_fields_set
        require(
            not own,
            "a parametric jacket defines these itself",
            field=min(own, default=None),
            remedy="keep jacket: or the explicit form; jacket.members takes sections of your own",
        )
        return _build_jacket(schema.jacket, schema, name=name, folder=folder)
    remedy = "add members:, or a parametric jacket:"
    require(schema.members, "required key is missing", field="members", remedy=remedy)
    bars = [_build_bar(m, f"members.{i}", schema) for i, m in enumerate(schema.members)]
    members, beams = _sorted(bars)
    structure = Structure(
        name=name,
        nodes=schema.nodes,
        members=members,
        beams=beams,
        masses=tuple(m.build(m.node, field=f"masses.{i}") for i, m in enumerate(schema.masses)),
        rigid_links=tuple(RigidLink(link.leader, link.follower) for link in schema.rigid_links),
        reactions=tuple(Reaction(node) for node in schema.reaction_nodes),
        interface_nodes=tuple(schema.interface_nodes),
        sea_level_z_m=schema.sea_level_z_m,
        subdivide=schema.subdivide,
        beam=schema.beam,
        rotary_inertia=schema.rotary_inertia,
    )
    return structure if schema.rna is None else schema.rna.stand_on(structure, folder=folder)


def _on_foundation(schema: StructureSchema, read: Read, folder: Path | None) -> Structure:
    """Return a foundation from another file, with its tower, and the bodies of this one."""
    kept = {"name", "foundation", "tower", "rna", "masses", "interface_nodes"}
    for key in sorted(schema.model_fields_set - kept):
        raise InputError(
            "a foundation from another file defines this itself",
            field=key,
            allowed=", ".join(sorted(kept)),
            remedy="take it out, or write it into the foundation's own file",
        )
    for key in ("foundation", "tower"):
        require(getattr(schema, key), "required key is missing", field=key, remedy=f"add {key!r}")
    assert schema.foundation is not None and schema.tower is not None
    structure = read(schema.foundation, folder)
    if schema.interface_nodes:
        structure = replace(structure, interface_nodes=tuple(schema.interface_nodes))
    structure = schema.tower.stand_on(structure, folder=folder)
    bodies = tuple(m.build(m.node, field=f"masses.{i}") for i, m in enumerate(schema.masses))
    structure = structure.with_masses((*structure.masses, *bodies))
    return structure if schema.rna is None else schema.rna.stand_on(structure, folder=folder)


def _build_bar(m: MemberSchema, place: str, schema: StructureSchema) -> Member | Beam:
    """Return a tube, or a beam of another section."""
    one = (m.section is None) != (m.sections is None)
    require(one, "give section or sections", field=place, remedy="sections: [start, end] makes a cone")
    names = m.sections or (m.section or "",) * 2
    start, end = (
        look_up(schema.sections, key, "section", field=f"{place}.section", remedy="define it under sections")
        for key in names
    )
    materials, remedy = {"steel": STEEL} | schema.materials, "define it under materials"
    material = look_up(materials, m.material, "material", field=f"{place}.material", remedy=remedy)
    name = m.name or f"{m.nodes[0]}-{m.nodes[1]}"
    if isinstance(start, TubeSchema):
        turned = "a tube is the same however it is turned"
        require(
            m.twist_deg is None,
            turned,
            field=f"{place}.twist_deg",
            value=m.twist_deg,
            remedy="take it out, or give the section a shape that is no tube",
        )
        remedy = "a cone has a tube at both ends"
        first, last = (
            build_tube(key, given, remedy=remedy) for key, given in zip(names, (start, end), strict=True)
        )
        return Member(name, *m.nodes, first, last, material, m.part)
    require(
        start is end,
        "only tubes can change along a member",
        field=f"{place}.sections",
        value=list(names),
        remedy="cut it into members of one section each",
    )
    with located(field=f"sections.{names[0]}"):
        section = start.build(material.poisson_ratio)
    return Beam(name, *m.nodes, section, material, radians(m.twist_deg or 0.0), m.part, SHAPES[start.shape])


def _sorted(bars: Iterable[Member | Beam]) -> tuple[tuple[Member, ...], tuple[Beam, ...]]:
    """Return the tubes and the beams of other sections."""
    bars = tuple(bars)
    tubes = tuple(bar for bar in bars if isinstance(bar, Member))
    return tubes, tuple(bar for bar in bars if isinstance(bar, Beam))


def _with_own_sections(structure: Structure, own: dict[str, BarSchema], file: StructureSchema) -> Structure:
    """Return a parametric jacket with the sections that a file gives members of it by name.

    Parameters
    ----------
    own : by the members' names, in which ``*`` stands for anything; of several that name one the last counts

    Raises
    ------
    InputError
        If nothing is named so, or a section or material is missing or does not fit.
    """
    bars: dict[str, Member | Beam] = {m.name: m for m in structure.members}
    ends = {m.name: (m.start, m.end, m.part) for m in structure.members}
    for pattern, given in own.items():
        place, named = f"members.{pattern}", fnmatch.filter(bars, pattern)
        kinds = ", ".join(sorted({re.sub(r"\d+.*", "*", name) for name in bars}))
        remedy = "jackettwin view names the members; * stands for anything"
        require(named, "no member is named so", field=place, value=pattern, allowed=kinds, remedy=remedy)
        for name in named:
            start, end, part = ends[name]
            whole = MemberSchema(name=name, nodes=(start, end), part=part, **given.model_dump())
            bars[name] = _build_bar(whole, place, file)
    members, beams = _sorted(bars.values())
    return replace(structure, members=members, beams=beams)


def _build_jacket(
    schema: JacketSchema, around: StructureSchema, *, name: str, folder: Path | None
) -> Structure:
    """Return a parametric jacket, with the bodies and the settings that stand around it in the file."""
    masses: list[PointMass] = []
    with located(field="jacket"):
        structure = jacket(
            name=name,
            lattice=schema.lattice,
            transition_piece=schema.transition_piece,
            tower=schema.tower,
            rna=None,
            sea_level_z_m=around.sea_level_z_m,
        )
        structure = _with_own_sections(structure, schema.members, around)
        for key, appurtenance in schema.appurtenances.items():
            with located(field=f"appurtenances.{key}"):
                masses += appurtenance.on(structure, key)
    masses += [m.build(m.node, field=f"masses.{i}") for i, m in enumerate(around.masses)]
    structure = replace(
        structure,
        masses=tuple(masses),
        beam=around.beam,
        rotary_inertia=around.rotary_inertia,
        subdivide=around.subdivide,
    )
    return structure if schema.rna is None else schema.rna.stand_on(structure, folder=folder)
