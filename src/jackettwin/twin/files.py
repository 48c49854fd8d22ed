"""Twin files: YAML to a checked configuration."""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files import Schema, find_file, read_mapping, read_yaml, shipped, validate
from jackettwin.identification import IdentificationSettings
from jackettwin.identification.picks import Pick, parse_picks, refuse_strangers
from jackettwin.loads.conditions import SeaState
from jackettwin.response.sensors import Sensor
from jackettwin.simulate.files import depth_of
from jackettwin.simulate.water_files import WaterSchema, water_members
from jackettwin.structure import Rayleigh, Structure, read_structure
from jackettwin.structure.files import BodySchema
from jackettwin.twin.config import ModelError, TwinConfig, UpdateSettings
from jackettwin.twin.water import WaterConfig
from jackettwin.updating import DEFAULT_LAWS, Parameter, Target, family
from jackettwin.updating.extras import DASHPOTS, Extras

Positive = Annotated[float, Field(gt=0.0)]
Ratio = Annotated[float, Field(ge=0.0, lt=1.0)]
Vector = tuple[float, float, float]


class SteelSchema(Schema):
    """Factors on the stiffness (E and G) and the density of a part."""

    youngs_modulus: Positive = 1.0
    density: Positive = 1.0


class StructureChoice(Schema):
    """A structure with overrides; ``steel`` is what ``jackettwin refine`` prints."""

    source: str
    rna: BodySchema | None = None
    steel: dict[str, SteelSchema] = {}

    def build(self, folder: Path) -> Structure:
        """Return the structure, refined; its rotor–nacelle assembly is left to the caller."""
        structure = read_structure(self.source, folder=folder)
        for part, factors in self.steel.items():
            with located(field="structure.steel"):
                structure = structure.with_material(part, **factors.model_dump())
        return structure


StructureOrName = Annotated[
    StructureChoice, BeforeValidator(lambda given: {"source": given} if isinstance(given, str) else given)
]


class RayleighSchema(Schema):
    """Steel damping: a least ratio and where it stands."""

    ratio: Ratio
    frequency_hz: Positive


class DampingSchema(Schema):
    """``damping``."""

    rayleigh: RayleighSchema


class SupportSchema(Schema):
    """``support``: the law to report first, what shares parameters, and pile heads that the laws scale.

    ``shared`` parameters have one value for all tie groups; ``scatter`` says by how much, in ln θ, the others
    may be expected to differ between them.
    """

    law: str | None = None
    tie: Literal["all", "horizontal-vertical", "per-leg"] = "all"
    stiffness: str | None = None
    shared: list[str] = []
    scatter: dict[str, Annotated[float, Field(gt=0.0, le=3.0)]] = {}


class SensorSchema(Schema):
    """A sensor: where a channel of the record sits in the structure."""

    channel: str
    node: str | None = None
    height_m: float | None = None
    direction: Vector


class TargetSchema(Schema):
    """A mode known from elsewhere."""

    mode: Annotated[int, Field(ge=1, le=50)]
    frequency_hz: Positive | None = None
    frequency_std_hz: Positive | None = None
    damping_ratio: Annotated[float, Field(gt=0.0, lt=1.0)] | None = None
    damping_ratio_std: Positive | None = None
    correlation: Annotated[float, Field(gt=-1.0, lt=1.0)] = 0.0


class ModelErrorSchema(Schema):
    """How well the model itself can be expected to meet some modes."""

    modes: list[Annotated[int, Field(ge=1, le=50)]]
    frequency: Ratio = 0.0
    damping: Ratio = 0.0


class PriorSchema(Schema):
    """A lognormal prior."""

    median: Positive
    log_std: Positive


class UpdateSchema(Schema):
    """``update``."""

    laws: list[str] = Field(default=list(DEFAULT_LAWS), min_length=1)
    method: Literal["least-squares", "nelder-mead"] = "least-squares"
    starts: Annotated[int, Field(ge=1, le=10000)] = 32
    seed: Annotated[int, Field(ge=0)] = 0
    particles: Annotated[int, Field(ge=20, le=100000)] = 150
    sampler: Literal["smc", "nested"] = "smc"
    bounds: dict[str, tuple[float, float]] = {}
    priors: dict[str, PriorSchema] = {}
    weighting: Literal["auto", "relative", "covariance"] = "auto"
    modes: list[Annotated[int, Field(ge=1, le=50)]] = [1, 2, 3, 4, 5]
    damping_of: Literal["fore_aft", "all", "none"] | list[str] = "fore_aft"
    model_error: list[ModelErrorSchema] = []
    mac_std: Positive | None = None
    dashpots: list[Literal["c_fore_aft", "c_side_side"]] = []
    rotor: str | None = None
    shaft: Literal["locked", "free"] = "locked"
    wind_speed_m_s: Positive | None = None
    water: list[Literal["water_mass", "water_damping"]] = []
    steel_damping: Literal["fixed", "free"] = "fixed"


class SeaSchema(Schema):
    """``sea``: the mean sea of the records, a JONSWAP spectrum."""

    hs_m: Positive
    tp_s: Positive
    direction_deg: float = 0.0


class TwinSchema(Schema):
    """A twin file."""

    structure: StructureOrName
    rna: BodySchema | None = None
    beam: Literal["euler-bernoulli", "timoshenko"] | None = None
    rotary_inertia: bool | None = None
    subdivide: Annotated[int, Field(ge=1, le=1000)] | None = None
    gravity: bool = False
    damping: DampingSchema | None = None
    water: WaterSchema | None = None
    sea: SeaSchema | None = None
    support: SupportSchema = SupportSchema()
    sensors: list[SensorSchema] = []
    records: list[str] = []
    targets: list[TargetSchema] = []
    identification: dict[str, Any] = {}
    update: UpdateSchema = UpdateSchema()


def shipped_twins() -> tuple[str, ...]:
    """Return the names of the twins that come with the package."""
    return shipped("twins")


def read_twin(source: str | Path, *, records_follow: bool = False) -> TwinConfig:
    """Read a twin: a shipped name or a YAML file.

    Parameters
    ----------
    records_follow : bool
        The records come from elsewhere: the file need not name any, nor targets.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    path = find_file(source, "twins")
    schema = validate(TwinSchema, read_yaml(path, what="twin file"), file=path)
    with located(file=path):
        given = [key for key in ("records", "targets") if getattr(schema, key)]
        if len(given) != 1 and not (records_follow and not given):
            raise InputError(
                "give records or targets",
                field="records",
                remedy="records: [file, …] or targets: [{mode: 1, …}, …]",
            )
        return _build(schema, path)


def _build(schema: TwinSchema, path: Path) -> TwinConfig:
    if len({s.channel for s in schema.sensors}) != len(schema.sensors):
        raise InputError(
            "a channel is given twice", field="sensors", value=[s.channel for s in schema.sensors]
        )
    if schema.support.law:
        with located(field="support.law"):
            family(schema.support.law)
    for i, law in enumerate(schema.update.laws):
        with located(field=f"update.laws.{i}"):
            family(law)
    with located(field="update"):
        _check_update(schema.update)
    with located(field="support"):
        _check_ties(schema.support, schema.update)
    damping = schema.damping.rayleigh if schema.damping is not None else None
    structure = _structure(schema, path.parent)
    return TwinConfig(
        name=path.stem,
        path=path,
        structure=structure,
        beam=schema.beam,
        rotary_inertia=schema.rotary_inertia,
        subdivide=schema.subdivide,
        gravity=schema.gravity,
        rayleigh=Rayleigh() if damping is None else Rayleigh.minimum(damping.ratio, damping.frequency_hz),
        rayleigh_ratio=0.0 if damping is None else damping.ratio,
        water=_water(schema, structure, path.parent),
        tie=schema.support.tie,
        shared=tuple(dict.fromkeys(schema.support.shared)),
        scatter=dict(schema.support.scatter),
        heads=schema.support.stiffness,
        sensors=tuple(Sensor(s.channel, s.direction, s.node, s.height_m) for s in schema.sensors),
        records=tuple(path.parent / record for record in schema.records),
        targets=tuple(Target(**target.model_dump()) for target in schema.targets),
        identification=_identification(schema.identification),
        picks=_picks(schema.identification, path.parent, [Path(record).stem for record in schema.records]),
        update=_update_settings(schema, path.parent),
    )


def _identification(given: dict[str, Any]) -> IdentificationSettings:
    with located(field="identification"):
        return IdentificationSettings.from_mapping({k: v for k, v in given.items() if k != "picks"})


def _picks(given: dict[str, Any], folder: Path, records: list[str]) -> tuple[Pick, ...]:
    """Return the picks of ``identification.picks``: a list, or the name of a file of them."""
    source = given.get("picks")
    if isinstance(source, str):
        path = folder / source
        with located(file=path):
            picks = parse_picks(read_mapping(path, what="file of picks"))
            refuse_strangers(picks, records)
            return picks
    with located(field="identification"):
        picks = () if source is None else parse_picks(source)
        refuse_strangers(picks, records)
        return picks


def _check_ties(support: SupportSchema, update: UpdateSchema) -> None:
    known = sorted({p.name for law in (*DEFAULT_LAWS, *update.laws) for p in family(law).parameters})
    for field, names in (("shared", support.shared), ("scatter", [*support.scatter])):
        for name in names:
            if name not in known:
                raise InputError(
                    "no law has such a parameter",
                    field=field,
                    value=name,
                    allowed=", ".join(known),
                    remedy=did_you_mean(name, known),
                )
        if names and support.tie == "all":
            raise InputError(
                "all supports share all parameters already",
                field=field,
                value=names,
                remedy="tie: per-leg or horizontal-vertical",
            )
    both = set(support.shared) & set(support.scatter)
    if both:
        raise InputError("a parameter is shared or scatters, not both", field="scatter", value=sorted(both))


def _check_update(update: UpdateSchema) -> None:
    """Refuse unknown bounds and priors now, not after the records have been identified."""
    known = {p.name for law in (*DEFAULT_LAWS, *update.laws) for p in family(law).parameters}
    known |= {p.name for p in Extras(_dashpots(update), rayleigh=True).parameters} | set(update.water)
    for field, given in (("bounds", update.bounds), ("priors", update.priors)):
        for name in given:
            if not any(name == k or name.startswith(f"{k}_") for k in known):
                raise InputError(
                    "no law has such a parameter",
                    field=f"{field}.{name}",
                    value=name,
                    allowed=", ".join(sorted(known)),
                    remedy=did_you_mean(name, sorted(known)),
                )
    for name, (low, high) in update.bounds.items():
        Parameter(name, low, high, "")


def _dashpots(update: UpdateSchema) -> tuple[str, ...]:
    """Return the dashpots of the rotor: those asked for, all where a rotor is given without."""
    return tuple(dict.fromkeys(update.dashpots or (DASHPOTS if update.rotor else ())))


def _structure(schema: TwinSchema, folder: Path) -> Structure:
    choice = (
        schema.structure
        if isinstance(schema.structure, StructureChoice)
        else StructureChoice(source=schema.structure)
    )
    structure = choice.build(folder)
    rna = schema.rna or choice.rna
    if rna is None:
        return structure
    top = structure.top_node
    others = tuple(mass for mass in structure.masses if mass.node != top)
    return structure.with_masses((*others, rna.build(top, part="rna", field="rna")))


def _water(schema: TwinSchema, structure: Structure, folder: Path) -> WaterConfig | None:
    """Return the water; a sea alone is water without growth."""
    sea, given = schema.sea, schema.water
    if sea is None and given is None:
        return None
    given = given or WaterSchema()
    members = water_members(given, structure, folder)
    return WaterConfig(
        depth_m=depth_of(given, structure),
        coefficients=members.coefficients,
        carried=members.water,
        adds_mass=members.adds_mass,
        sea=None if sea is None else SeaState(sea.hs_m, sea.tp_s, radians(sea.direction_deg)),
    )


def _beside(name: str, folder: Path) -> str:
    """Return a file beside the twin's, or the name of a shipped one."""
    return str(folder / name) if Path(name).suffix else name


def _update_settings(schema: TwinSchema, folder: Path) -> UpdateSettings:
    u = schema.update
    first = [schema.support.law] if schema.support.law else []
    return UpdateSettings(
        laws=tuple(dict.fromkeys([*first, *u.laws])),
        method=u.method,
        starts=u.starts,
        seed=u.seed,
        particles=u.particles,
        sampler=u.sampler,
        bounds=dict(u.bounds),
        priors={name: (p.median, p.log_std) for name, p in u.priors.items()},
        weighting=u.weighting,
        modes=tuple(u.modes),
        damping_of=u.damping_of if isinstance(u.damping_of, str) else tuple(u.damping_of),
        model_errors=tuple(ModelError(tuple(e.modes), e.frequency, e.damping) for e in u.model_error),
        mac_std=u.mac_std,
        dashpots=_dashpots(u),
        rotor=None if u.rotor is None else _beside(u.rotor, folder),
        shaft=u.shaft,
        wind_speed_m_s=u.wind_speed_m_s,
        water=tuple(dict.fromkeys(u.water)),
        steel_damping=u.steel_damping,
    )
