"""A twin file drafted from a structure and its records, and a list of the data still missing."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jackettwin.errors import InputError
from jackettwin.identification import moving_channels
from jackettwin.records import Channel, FileDefaults, Record, with_conditions
from jackettwin.records.readers.channel_names import read_name
from jackettwin.response import Sensor, observation_matrix
from jackettwin.structure import Assembly, Structure, assemble, posture
from jackettwin.twin import stated_model
from jackettwin.updating import numbered_modes
from jackettwin.version import __version__

STEEL_DAMPING = 0.005
"""Damping ratio at the first frequency that is usually assumed of welded steel towers and jackets."""
_UPDATE = (
    "tolerances:                         # what drawings leave open; other tolerances have defaults: CHECK",
    "  rna_mass: 0.015                   # {weighed: true} where the nacelle was weighed",
    "  growth: 0.04                      # metres; {weighed: true} where divers found none",
    "update:",
    "  damping_of: fore_aft              # modes whose damping the ground is fitted to",
    "  # priors: {k: {median: 1.0e9, log_std: 0.7}}   # design value of a foot's stiffness [N/m]",
    "  # rotor: turbine.yaml             # windIO file: aerodynamic damping of the parked rotor",
    "# rotor_speed_rpm: [5.0, 7.6]       # operating range, for the margins to 1P and 3P",
)
"""Keys that no file gives: the tolerances that affect the ground most, and keys for the user to fill in."""
_PLAIN = re.compile(r"^[A-Za-z_][\w./\-]*$")


@dataclass(frozen=True)
class SensorPlace:
    """A channel, and where the draft places its sensor.

    Attributes
    ----------
    sensor : Sensor
    why : str
        Source of position and direction.
    lacks : str
        Data that the sensor still lacks; empty if none.
    """

    sensor: Sensor
    why: str
    lacks: str = ""


@dataclass(frozen=True)
class Draft:
    """A drafted twin file and the data it lacks.

    Attributes
    ----------
    text : str
        YAML with comments.
    places : tuple of Place
        One for each channel that measures motion.
    missing : tuple of str
        Sentences on what to add.
    """

    text: str
    places: tuple[SensorPlace, ...]
    missing: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether the twin can be run: at least one sensor has a position."""
        return any(not place.lacks for place in self.places)


def assembled_as_stated(structure: Structure, stated: Mapping[str, Any]) -> Assembly:
    """Return a structure's matrices under the modelling keys that its records state; else with gravity."""
    return assemble(
        structure,
        gravity=stated.get("gravity", True),
        beam_theory=stated.get("beam"),
        rotary_inertia=stated.get("rotary_inertia"),
        subdivide=stated.get("subdivide"),
    )


def draft_twin(
    source: str,
    assembly: Assembly,
    records: Sequence[tuple[str, Record]],
    defaults: FileDefaults,
    further: Sequence[str] = (),
    *,
    left_out: Sequence[InputError] = (),
    listed: bool = True,
) -> Draft:
    """Return a commented twin file.

    Parameters
    ----------
    source : str
        Path of the structure as written into the file.
    assembly : Assembly
        The structure's, with its geometric stiffness.
    records : sequence of (path as written into the file, record)
        At least one; the sensors are those of the first.
    defaults : FileDefaults
        Properties of the logger that the user gave.
    further : sequence of str
        Records that are listed but not read.
    left_out : sequence of InputError
        What was wrong with each file beside the records that could not be read.
    listed : bool
        Whether the file names its records; those of an asset in a store are imported separately.
    """
    first, stated = with_conditions(records[0][1]), stated_model(records[0][1].metadata)
    places = tuple(_place(channel, assembly) for channel in moving_channels(first).channels)
    missing = _missing(places, [record for _, record in records], assembly.structure)
    first_hz = float(numbered_modes(assembly, 1).frequency_hz[0])
    lines = [
        f"# A twin, drafted by `jackettwin init` {__version__}. Look through the lines that say CHECK.",
        "# docs/reference/twin.md lists every key.",
        f"structure: {_text(source)}",
        *_modelling(assembly, stated),
        f"damping: {{rayleigh: {{ratio: {STEEL_DAMPING}, frequency_hz: {first_hz:.3f}}}}}"
        "   # of the steel alone: CHECK",
        *_water(assembly.structure),
        "support: {tie: all}                 # or horizontal-vertical, per-leg",
        *_logger(defaults),
        "sensors:                            # place above mean sea level, direction in global axes: CHECK",
        *[_sensor_line(place) for place in places],
        *(_records(records, further) if listed else ()),
        *[f"  # left out: {' '.join(str(error).split())}" for error in left_out],
        *_UPDATE,
        *(["# Missing:"] if missing else []),
        *[f"#   {sentence}" for sentence in missing],
    ]
    return Draft("\n".join(lines) + "\n", places, missing)


def _records(records: Sequence[tuple[str, Record]], further: Sequence[str]) -> list[str]:
    read = [f"  - {_text(path)}   # {_described(record)}" for path, record in records]
    return ["records:", *read, *[f"  - {_text(path)}" for path in further]]


def _place(channel: Channel, assembly: Assembly) -> SensorPlace:
    """Return the position of a channel's sensor, and the data it lacks."""
    structure, read = assembly.structure, read_name(channel.name)
    node, height, why = channel.node, channel.height_m, []
    if node is None and height is None and read.level in (levels := _levels(structure)):
        node = levels[read.level]
        why.append(f"{read.level}, by its name")
    elif height is not None and height == read.height_m:
        why.append(f"{height:g} m by its name")
    if read.direction is not None and read.direction == channel.direction:
        why.append(f"{read.direction_word} by its name")
    sensor = Sensor(channel.name, channel.direction, node, None if node is not None else height)
    lacks = _lacks(sensor, assembly)
    middle = _middle(structure) if read.level == "tower middle" and sensor.height_m is None else None
    if middle is not None:
        lacks += f": the middle of the tower is at {middle:.0f} m"
    return SensorPlace(sensor, ", ".join(why), lacks)


def _levels(structure: Structure) -> dict[str, str]:
    """Return the node of each named part where the structure has exactly one candidate."""
    levels = {"tower top": structure.top_node} if _has_tower(structure) else {}
    if len(structure.interface_nodes) == 1:  # where the transition piece ends and the tower begins
        levels |= dict.fromkeys(("transition piece", "tower bottom"), structure.interface_nodes[0])
    return levels


def _has_tower(structure: Structure) -> bool:
    return structure.top_node not in structure.interface_nodes


def _middle(structure: Structure) -> float | None:
    """Return the height of the middle of the tower above the sea; None if its lower end is not known."""
    bottom = _levels(structure).get("tower bottom")
    if bottom is None or not _has_tower(structure):
        return None
    ends = [structure.nodes[node][2] for node in (bottom, structure.top_node)]
    return sum(ends) / 2.0 - structure.sea_level_z_m


def _lacks(sensor: Sensor, assembly: Assembly) -> str:
    lacks = []
    if sensor.node is None and sensor.height_m is None:
        lacks.append("height_m (above mean sea level) or node")
    if not any(sensor.direction):
        lacks.append("direction")
    if lacks:
        return " and ".join(lacks)
    try:
        observation_matrix(assembly, (sensor,))
    except InputError as error:
        return f"a place on the structure: {error.problem}, allowed {error.allowed or error.remedy}"
    return ""


def _sensor_line(place: SensorPlace) -> str:
    """Return a sensor's line, commented out if any of its data are missing."""
    s = place.sensor
    at = f"node: {_text(s.node)}" if s.node is not None else f"height_m: {_number(s.height_m)}"
    direction = ", ".join(f"{v:g}" for v in s.direction) if any(s.direction) else "?, ?, ?"
    line = f"- {{channel: {_text(s.channel)}, {at}, direction: [{direction}]}}"
    if place.lacks:
        return f"  # {line}   # CHECK: lacks {place.lacks}"
    return f"  {line}" + (f"   # {place.why}" if place.why else "")


def _modelling(assembly: Assembly, stated: Mapping[str, object]) -> list[str]:
    """Return the modelling keys of the structure: those of the record, where a model simulated it."""
    why = "as the record states it" if "gravity" in stated else "self-weight softens"
    lines = [f"gravity: {str(assembly.gravity).lower():<28}# {why}: 1 to 4 % on the first frequencies"]
    structure = assembly.structure
    return lines + [
        f"{key}: {str(value).lower()}   # as the record states it"
        for key, value in stated.items()
        if key != "gravity" and value != getattr(structure, key)
    ]


def _water(structure: Structure) -> list[str]:
    """Return the line of the water around a structure whose feet are below the sea level."""
    feet = [structure.nodes[node][2] for node in structure.reaction_nodes]
    depth = structure.sea_level_z_m - min(feet, default=structure.sea_level_z_m)
    if not depth > 0.0:
        return []
    return [
        f"water: {{depth_m: {depth:g}}}   # its added mass, and in flooded members; CHECK: add marine_growth,"
        " or adds_mass: false"
    ]


def _logger(defaults: FileDefaults) -> list[str]:
    """Return the line of the logger's properties that the user gave."""
    said = {
        "unit": defaults.unit and _text(defaults.unit),
        "gain": defaults.gain,
        "clock": defaults.timezone and json.dumps(defaults.timezone),
        "sample_rate_hz": defaults.sample_rate_hz,
    }
    given = ", ".join(f"{key}: {value}" for key, value in said.items() if value is not None)
    return [f"logger: {{{given}}}   # for files that do not state it"] if given else []


def _missing(
    places: Sequence[SensorPlace], records: Sequence[Record], structure: Structure
) -> tuple[str, ...]:
    """Return the missing data, the most needed first."""
    missing = [f"{place.sensor.channel}: {place.lacks}" for place in places if place.lacks]
    if not _has_tower(structure):
        top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
        missing.append(
            f"the tower: the structure ends at its interface, {top:g} m above the sea, and its modes are not "
            "the turbine's; add the tower's joints and members and the nacelle's mass to the deck"
        )
    remarks = {text for record in records for text in record.metadata.get("remarks", ())}
    missing += _levels_missing(places, structure)
    missing += sorted(text for text in remarks if "zone" in text)
    names = set(records[0].channel_names)
    for record in records:
        gone = sorted(names - {*record.channel_names})
        if gone:
            missing.append(f"{record.name} lacks channels of the first record: {', '.join(gone)}")
    conditions = with_conditions(records[0]).conditions
    lacking = [key for key in ("mean_wind_speed_m_s", "yaw_deg", "state") if conditions.get(key) is None]
    if lacking:
        missing.append(
            f'conditions of the records ({", ".join(lacking)}): "conditions" in the JSON beside a record, or '
            "records.json; without the yaw, fore-aft is taken along global x"
        )
    missing.append("rotor_speed_rpm: [lowest, highest]; without it there are no margins to 1P and 3P")
    if not structure.masses:
        missing.append("the rotor–nacelle assembly: rna: {mass_kg, cg_offset_m, inertia_about_cg_kg_m2}")
    return tuple(missing)


def _levels_missing(places: Sequence[SensorPlace], structure: Structure) -> list[str]:
    """Return contradictions of the sea level by feet or sensor heights, whose datum may be another."""
    if odd := posture(structure):
        return [f"the structure as it stands: {text}" for text in odd]
    feet = min((structure.nodes[node][2] for node in structure.reaction_nodes), default=None)
    if feet is None:
        return []
    depth = structure.sea_level_z_m - feet
    if depth <= 0.0:
        return [
            f"sea_level_z_m of the structure: its feet are at z = {feet:g} m and still water at "
            f"{structure.sea_level_z_m:g} m; heights of sensors are measured from still water"
        ]
    heights = [place.sensor.height_m for place in places if place.sensor.height_m is not None]
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    if heights and top < max(heights) <= top + depth:
        return [
            f"the heights, up to {max(heights):g} m, may be measured from the sea bed; "
            f"above still water they would be {depth:g} m less"
        ]
    return []


def _described(record: Record) -> str:
    start = "start not known" if record.start_utc is None else f"from {record.start_utc:%Y-%m-%dT%H:%M:%SZ}"
    known = with_conditions(record).conditions
    state = f", {known['state']}" if known.get("state") else ""
    return f"{record.duration_s:.0f} s at {record.sample_rate_hz:g} Hz, {start}{state}"


def _text(text: str) -> str:
    """Return a text as YAML, in quotes where YAML would read it as another type."""
    return text if _PLAIN.match(text) else json.dumps(text, ensure_ascii=False)


def _number(value: float | None) -> str:
    return "?" if value is None else f"{value:g}"
