"""Structures from YAML: explicit (nodes and members) or parametric (``jacket:``)."""

from __future__ import annotations

from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.decks.blade_files import read_flexible_rotor
from jackettwin.decks.sacs import is_sacs, read_sacs
from jackettwin.decks.subdyn import read_subdyn
from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files import Schema, find_file, read_yaml, shipped, validate
from jackettwin.files.plausible import refuse_tiny
from jackettwin.structure import Material, Section, Structure, jacket
from jackettwin.structure.appurtenances import hung_on_legs
from jackettwin.structure.jacket import Lattice, Tower, TransitionPiece
from jackettwin.structure.masses import body_from_static_moments
from jackettwin.structure.model import STEEL, Inertia, Member, PointMass, Reaction, RigidLink, Vector
from jackettwin.structure.rotor_modes import FlexibleRotor, with_rotor, without_rotor

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Arm = Annotated[float, Field(ge=-1e3, le=1e3)]
"""From a node to a centre of gravity [m]."""


class MaterialSchema(Schema):
    """An isotropic material; give the shear modulus or Poisson's ratio."""

    youngs_modulus_pa: Positive = STEEL.youngs_modulus_pa
    poisson_ratio: Annotated[float, Field(ge=0.0, lt=0.5)] = 0.3
    shear_modulus_pa: Positive | None = None
    density_kg_m3: NotNegative = STEEL.density_kg_m3

    def build(self, field: str) -> Material:
        """Return the material."""
        with located(field=field):
            refuse_tiny("density_kg_m3", self.density_kg_m3, least=500.0, remedy="kg/m³: steel has 7850")
            if self.shear_modulus_pa is not None:
                return Material(self.youngs_modulus_pa, self.shear_modulus_pa, self.density_kg_m3)
            return Material.isotropic(
                youngs_modulus_pa=self.youngs_modulus_pa,
                poisson_ratio=self.poisson_ratio,
                density_kg_m3=self.density_kg_m3,
            )


class SectionSchema(Schema):
    """A tube."""

    outer_diameter_m: float
    thickness_m: float

    def build(self, field: str) -> Section:
        """Return the section."""
        with located(field=field):
            return Section(self.outer_diameter_m, self.thickness_m)


class BodySchema(Schema):
    """A rigid body: by its centre of gravity, or by static moments and inertia about its node."""

    mass_kg: Annotated[float, Field(ge=0.0, le=1e9)]
    cg_offset_m: tuple[Arm, Arm, Arm] | None = None
    inertia_about_cg_kg_m2: Inertia | None = None
    static_moment_kg_m: Vector | None = None
    inertia_about_node_kg_m2: Inertia | None = None

    def build(self, node: str, part: str = "", *, field: str) -> PointMass:
        """Return the point mass on ``node``."""
        with located(field=field):
            if self.static_moment_kg_m is None and self.inertia_about_node_kg_m2 is None:
                return PointMass(
                    node,
                    self.mass_kg,
                    self.cg_offset_m or (0.0, 0.0, 0.0),
                    self.inertia_about_cg_kg_m2 or (0.0,) * 6,
                    part,
                )
            if self.cg_offset_m is not None or self.inertia_about_cg_kg_m2 is not None or self.mass_kg == 0.0:
                raise InputError(
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


class MemberSchema(Schema):
    """A member: one section, or two if conical."""

    name: str | None = None
    nodes: tuple[str, str]
    section: str | None = None
    sections: tuple[str, str] | None = None
    material: str = "steel"
    part: str = ""


class LinkSchema(Schema):
    """A rigid link."""

    leader: str
    follower: str


class LatticeSchema(Schema):
    """``jacket.lattice``."""

    legs: int = 4
    bays: int = 4
    base_width_m: Positive
    top_width_m: Positive
    height_m: Positive
    leg_diameter_m: float
    leg_thickness_bottom_m: float
    leg_thickness_top_m: float
    brace: SectionSchema | list[SectionSchema]
    material: MaterialSchema = MaterialSchema()
    mud_braces: bool = True
    base_z_m: float = 0.0


class TransitionPieceSchema(Schema):
    """``jacket.transition_piece``."""

    top_z_m: float
    tube: SectionSchema
    column: SectionSchema
    material: MaterialSchema = MaterialSchema()


class TowerSchema(Schema):
    """``jacket.tower``."""

    height_m: Positive
    elements: int = 12
    bottom: SectionSchema
    top: SectionSchema
    material: MaterialSchema = MaterialSchema()


class AppurtenanceSchema(Schema):
    """What hangs on the legs and carries nothing: boat landings, anodes, J-tubes, growth."""

    mass_kg: Annotated[float, Field(ge=0.0, le=1e9)]
    bottom_z_m: float
    top_z_m: float
    legs: list[Annotated[int, Field(ge=1)]] = []


class JacketSchema(Schema):
    """The parametric form."""

    lattice: LatticeSchema
    transition_piece: TransitionPieceSchema
    tower: TowerSchema
    rna: RnaSchema | None = None
    appurtenances: dict[str, AppurtenanceSchema] = {}


class StructureSchema(Schema):
    """A structure file."""

    name: str = ""
    sea_level_z_m: float = 0.0
    jacket: JacketSchema | None = None
    materials: dict[str, MaterialSchema] = {}
    sections: dict[str, SectionSchema] = {}
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


def shipped_structures() -> tuple[str, ...]:
    """Return the names of the structures that come with the package."""
    return shipped("structures")


def read_structure(source: str | Path, *, folder: Path | None = None) -> Structure:
    """Read a structure: a shipped name, a YAML file, an OpenFAST SubDyn input (``.dat``) or a SACS deck.

    Parameters
    ----------
    source : str or Path
    folder : Path, optional
        What a relative path is relative to.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    path = find_file(
        source, "structures", folder=folder, also=", a SubDyn .dat file, or a SACS deck (sacinp.*, *.sacs)"
    )
    if path.suffix.lower() == ".dat":
        return read_subdyn(path)
    if is_sacs(path):
        return read_sacs(path)
    return _read_yaml_structure(path)


def _read_yaml_structure(path: Path) -> Structure:
    schema = validate(StructureSchema, read_yaml(path, what="structure file"), file=path)
    with located(file=path):
        return build_structure(schema, default_name=path.stem, folder=path.parent)


def build_structure(schema: StructureSchema, *, default_name: str, folder: Path | None = None) -> Structure:
    """Return the structure a checked file describes."""
    name = schema.name or default_name
    if schema.jacket is not None:
        given = {
            "nodes",
            "members",
            "sections",
            "materials",
            "rna",
            "rigid_links",
        } & schema.model_fields_set
        if given:
            raise InputError(
                "a parametric jacket defines these itself",
                field=sorted(given)[0],
                remedy="keep jacket: or the explicit form",
            )
        return _build_jacket(schema.jacket, schema, name=name, folder=folder)
    if not schema.members:
        raise InputError(
            "required key is missing", field="members", remedy="add members:, or a parametric jacket:"
        )
    materials = {"steel": STEEL} | {key: m.build(f"materials.{key}") for key, m in schema.materials.items()}
    sections = {key: s.build(f"sections.{key}") for key, s in schema.sections.items()}
    structure = Structure(
        name=name,
        nodes=schema.nodes,
        members=tuple(_build_member(m, i, sections, materials) for i, m in enumerate(schema.members)),
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


def _build_member(
    m: MemberSchema, index: int, sections: dict[str, Section], materials: dict[str, Material]
) -> Member:
    place = f"members.{index}"
    if (m.section is None) == (m.sections is None):
        raise InputError(
            "give section or sections", field=place, remedy="sections: [start, end] makes a cone"
        )
    first, last = m.sections or (m.section or "", m.section or "")
    for key in (first, last):
        if key not in sections:
            raise InputError(
                "no such section",
                field=f"{place}.section",
                value=key,
                remedy=did_you_mean(key, sections) or "define it under sections",
            )
    if m.material not in materials:
        raise InputError(
            "no such material",
            field=f"{place}.material",
            value=m.material,
            remedy=did_you_mean(m.material, materials) or "define it under materials",
        )
    name = m.name or f"{m.nodes[0]}-{m.nodes[1]}"
    return Member(name, *m.nodes, sections[first], sections[last], materials[m.material], m.part)


def _build_jacket(
    schema: JacketSchema, around: StructureSchema, *, name: str, folder: Path | None
) -> Structure:
    """Return a parametric jacket, with the bodies and the settings that stand around it in the file."""
    lattice, tp, tower = schema.lattice, schema.transition_piece, schema.tower
    with located(field="jacket"):
        structure = jacket(
            name=name,
            lattice=Lattice(
                legs=lattice.legs,
                bays=lattice.bays,
                base_width_m=lattice.base_width_m,
                top_width_m=lattice.top_width_m,
                height_m=lattice.height_m,
                leg_diameter_m=lattice.leg_diameter_m,
                leg_thickness_bottom_m=lattice.leg_thickness_bottom_m,
                leg_thickness_top_m=lattice.leg_thickness_top_m,
                brace=tuple(b.build(f"lattice.brace.{i}") for i, b in enumerate(lattice.brace))
                if isinstance(lattice.brace, list)
                else lattice.brace.build("lattice.brace"),
                material=lattice.material.build("lattice.material"),
                mud_braces=lattice.mud_braces,
                base_z_m=lattice.base_z_m,
            ),
            transition_piece=TransitionPiece(
                tp.top_z_m,
                tp.tube.build("transition_piece.tube"),
                tp.column.build("transition_piece.column"),
                tp.material.build("transition_piece.material"),
            ),
            tower=Tower(
                tower.height_m,
                tower.elements,
                tower.bottom.build("tower.bottom"),
                tower.top.build("tower.top"),
                tower.material.build("tower.material"),
            ),
            rna=None,
            sea_level_z_m=around.sea_level_z_m,
        )
        hung: list[PointMass] = []
        for key, a in schema.appurtenances.items():
            with located(field=f"appurtenances.{key}"):
                hung += hung_on_legs(structure, key, a.mass_kg, a.bottom_z_m, a.top_z_m, a.legs)
    bodies = [m.build(m.node, field=f"masses.{i}") for i, m in enumerate(around.masses)]
    structure = replace(
        structure,
        masses=(*hung, *bodies),
        beam=around.beam,
        rotary_inertia=around.rotary_inertia,
        subdivide=around.subdivide,
    )
    return structure if schema.rna is None else schema.rna.stand_on(structure, folder=folder)
