"""Reading of twin files: from YAML to a checked configuration."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.errors import InputError, did_you_mean, located, look_up, require
from jackettwin.files import find_file, read_mapping, read_yaml, shipped, validate
from jackettwin.identification import IdentificationSettings, Pick, parse_picks, refuse_strangers
from jackettwin.loads import SeaState, WaterSchema, depth_of, water_members
from jackettwin.records.readers import formats
from jackettwin.response import mode_kinds, mode_labels, read_mode_label
from jackettwin.soil import DEFAULT_LAWS, MUDLINE, Parameter, family, members, tied_at_mudline
from jackettwin.structure import RayleighSchema, Structure, without_rotor
from jackettwin.twin.config import (
    PAIRED_MODES,
    USUAL_MODES,
    GivenRelaxation,
    ToleranceSchema,
    TwinConfig,
    TwinTolerances,
    UpdateSettings,
    assembled,
)
from jackettwin.twin.life.settings import LifeSettings
from jackettwin.twin.schema import DampingSchema, SupportSchema, TwinSchema
from jackettwin.twin.stated_model import model_of_records
from jackettwin.twin.targets_table import assigned_modes, read_targets_table
from jackettwin.twin.tolerances.registry import REMAINDERS, tolerances
from jackettwin.twin.water import WaterConfig
from jackettwin.updating import (
    DASHPOTS,
    SIDES,
    SPLIT_LEGS,
    NuisanceParameters,
    Target,
    matrix_of,
    numbered_modes,
)

MOST_OF_A_TABLE = 100_000
"""Size of a file above which it is no table of modes [bytes]: a line of one has less than a hundred."""
_STRUCTURE_KEYS = {"jacket", "members"}
"""Keys of which every structure file has one and no twin file has any."""


def shipped_twins() -> tuple[str, ...]:
    """Return the names of the twins that the package contains."""
    return shipped("twins")


def read_twin(source: str | Path, *, records_follow: bool = False) -> TwinConfig:
    """Read a twin: a shipped name or a YAML file.

    Parameters
    ----------
    records_follow : bool
        Whether records are supplied later, so that the file needs neither records nor targets.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    path = find_file(source, "twins")
    given_keys = _keys(path)
    if isinstance(given_keys, dict) and isinstance(given_keys.get("targets"), str):
        given_keys = {**given_keys, "targets": read_targets_table(path.parent / given_keys["targets"])}
    stated = _stated(given_keys, path.parent)
    schema = validate(TwinSchema, {**stated, **given_keys} if stated else given_keys, file=path)
    with located(file=path):
        given = [key for key in ("records", "targets") if getattr(schema, key)]
        require(
            len(given) == 1 or (records_follow and not given),
            "give records or targets",
            field="records",
            remedy="records: [file, …] or targets: [{mode: 1, …}, …]",
        )
        numbered = _with_numbers(schema, path)
        pairs = zip(schema.targets, numbered.targets, strict=True)
        assigned = tuple(after.number or 0 for before, after in pairs if before.is_unnamed)
        return replace(_build(numbered, path), assigned=assigned, of_records=tuple(stated))


def _stated(keys: object, folder: Path) -> dict[str, Any]:
    """Return the modelling keys that the records state and the twin file omits."""
    records = keys.get("records") if isinstance(keys, dict) else None
    if not isinstance(keys, dict) or not isinstance(records, list):
        return {}
    said = model_of_records(folder / name for name in records if isinstance(name, str))
    return {key: value for key, value in said.items() if key not in keys}


def _is_table_of_modes(path: Path) -> bool:
    try:
        return path.stat().st_size < MOST_OF_A_TABLE and bool(read_targets_table(path))
    except (InputError, OSError):
        return False


def _keys(path: Path) -> dict[str, Any]:
    """Return the keys of a twin file; the error for a structure or record states how to make a twin of it."""
    is_record = any(path.suffix.lower() in form.extensions for form in formats())
    require(
        not (is_record and _is_table_of_modes(path)), "is a table of modes, not a twin", file=path,
        remedy=f"name it in a twin file: structure: FILE and targets: {path.name}",
    )  # fmt: skip
    remedy = f"jackettwin init STRUCTURE {path} writes a twin"
    require(not is_record, "is a record, not a twin", file=path, remedy=remedy)
    found = read_yaml(path, what="twin file")
    is_twin = "structure" in found or _STRUCTURE_KEYS.isdisjoint(found)
    remedy = f"jackettwin init {path} RECORD… writes a twin"
    require(is_twin, "is a structure, not a twin", file=path, remedy=remedy)
    return found


def _with_numbers(schema: TwinSchema, path: Path) -> TwinSchema:
    """Return the schema with numbers for modes given by name (``mode: 1st FA``) or by frequency only."""
    unnamed = [i for i, target in enumerate(schema.targets) if target.is_unnamed]
    if not unnamed and not any(isinstance(target.mode, str) for target in schema.targets):
        return schema
    of_rotor = schema.update.model_dump(include={"rotor", "rotor_state"})
    update = UpdateSettings.model_validate(of_rotor)
    assembly = assembled(_build(schema.model_copy(update={"targets": [], "update": update}), path))
    numbered = numbered_modes(assembly, PAIRED_MODES)
    labels = mode_labels(mode_kinds(assembly, numbered.shapes, numbered.frequency_hz))
    targets = []
    for i, target in enumerate(schema.targets):
        if isinstance(target.mode, str):
            with located(field=f"targets.{i}"):
                target = target.model_copy(update={"mode": _number(target.mode, labels)})
        targets.append(target)
    frequencies = np.array([targets[i].frequency_hz for i in unnamed])
    taken = {target.number for target in targets if target.number is not None}
    with located(field="targets"):
        modes = assigned_modes(frequencies, numbered.frequency_hz, taken)
    for i, mode in zip(unnamed, modes, strict=True):
        targets[i] = targets[i].model_copy(update={"mode": mode})
    return schema.model_copy(update={"targets": targets})


def _number(name: str, labels: tuple[str, ...]) -> int:
    if name.strip().isdigit():
        return int(name)
    label = read_mode_label(name)
    require(
        label in labels,
        "no mode of the structure has this name",
        field="mode",
        value=name,
        allowed=", ".join(labels),
        remedy=did_you_mean(label, labels) or "jackettwin modes lists them",
    )
    return labels.index(label) + 1


def _build(schema: TwinSchema, path: Path) -> TwinConfig:
    channels, folder, support = [s.channel for s in schema.sensors], path.parent, schema.support
    require(len({*channels}) == len(channels), "a channel is given twice", field="sensors", value=channels)
    for field, law in (("support.law", support.law), *_numbered("update.laws", schema.update.laws)):
        with located(field=field):
            for name in members([law or DEFAULT_LAWS[0]]):
                family(name)
    with located(field="update"):
        _check_update(schema.update, {target.number for target in schema.targets})
    with located(field="support"):
        _check_ties(support, schema.update)
    with located(field="logger"):
        defaults = schema.logger.build()
    low, high = schema.rotor_speed_rpm or (0.0, 0.0)
    require(
        low <= high,
        "the rotor's lowest speed exceeds its highest",
        field="rotor_speed_rpm",
        value=[low, high],
        allowed="[lowest, highest]",
    )
    targets, relaxations = _targets(schema)
    damping = schema.damping or DampingSchema()
    steel = damping.rayleigh or RayleighSchema(ratio=0.0, frequency_hz=1.0)
    require(
        not damping.modes or schema.update.steel_damping == "fixed",
        "the steel's damping cannot be both given by mode and free",
        field="damping.modes",
        value=list(damping.modes),
        remedy="omit damping.modes or update.steel_damping: free",
    )
    structure = _structure(schema, folder).with_theory(schema.beam, schema.rotary_inertia)
    if schema.update.rotor is not None and schema.update.rotor_state == "operating":
        structure = without_rotor(structure)  # the blades bend in what the rotor adds at work
    return TwinConfig(
        name=path.stem,
        path=path,
        structure=structure,
        beam=schema.beam,
        rotary_inertia=schema.rotary_inertia,
        subdivide=schema.subdivide,
        gravity=schema.gravity,
        rayleigh=steel.build(),
        rayleigh_ratio=steel.least,
        mode_damping=damping.modes,
        water=_water(schema, structure, folder),
        tie=support.tie,
        shared=tuple(dict.fromkeys(support.shared)),
        scatter=dict(support.scatter),
        heads=support.stiffness,
        sensors=tuple(sensor.build() for sensor in schema.sensors),
        calibrations=tuple(c for sensor in schema.sensors for c in sensor.history()),
        operation=schema.operation,
        watch=schema.watch,
        life=_life(schema.life),
        records=tuple(folder / record for record in schema.records),
        defaults=defaults,
        targets=targets,
        shapes=_shapes(schema, targets),
        relaxations=relaxations,
        identification=_identification(schema.identification),
        picks=_picks(schema.identification, folder, [Path(record).stem for record in schema.records]),
        update=_update_settings(schema, folder),
        rotor_speed_rpm=schema.rotor_speed_rpm,
        tolerances=_tolerances(schema),
    )


def _tolerances(schema: TwinSchema) -> TwinTolerances:
    """Return the twin's tolerances after checking their names."""
    if schema.tolerances == "none":
        return TwinTolerances(others=False)
    known, given = {**tolerances(), **REMAINDERS}, {}
    for name, said in schema.tolerances.items():
        look_up(known, name, "tolerance", field=f"tolerances.{name}")
        own = said if isinstance(said, ToleranceSchema) else ToleranceSchema(std=said)
        require(
            own.weighed or own.std is not None,
            "neither a standard deviation nor weighed is given",
            field=f"tolerances.{name}",
            remedy="give std: 0.01, weighed: true, or a number",
        )
        given[name] = 0.0 if own.weighed and own.std is None else own.std or 0.0
    return TwinTolerances(given)


def _life(given: LifeSettings | None) -> LifeSettings | None:
    """Return the settings, if there is such a curve."""
    if given is not None:
        with located(field="life"):
            assert given.models is not None
    return given


def _numbered(field: str, names: Iterable[str]) -> Iterator[tuple[str, str]]:
    return ((f"{field}.{i}", name) for i, name in enumerate(names))


def _targets(schema: TwinSchema) -> tuple[tuple[Target, ...], tuple[GivenRelaxation, ...]]:
    """Return the targets that are modes, and those that are relaxations."""
    channels, built = [sensor.channel for sensor in schema.sensors], []
    for i, target in enumerate(schema.targets):
        with located(field=f"targets.{i}"):
            built.append(target.build(channels))
    modes = tuple(target for target in built if isinstance(target, Target))
    relaxations = tuple(target for target in built if isinstance(target, GivenRelaxation))
    require(
        modes or not relaxations,
        "relaxations alone do not determine the supports of a structure",
        field="targets",
        value=f"{len(relaxations)} without mode",
        remedy="also give at least one mode: {mode: 1, frequency_hz: …}",
    )
    return modes, relaxations


def _shapes(schema: TwinSchema, targets: tuple[Target, ...]) -> dict[int, dict[str, complex]]:
    """Return the shapes of the targets that are modes, if the update says how they weigh."""
    shapes = {t.number: t.shape for t in schema.targets if t.number is not None and t.mode_shape}
    update = schema.update
    require(
        not shapes or update.fits_shapes,
        "fitting shapes needs the standard deviation of 1 − MAC",
        field="update.mac_std",
        allowed="> 0",
        remedy="e.g. mac_std: 0.02, or profile_std: 0.003; or omit mode_shape",
    )
    name = "profile_std" if update.mac_std is None else "mac_std"
    require(
        not schema.targets or not update.fits_shapes or shapes,
        f"{name} is given but no target has a shape",
        field=f"update.{name}",
        value=getattr(update, name),
        remedy=f"give targets a mode_shape: {{channel: value, …}}, or omit {name}",
    )
    with located(field="targets.mode_shape"):
        for t in (t for t in targets if t.mode in shapes):
            remedy = "also give frequency_hz of the mode"
            require(
                t.frequency_hz is not None,
                "the target has a shape but no frequency",
                value=t.mode,
                remedy=remedy,
            )
            seen = list(shapes[t.mode])
            require(
                len(seen) > 1,
                "a shape needs at least two sensors",
                value=seen,
                allowed="two channels or more",
            )
    return shapes


def _identification(given: dict[str, Any]) -> IdentificationSettings:
    with located(field="identification"):
        return validate(IdentificationSettings, {k: v for k, v in given.items() if k != "picks"})


def _picks(given: dict[str, Any], folder: Path, records: list[str]) -> tuple[Pick, ...]:
    """Return the picks of ``identification.picks``: a list, or the name of a file of them."""
    source = given.get("picks")
    file = folder / source if isinstance(source, str) else None
    with located(file=file, field=None if file else "identification"):
        if file is not None:
            source = read_mapping(file, what="file of picks", list_of="picks")
        picks = () if source is None else parse_picks(source)
        refuse_strangers(picks, records)
        return picks


def _check_ties(support: SupportSchema, update: UpdateSettings) -> None:
    sides = ("", *SIDES) if support.tie == SPLIT_LEGS else ("",)
    laws = (*DEFAULT_LAWS, *members(update.laws))
    known = {p.name + side: law for law in laws for p in family(law).parameters for side in sides}
    for field, names in (("shared", support.shared), ("scatter", [*support.scatter])):
        for name in names:
            look_up(known, name, "parameter of a law", field=field)
        require(
            not names or support.tie not in ("all", MUDLINE),
            "all supports share all parameters already",
            field=field,
            value=names,
            remedy="tie: per-leg or horizontal-vertical",
        )
    both = sorted({*support.shared} & {*support.scatter})
    require(not both, "a parameter cannot be both shared and scattered", field="scatter", value=both)


def _check_update(update: UpdateSettings, given_modes: Collection[int | None]) -> None:
    """Raise an error on unknown bounds and priors before any record is identified."""
    known = {p.name for law in (*DEFAULT_LAWS, *members(update.laws)) for p in family(law).parameters}
    for name in update.parameters:
        matrix_of(name, field="parameters")
    known |= {p.name for p in NuisanceParameters(_dashpots(update), rayleigh=True).parameters}
    known |= {*update.water, *update.parameters}
    for field, given in (("bounds", update.bounds), ("priors", update.priors)):
        for name in given:
            if not any(name.startswith(f"{k}_") for k in known):
                look_up(dict.fromkeys(sorted(known)), name, "parameter of a law", field=f"{field}.{name}")
    _check_starts(update)
    _check_weights(update, given_modes)
    for name, (low, high) in update.bounds.items():
        Parameter(name, low, high, "")
    beyond = [mode for mode in update.modes if mode > PAIRED_MODES and mode not in given_modes]
    require(
        not beyond,
        f"measured modes are paired with the model's first {PAIRED_MODES} on pinned feet",
        field="modes",
        value=beyond,
        allowed=f"1 to {PAIRED_MODES}",
        remedy="give higher ones as targets: {mode, frequency_hz, …}",
    )


def _check_weights(update: UpdateSettings, given_modes: Collection[int | None]) -> None:
    """Raise an error on weights of modes that are not fitted."""
    fitted = sorted({m for m in given_modes if m is not None}) or sorted(update.modes)
    for name in ("frequency", "damping"):
        weights = getattr(update.weights, name, None)
        strange = [mode for mode in weights if mode not in fitted] if isinstance(weights, dict) else []
        require(
            not strange,
            "weights of modes that are not fitted",
            field=f"weights.{name}",
            value=strange[0] if len(strange) == 1 else strange,
            allowed=", ".join(map(str, fitted)),
            remedy="name modes of the targets" if given_modes else "name modes of update.modes",
        )


def _check_starts(update: UpdateSettings) -> None:
    """Raise an error on starting points that belong to no fitted law."""
    beside = {p.name for p in NuisanceParameters(_dashpots(update), rayleigh=True).parameters}
    beside |= {*update.water, *update.parameters}
    laws = {
        law: tuple(p.name for p in family(law).parameters) for law in (*DEFAULT_LAWS, *members(update.laws))
    }
    for i, point in enumerate(() if isinstance(update.starts, int) else update.starts):
        require(
            any(
                all(
                    name in beside or name in own or name.startswith(tuple(f"{p}_" for p in own))
                    for name in point
                )
                for own in laws.values()
            ),
            "no fitted law has all parameters of this starting point",
            field=f"starts[{i}]",
            value=", ".join(point),
            allowed="; ".join(f"{law}: {', '.join(laws[law])}" for law in members(update.laws)),
        )


def _dashpots(update: UpdateSettings) -> tuple[str, ...]:
    """Return the requested dashpots of the rotor; all if a rotor is given without dashpots."""
    return tuple(dict.fromkeys(update.dashpots or (DASHPOTS if update.rotor else ())))


def _structure(schema: TwinSchema, folder: Path) -> Structure:
    structure = schema.structure.read(folder, schema.rna)
    return tied_at_mudline(structure) if schema.support.tie == MUDLINE else structure


def _water(schema: TwinSchema, structure: Structure, folder: Path) -> WaterConfig | None:
    """Return the water; with ``sea`` only, water without growth."""
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


def _update_settings(schema: TwinSchema, folder: Path) -> UpdateSettings:
    """Return the settings, completed from the rest of the file."""
    u = schema.update
    first = [schema.support.law] if schema.support.law else []
    said: dict[str, Any] = {
        "laws": tuple(dict.fromkeys([*first, *u.laws])),
        "dashpots": _dashpots(u),
        "rotor": str(folder / u.rotor) if u.rotor and Path(u.rotor).suffix else u.rotor,
        "rotor_schedule": str(folder / u.rotor_schedule) if u.rotor_schedule else None,
        "water": tuple(dict.fromkeys(u.water)),
        "parameters": tuple(dict.fromkeys(u.parameters)),
    }
    if "modes" not in u.model_fields_set:
        targets = (t.number for t in schema.targets if t.number is not None)
        said["modes"] = tuple(sorted({*USUAL_MODES, *targets}))
    if "damping_of" not in u.model_fields_set and schema.targets:
        said["damping_of"] = "all"
    return u.model_copy(update=said)
