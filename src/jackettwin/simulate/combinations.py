"""Combinations of factored actions: permanent, variable and environmental, and the envelope of what they use.

Responses are linear in the actions, so that each action is computed once and combined with every factor.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.checks import DesignBasis, FrameUse, frame_use
from jackettwin.errors import InputError, located, require
from jackettwin.files import Schema, read_yaml, validate
from jackettwin.loads import Coefficients, Water, morison_points, outside_pressure, still_water
from jackettwin.response import System, build_system, nodal_load, self_weight, static_displacement
from jackettwin.simulate.members import deflections, pressure_outside
from jackettwin.simulate.motion.motion import Motion, simulate_motion
from jackettwin.simulate.scenario.files import read_scenario
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import Assembly, element_weight

Factor = Annotated[float, Field(ge=0.0, le=3.0)]
Forces = dict[str, Annotated[list[float], Field(min_length=3, max_length=6)]]
"""By node: FX, FY, FZ [N] and, where given, MX, MY, MZ [N·m] in global axes."""


class PermanentSchema(Schema):
    """Weight, still water and constant forces."""

    weight: bool = True
    still_water: bool = False
    flooded: list[str] = []
    forces: Forces = {}


class VariableSchema(Schema):
    """Forces that come and go, without wind, waves and current."""

    forces: Forces = {}


class EnvironmentSchema(Schema):
    """Forces at rest, or a scenario file of wind and waves."""

    forces: Forces | None = None
    scenario: str | None = None


class ActionsSchema(Schema):
    """Actions, unfactored."""

    permanent: PermanentSchema = PermanentSchema()
    variable: VariableSchema = VariableSchema()
    environmental: dict[str, EnvironmentSchema] = {}


class CombinationSchema(Schema):
    """One combination: its factors, and which environmental actions it has; all unless it says."""

    name: str
    permanent: Factor
    variable: Factor = 0.0
    environmental: Factor = 0.0
    water_pressure: Factor | None = None
    of: list[str] | None = None


class CombinationsSchema(Schema):
    """A file of combinations."""

    actions: ActionsSchema = ActionsSchema()
    combinations: list[CombinationSchema] = Field(min_length=1)


@dataclass(frozen=True)
class Combinations:
    """A file's actions and combinations; relative paths are relative to its folder."""

    path: Path
    actions: ActionsSchema
    combinations: tuple[CombinationSchema, ...]

    @property
    def at_rest(self) -> bool:
        """Whether some combination needs a structure at rest: it has forces, or no environment at all."""
        return any(
            name is None or self.actions.environmental[name].scenario is None
            for one in self.combinations
            for name in self.environments(one)
        )

    def environments(self, one: CombinationSchema) -> tuple[str | None, ...]:
        """Return the names of a combination's environmental actions; None where it has none."""
        if one.environmental == 0.0 or not self.actions.environmental:
            return (None,)
        return tuple(self.actions.environmental if one.of is None else one.of)


class CombinedUse(NamedTuple):
    """The worst use over all combinations, each one's own by name, and displacements (n_dof,) at rest."""

    envelope: FrameUse
    each: dict[str, FrameUse]
    at_rest: dict[str, FloatArray]


def read_combinations(path: Path) -> Combinations:
    """Return the combinations of a file.

    Raises
    ------
    InputError
        If the file is wrong, names an action that it does not hold, or two combinations alike.
    """
    schema = validate(CombinationsSchema, read_yaml(path, what="file of combinations"), file=path)
    known = schema.actions.environmental
    with located(file=path):
        for name, action in known.items():
            require(
                (action.forces is None) != (action.scenario is None),
                "an environmental action is forces, or a scenario",
                field=f"actions.environmental.{name}",
                remedy="give exactly one of them",
            )
        names = [one.name for one in schema.combinations]
        for k, one in enumerate(schema.combinations):
            field = f"combinations.{k}"
            require(names.count(one.name) == 1, "two of one name", field=f"{field}.name", value=one.name)
            unknown = sorted(set(one.of or ()) - set(known))
            if unknown or one.of == []:
                raise InputError(
                    "no such environmental action",
                    field=f"{field}.of",
                    value=", ".join(unknown),
                    allowed=", ".join(known) or "none is given",
                )
            require(
                one.environmental == 0.0 or bool(known),
                "there is no environmental action",
                field=f"{field}.environmental",
                value=one.environmental,
                remedy="add one under actions.environmental, or take the factor 0",
            )
    return Combinations(path, schema.actions, tuple(schema.combinations))


class _Rest(NamedTuple):
    """Response to an action at rest: displacement (n_dof,), loads along the elements (n_elements, 12)."""

    u: FloatArray
    along: FloatArray


class _Standing:
    """A structure at rest: what each action does to it."""

    def __init__(self, system: System, actions: ActionsSchema) -> None:
        self.system, assembly = system, system.assembly
        given = actions.permanent
        load, along = self.forces(given.forces), np.zeros((assembly.mesh.start.size, 12))
        if given.weight:
            load, along = load + self_weight(assembly), along + element_weight(assembly)
        self.pressure: FloatArray | None = None
        if given.still_water:
            wet_load, wet_along, self.pressure = water_at_rest(assembly, Water(tuple(given.flooded)))
            load, along = load + wet_load, along + wet_along
        self.permanent = _Rest(static_displacement(system, load), along)
        self.variable = static_displacement(system, self.forces(actions.variable.forces))

    def forces(self, forces: Forces) -> FloatArray:
        """Return a load vector."""
        return nodal_load(self.system.assembly, {node: tuple(f) for node, f in forces.items()})

    def displacement(self, one: CombinationSchema, environment: Forces) -> FloatArray:
        """Return the displacement in a combination with forces of an environment."""
        u = one.permanent * self.permanent.u + one.variable * self.variable
        return np.asarray(u + one.environmental * static_displacement(self.system, self.forces(environment)))

    def use(self, one: CombinationSchema, u: FloatArray, basis: DesignBasis) -> FrameUse:
        """Return the use in a combination with its displacement."""
        return frame_use(
            self.system.assembly,
            u,
            basis,
            along=one.permanent * self.permanent.along,
            pressure=_factored(self.pressure, one),
        )


def water_at_rest(assembly: Assembly, water: Water) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return buoyancy on nodes, along elements, and pressure on their ends; the lowest foot is the bed.

    Raises
    ------
    InputError
        If the structure stands above still water.
    """
    structure = assembly.structure
    depth = structure.sea_level_z_m - min(structure.nodes[name][2] for name in structure.reaction_nodes)
    if not depth > 0.0:
        raise InputError(
            "the structure stands above still water",
            field="still water",
            value=structure.sea_level_z_m,
            allowed="sea_level_z_m above the lowest foot",
            remedy="state sea_level_z_m in the structure's file, or leave still water out",
        )
    coefficients = Coefficients()
    grid = morison_points(assembly, highest_z=0.0, lowest_z=-depth, coefficients=coefficients)
    wet = still_water(assembly, grid, water)
    pressure = outside_pressure(assembly, water, density_kg_m3=coefficients.density_kg_m3, depth_m=depth)
    return wet.load, wet.along, pressure


def _factored(pressure: FloatArray | None, one: CombinationSchema) -> FloatArray | None:
    """Return the factored water pressure: by the permanent factor unless the combination says (13.4.1)."""
    if pressure is None:
        return None
    return pressure * (one.permanent if one.water_pressure is None else one.water_pressure)


class _InScenario:
    """A scenario's motion, simulated once, and what the file's forces at rest add to it."""

    def __init__(self, scenario: Scenario, actions: ActionsSchema) -> None:
        self.scenario = scenario
        self.motion: Motion = simulate_motion(scenario)
        assembly = self.motion.model.assembly
        system = build_system(assembly, scenario.asset.support)
        self.permanent, self.variable = (
            static_displacement(system, nodal_load(assembly, {n: tuple(f) for n, f in forces.items()}))
            for forces in (actions.permanent.forces, actions.variable.forces)
        )
        self.pressure = pressure_outside(scenario, assembly)

    def use(self, one: CombinationSchema, basis: DesignBasis) -> FrameUse:
        """Return the worst use of a combination over the scenario."""
        rest = one.permanent * self.permanent + one.variable * self.variable
        worst = FrameUse()
        blocks = deflections(
            self.scenario, self.motion, permanent=one.permanent, environmental=one.environmental
        )
        for u, along in blocks:
            use = frame_use(
                self.motion.model.assembly,
                rest + u,
                basis,
                along=along,
                pressure=_factored(self.pressure, one),
            )
            worst = worst.worse(use)
        return worst


def combined_uses(file: Combinations, basis: DesignBasis, system: System | None) -> CombinedUse:
    """Return the envelope over all combinations and environmental actions of a file.

    Parameters
    ----------
    system : System or None
        The structure at rest; None if every combination is of scenarios.

    Raises
    ------
    InputError
        If a structure is needed and not given, a scenario is wrong, or its members are not the others'.
    """
    if file.at_rest and system is None:
        raise InputError(
            "forces at rest need a structure",
            file=file.path,
            field="STRUCTURE",
            remedy="name it beside --combinations",
        )
    each: dict[str, FrameUse] = {}
    at_rest: dict[str, FloatArray] = {}
    members: list[str] | None = None
    envelope = FrameUse()
    for name, use, u in _uses(file, basis, system):
        if u is not None:
            at_rest[name] = u
        own = [one.member for one in use.members]
        require(
            members is None or own == members,
            "the actions are on different structures",
            file=file.path,
            field=name,
            remedy="let every scenario have the members of the structure",
        )
        members = own
        each[name] = use.named(name)
        envelope = envelope.worse(each[name])
    return CombinedUse(envelope, each, at_rest)


def _uses(
    file: Combinations, basis: DesignBasis, system: System | None
) -> Iterator[tuple[str, FrameUse, FloatArray | None]]:
    """Yield each combination with each of its environmental actions: name, use, displacement at rest."""
    standing = None if system is None or not file.at_rest else _Standing(system, file.actions)
    for environment in (None, *file.actions.environmental):
        wanted = [one for one in file.combinations if environment in file.environments(one)]
        if not wanted:
            continue
        action = EnvironmentSchema() if environment is None else file.actions.environmental[environment]
        moving = None
        if action.scenario is not None:
            with located(file=file.path):
                scenario = read_scenario(_beside(file.path, action.scenario))
            moving = _InScenario(scenario, file.actions)
        for one in wanted:
            name = one.name if environment is None else f"{one.name}, {environment}"
            if moving is not None:
                yield name, moving.use(one, basis), None
            else:
                assert standing is not None
                u = standing.displacement(one, action.forces or {})
                yield name, standing.use(one, u, basis), u


def _beside(path: Path, name: str) -> str:
    """Return a scenario file's path, or a shipped name as it is."""
    return str(path.parent / name) if Path(name).suffix else name
