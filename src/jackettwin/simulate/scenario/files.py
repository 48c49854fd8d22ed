"""Scenario files: YAML to a checked scenario."""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.files import find_file, read_yaml, shipped, validate
from jackettwin.loads import Wind, read_rotor
from jackettwin.loads.aerodynamics.rotor_wind import PIECE_M
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.given_kinematics import Kinematics, read_kinematics
from jackettwin.loads.sea.given_waves import Elevation, read_elevation
from jackettwin.loads.sea.waves import peak_factor
from jackettwin.response import Sensor, observation_matrix
from jackettwin.response.sensors import sees
from jackettwin.simulate.scenario.asset import build_asset
from jackettwin.simulate.scenario.rotor_limits import check_clearance
from jackettwin.simulate.scenario.scenario import (
    GRID_M,
    REGULAR,
    Air,
    Instrument,
    Scenario,
    Sea,
    SimulationClock,
    Turbine,
)
from jackettwin.simulate.scenario.schema import (
    InstrumentSchema,
    RotorSchema,
    ScenarioSchema,
    TimeSchema,
    WavesSchema,
    WindSchema,
)
from jackettwin.simulate.scenario.water_files import WaterSchema, depth_of, water_members
from jackettwin.structure import Structure, assemble

GIVEN = ("elevation", "kinematics")
_MOST_SAMPLES = 1e7
_LONGEST_LOAD_STEP_S = 0.05


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
        asset = build_asset(schema, path.parent)
        turbine = _turbine(schema, path.parent)
        instruments = tuple(_instrument(s) for s in schema.sensors)
        _check_instruments(instruments, asset.structure)
        return Scenario(
            name=path.stem,
            path=path,
            asset=asset,
            sea=_sea(schema, asset.structure, path.parent),
            air=_air(schema, asset.structure, turbine),
            turbine=turbine,
            clock=_clock(schema.time),
            instruments=instruments or _standard_instruments(asset.structure),
            sensor_seed=schema.sensor_seed,
        )


def _turbine(schema: ScenarioSchema, folder: Path) -> Turbine | None:
    if schema.rotor is None and schema.wind is None:
        return None
    chosen = schema.rotor or RotorSchema()
    if chosen.data == "none":
        _refuse_rotor_keys(chosen)
        return None
    if chosen.state == "operating" and schema.wind is None:
        raise InputError("an operating turbine needs wind", field="wind", remedy="add wind: {speed_m_s: …}")
    rotor, control = read_rotor(chosen.data, folder=folder)
    return Turbine(
        rotor,
        control,
        chosen.state,
        radians(chosen.pitch_deg),
        radians(chosen.azimuth_deg),
        name=chosen.data,
        assumed=schema.rotor is None,
    )


def _refuse_rotor_keys(chosen: RotorSchema) -> None:
    """Refuse what only a rotor has."""
    for key in sorted(chosen.model_fields_set - {"data"}):
        raise InputError(
            "there is no rotor",
            field=f"rotor.{key}",
            value=getattr(chosen, key),
            remedy="name its data, or take this out",
        )


def _air(schema: ScenarioSchema, structure: Structure, turbine: Turbine | None) -> Air | None:
    w = schema.wind
    if w is None:
        return None
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    if turbine is not None:
        check_clearance(turbine, top)
    if w.grid_m is not None and (turbine is None or turbine.state == "operating"):
        raise InputError(
            "a grid is for blades that stand",
            field="wind.grid_m",
            value=w.grid_m,
            remedy="leave it out, or park the rotor",
        )
    hub = 0.0 if turbine is None else turbine.rotor.hub_height
    turbulence = 0.0 if w.turbulence == "none" else w.turbulence
    with located(field="wind"):
        wind = Wind(w.speed_m_s, top + hub, turbulence, w.shear)
    path = _yaw_path(w, schema.time.duration_s)
    return Air(
        wind=wind,
        seed=w.seed,
        yaw=_mean_heading(path) if path else radians(w.yaw_deg),
        yaw_path=path,
        tower_drag=w.tower_drag,
        **_places(w, stands=turbine is not None and turbine.state != "operating"),
    )


def _places(w: WindSchema, *, stands: bool) -> dict[str, Any]:
    """Return where the wind is made: a rotor that stands is blown at as by a wind field file.

    There v and w are independent from node to node, as IEC 61400-1 leaves them; on pieces, and for a rotor
    that turns, they are as coherent as u.
    """
    grid = GRID_M if stands and w.grid_m is None and w.piece_m is None else w.grid_m
    coherence = w.coherence or ("all" if grid is None else "u")
    return {"coherent": coherence, "piece_m": w.piece_m or PIECE_M, "grid_m": grid}


def _yaw_path(w: WindSchema, duration_s: float) -> tuple[tuple[float, float], ...]:
    """Return times [s] from the record's start to its end and the headings [rad] there; empty if none."""
    if w.yaw_path is None:
        return ()
    if w.yaw_deg != 0.0:
        raise InputError(
            "the heading is given twice", field="wind.yaw_deg", value=w.yaw_deg, remedy="keep yaw_path"
        )
    at, yaw = np.array(w.yaw_path, dtype=np.float64).T
    if np.any(np.diff(at) <= 0.0):
        raise InputError("times must grow", field="wind.yaw_path", value=at.tolist(), remedy="sort them")
    inside = at[(at > 0.0) & (at < duration_s)]
    times = np.concatenate([[0.0], inside, [duration_s]])
    headings = np.radians(np.interp(times, at, yaw))
    return tuple(zip(times.tolist(), headings.tolist(), strict=True))


def _mean_heading(path: tuple[tuple[float, float], ...]) -> float:
    at, yaw = np.transpose(path)
    return float(np.trapezoid(yaw, at) / (at[-1] - at[0]))


def _sea(schema: ScenarioSchema, structure: Structure, folder: Path) -> Sea | None:
    c, w = schema.current, schema.waves
    if schema.water is None and w is None and c is None:
        return None
    given = schema.water or WaterSchema()
    members = water_members(given, structure, folder)
    coefficients, ends = members.coefficients, members.ends
    water = members.water if members.adds_mass else None
    depth = depth_of(given, structure)
    current = (
        None
        if c is None
        else Current(depth, c.subsurface_m_s, c.wind_driven_m_s, radians(c.direction_deg), c.uniform_m_s)
    )
    if w is None:
        return Sea(depth, coefficients, water, current=current, ends=ends)
    with located(field="waves"):
        filed = _filed(w, folder)
        eta = filed.elevation if isinstance(filed, Kinematics) else filed
        height, period = _size(w) if eta is None else (eta.significant_height_m, eta.peak_period_s)
        return Sea(
            depth_m=depth,
            coefficients=coefficients,
            water=water,
            waves=w.type,
            height_m=height,
            period_s=period,
            direction=radians(w.direction_deg),
            seed=w.seed,
            stretching=w.stretching or ("none" if w.type == "airy" else "wheeler"),
            gamma=None if eta is not None or w.type in REGULAR else _peakedness(w),
            spreading=w.spreading,
            relative_velocity=w.relative_velocity,
            diffraction=_scatters(w),
            current=current,
            ends=ends,
            elevation=eta,
            kinematics=filed if isinstance(filed, Kinematics) else None,
            celerity_m_s=w.celerity_m_s,
        )


def _filed(w: WavesSchema, folder: Path) -> Elevation | Kinematics | None:
    """Return what is given of waves by a file; refuse what does not belong to these."""
    if (w.type in GIVEN) != (w.file is not None):
        raise InputError(
            "a file belongs to waves of type elevation or kinematics, and they need one",
            field="file",
            value=w.file,
            remedy="give type: elevation or kinematics and file, or height and period",
        )
    not_linear = () if w.type == "elevation" else ("stretching",)
    others = ("celerity_m_s",) if w.type != "kinematics" else ()
    if w.file is not None:
        others = (*others, "height_m", "period_s", "hs_m", "tp_s", "gamma", "spreading", *not_linear)
    for name in others:
        if getattr(w, name) is not None:
            raise InputError(
                f"does not belong to waves of type {w.type}",
                field=name,
                value=getattr(w, name),
                remedy="leave it out" if w.file is None else "leave it out: the file says it",
            )
    if w.file is None:
        return None
    return read_elevation(folder / w.file) if w.type == "elevation" else read_kinematics(folder / w.file)


def _size(w: WavesSchema) -> tuple[float, float]:
    """Return H and T, or Hs and Tp; refuse those of the other kind."""
    regular, random = ("height_m", "period_s"), ("hs_m", "tp_s")
    needed = regular if w.type in REGULAR else random
    others = (*random, "gamma", "spreading") if w.type in REGULAR else regular
    for name in others:
        if getattr(w, name) is not None:
            raise InputError(
                f"does not belong to waves of type {w.type}",
                field=name,
                value=getattr(w, name),
                allowed=", ".join(needed),
                remedy=f"give {' and '.join(needed)}, or another type",
            )
    for name in needed:
        if getattr(w, name) is None:
            raise InputError("required key is missing", field=name, remedy=f"add {name!r}")
    return getattr(w, needed[0]), getattr(w, needed[1])


def _scatters(w: WavesSchema) -> bool:
    """Return whether members scatter waves; steep ones have no theory of it here."""
    if w.diffraction == "maccamy-fuchs" and w.type in ("stokes5", "stream", "kinematics"):
        raise InputError(
            f"not known for waves of type {w.type}",
            field="diffraction",
            value=w.diffraction,
            allowed="none",
            remedy="take airy, jonswap or pierson-moskowitz, or leave it out",
        )
    return w.diffraction == "maccamy-fuchs"


def _peakedness(w: WavesSchema) -> float | None:
    if w.type == "pierson-moskowitz":
        return 1.0
    if w.gamma is None and w.hs_m is not None and w.tp_s is not None:
        return peak_factor(w.hs_m, w.tp_s)
    return w.gamma


def _clock(t: TimeSchema) -> SimulationClock:
    """Return the clock; loads default to the longest multiple of the step up to 0.05 s."""
    h = t.step_s
    load = t.load_step_s or max(h, h * int(_LONGEST_LOAD_STEP_S / h + 1e-9))
    for field, value, unit in (
        ("load_step_s", load, h),
        ("duration_s", t.duration_s, load),
        ("discard_s", t.discard_s, load),
    ):
        if abs(value / unit - round(value / unit)) > 1e-6 or (value < unit and field != "discard_s"):
            raise InputError(
                "must be a whole number of steps",
                field=f"time.{field}",
                value=value,
                allowed=f"multiples of {unit:g} s",
                remedy="change it, or step_s and load_step_s",
            )
    samples = (t.duration_s + t.discard_s) / h
    if samples > _MOST_SAMPLES:
        raise InputError(
            "too many samples",
            field="time.step_s",
            value=h,
            allowed=f"{_MOST_SAMPLES:.0e} steps: ≥ {h * samples / _MOST_SAMPLES:.3g} s for this duration",
            remedy="take longer steps or a shorter record",
        )
    return SimulationClock(t.duration_s, h, t.discard_s, load)


def _check_instruments(instruments: tuple[Instrument, ...], structure: Structure) -> None:
    """Refuse channels of one name, and sensors without a place or a direction."""
    names = [one.sensor.channel for one in instruments]
    if len(set(names)) != len(names):
        raise InputError(
            "a channel is given twice", field="sensors", value=names, remedy="rename one of them"
        )
    observation_matrix(assemble(structure), tuple(one.sensor for one in instruments))


def _instrument(s: InstrumentSchema) -> Instrument:
    return Instrument(
        sensor=Sensor(s.channel, s.direction, s.node, s.height_m, s.member, s.position, sees(s.quantity)),
        quantity=s.quantity,
        on_nacelle=s.frame == "nacelle",
        noise=s.noise,
        bias=s.bias,
        limit=s.limit,
        dropouts_per_hour=s.dropouts_per_hour,
        dropout_s=s.dropout_s,
    )


def _standard_instruments(structure: Structure) -> tuple[Instrument, ...]:
    """Return accelerometers along x and y on the top node."""
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
    return tuple(
        Instrument(Sensor(f"acc_top_{axis}", direction, node=structure.top_node))
        for axis, direction in axes.items()
    )
