"""Scenario files: YAML to a checked scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jackettwin.errors import located, require
from jackettwin.files import Placed, Seed, find_file, read_yaml, shipped, validate
from jackettwin.loads import WaterSchema
from jackettwin.response import observation_matrix
from jackettwin.simulate.scenario.air import RotorSchema, WindSchema, build_air, build_turbine
from jackettwin.simulate.scenario.asset import AssetSchema
from jackettwin.simulate.scenario.pushes import GivenForces, OutputForcesSchema, StartSchema, read_forces
from jackettwin.simulate.scenario.scenario import Instrument, Scenario, SimulationClock
from jackettwin.simulate.scenario.sea import CurrentSchema, WavesSchema, build_sea
from jackettwin.structure import Structure, assemble


class ScenarioSchema(AssetSchema):
    """A scenario file: the asset, then what happens to it."""

    water: WaterSchema | None = None
    waves: WavesSchema | None = None
    current: CurrentSchema | None = None
    forces: str | OutputForcesSchema | None = None
    start: StartSchema | None = None
    wind: WindSchema | None = None
    rotor: RotorSchema | None = None
    time: Placed[SimulationClock] = SimulationClock()
    sensors: list[Placed[Instrument]] = []
    sensor_seed: Seed = 0


def shipped_scenarios() -> tuple[str, ...]:
    """Return the names of the scenarios that come with the package."""
    return shipped("scenarios")


def read_scenario(source: str | Path) -> Scenario:
    """Read a scenario: a shipped name or a YAML file.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    path = find_file(source, "scenarios")
    return scenario_from(read_yaml(path, what="scenario file"), path)


def scenario_from(data: Any, path: Path) -> Scenario:
    """Return the scenario that a file's content describes; ``path`` names it and anchors relative paths.

    Raises
    ------
    InputError
        Names file, field and value.
    """
    schema = validate(ScenarioSchema, data, file=path)
    with located(file=path):
        asset = schema.build(path.parent)
        structure, wind = asset.structure, schema.wind
        on_top = sum(body.mass_kg for body in structure.masses if body.node == structure.top_node)
        turbine = build_turbine(schema.rotor, wind, path.parent, nacelle_kg=on_top)
        instruments = tuple(schema.sensors)
        _check_instruments(instruments, structure)
        top_m = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
        duration_s = schema.time.duration_s
        pull = None if schema.start is None else schema.start.build(structure, duration_s=duration_s)
        require(
            pull is None or asset.foundation is None,
            "a ground that unloads and reloads has no rest under a lasting pull",
            field="start",
            remedy="give the push in a file (forces), or take soil.hysteresis out",
        )
        return Scenario(
            name=path.stem,
            path=path,
            asset=asset,
            sea=build_sea(schema.water, schema.waves, schema.current, structure, path.parent),
            air=None if wind is None else build_air(wind, turbine, top_m=top_m, duration_s=duration_s),
            turbine=turbine,
            clock=schema.time,
            instruments=instruments or _standard_instruments(structure),
            sensor_seed=schema.sensor_seed,
            forces=_forces(schema.forces, structure, path.parent),
            pull=pull,
        )


def _forces(given: str | OutputForcesSchema | None, structure: Structure, folder: Path) -> GivenForces | None:
    if given is None:
        return None
    return (
        read_forces(folder / given, structure) if isinstance(given, str) else given.build(structure, folder)
    )


def _check_instruments(instruments: tuple[Instrument, ...], structure: Structure) -> None:
    """Refuse channels of one name, and sensors without a place or a direction."""
    names = [one.channel for one in instruments]
    once = len(set(names)) == len(names)
    require(once, "a channel is given twice", field="sensors", value=names, remedy="rename one of them")
    observation_matrix(assemble(structure), tuple(one.sensor for one in instruments))


def _standard_instruments(structure: Structure) -> tuple[Instrument, ...]:
    """Return accelerometers along x and y on the top node."""
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
    return tuple(Instrument(f"acc_top_{axis}", d, node=structure.top_node) for axis, d in axes.items())
