"""Simulated records with their truth."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from math import degrees, pi
from time import perf_counter
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.quantities import quantity as quantity_of
from jackettwin.records import Channel, Record
from jackettwin.simulate.level import beyond_comparison, levels
from jackettwin.simulate.motion.motion import Motion, simulate_motion
from jackettwin.simulate.motion.pushes import pull_notes
from jackettwin.simulate.scenario.asset import Asset
from jackettwin.simulate.scenario.scenario import Instrument, Scenario, in_words_of
from jackettwin.simulate.sensing import flawed, readings
from jackettwin.version import __version__

_SIGNALS = {
    "wind_hub_x": ("wind speed", "m/s"),
    "wave_elevation": ("wave elevation", "m"),
    "nacelle_yaw": ("yaw", "rad"),
}
_START = datetime(2025, 1, 1, tzinfo=UTC)
"""Simulated records need a start; it means nothing."""


@dataclass(frozen=True)
class Simulation:
    """A simulated record and its computing effort."""

    record: Record
    seconds_simulated: float
    wall_s: float
    notes: tuple[str, ...] = ()
    """What is odd about a pull and its release."""

    def document(self) -> dict[str, Any]:
        """Return the document of ``jackettwin simulate``."""
        return {
            "channels": list(self.record.channel_names),
            "conditions": dict(self.record.conditions),
            "sample_rate_hz": self.record.sample_rate_hz,
            "seconds_simulated": self.seconds_simulated,
            "wall_s": self.wall_s,
            "true_modes": self.record.metadata["true_modes"],
            "decrement": self.record.metadata["decrement"],
            "levels": self.record.metadata["levels"],
            "levels_beyond_comparison": self.record.metadata["levels_beyond_comparison"],
        }


def simulate(scenario: Scenario) -> Simulation:
    """Return the record of a scenario.

    Raises
    ------
    InputError
        If parts of the scenario do not fit each other, a sensor has no place, or the motion grows
        without bound.
    """
    start = perf_counter()
    motion = simulate_motion(scenario)
    with in_words_of(scenario):
        clean = readings(motion, scenario)
    notes = pull_notes(scenario, motion.model, motion.decrement)
    step = scenario.clock.step_s
    data = flawed(clean, scenario.instruments, step_s=step, seed=scenario.sensor_seed)
    signals = _signals(motion, scenario, clean.shape[1])
    record = Record(
        data=np.vstack([data, *(row[None] for row in signals.values())]),
        sample_rate_hz=1.0 / step,
        channels=(*_channels(scenario.instruments), *map(_signal_channel, signals)),
        start_utc=_START,
        conditions=conditions(scenario, motion.rotor_speed_rad_s),
        metadata={
            "source": f"jackettwin {__version__} simulate",
            "scenario": scenario.name,
            "true_support": scenario.asset.support_text,
            "model": _model(scenario.asset),
            **_axes(scenario.instruments),
            "decrement": None if motion.decrement is None else motion.decrement.document(),
            "levels": [asdict(level) for level in levels(motion, scenario)],
            "levels_beyond_comparison": beyond_comparison(scenario),
            "true_modes": [
                {
                    "label": m.label,
                    "frequency_hz": m.frequency_hz,
                    "damping_ratio": m.damping_ratio,
                    "damping_by_source": m.damping_by_source,
                }
                for m in motion.modes
            ],
        },
        name=scenario.name,
    )
    return Simulation(record, scenario.clock.total_s, perf_counter() - start, notes)


def _model(asset: Asset) -> dict[str, Any]:
    """Return how the structure was modelled, in the keys of scenarios and twins: what a twin takes over."""
    structure = asset.structure
    return {
        "structure": structure.name,
        "gravity": asset.gravity,
        "beam": asset.beam or structure.beam,
        "rotary_inertia": structure.rotary_inertia if asset.rotary_inertia is None else asset.rotary_inertia,
        "subdivide": asset.subdivide or structure.subdivide,
    }


def _axes(instruments: tuple[Instrument, ...]) -> dict[str, str]:
    """Return that a record is in the rotor's axes already, if all its sensors are on the nacelle."""
    return {"axes": "rotor"} if all(one.on_nacelle for one in instruments) else {}


def conditions(scenario: Scenario, rotor_speed_rad_s: float) -> dict[str, Any]:
    """Return wind, sea, state and the rotor's speed as a record states them; None is not there."""
    air, sea, turbine = scenario.air, scenario.sea, scenario.turbine
    return {
        "mean_wind_speed_m_s": None if air is None else air.wind.speed_m_s,
        "turbulence": None if air is None else air.wind.turbulence,
        "wind_direction": "+x",
        "yaw_deg": degrees(scenario.heading_rad),
        "wind_seed": None if air is None else air.seed,
        "rotor": None if turbine is None else turbine.name,
        "state": None if turbine is None else turbine.state,
        "rotor_speed_rpm": None if turbine is None else rotor_speed_rad_s * 30.0 / pi,
        "pitch_deg": None if turbine is None or turbine.state == "operating" else degrees(turbine.pitch),
        "waves": None if sea is None else sea.waves,
        "wave_height_m": None if sea is None or sea.waves is None else sea.height_m,
        "wave_period_s": None if sea is None or sea.waves is None else sea.period_s,
        "wave_direction_deg": None if sea is None or sea.waves is None else degrees(sea.direction),
        "wave_seed": None if sea is None or sea.waves is None else sea.seed,
    }


def _channels(instruments: tuple[Instrument, ...]) -> tuple[Channel, ...]:
    """Return the channels; among fixed sensors, those on the nacelle say that they turn."""
    if _axes(instruments):
        return tuple(map(_channel, instruments))
    return tuple(replace(_channel(i), frame="nacelle" if i.on_nacelle else "global") for i in instruments)


def _channel(instrument: Instrument) -> Channel:
    length = float(np.linalg.norm(instrument.direction))
    x, y, z = (float(v) / length for v in instrument.direction)
    return Channel(
        name=instrument.channel,
        quantity=instrument.recorded_as,
        unit=quantity_of(instrument.recorded_as).unit,
        height_m=instrument.height_m,
        node=instrument.node,
        direction=(x, y, z),
    )


def _signal_channel(name: str) -> Channel:
    quantity, unit = _SIGNALS[name]
    along = (1.0, 0.0, 0.0) if name == "wind_hub_x" else (0.0, 0.0, 0.0)
    return Channel(name=name, quantity=quantity, unit=unit, direction=along)


def _signals(motion: Motion, scenario: Scenario, n_samples: int) -> dict[str, FloatArray]:
    """Return the environment's channels at the sample rate, unless a sensor has taken their name."""
    clock = scenario.clock
    taken = {instrument.channel for instrument in scenario.instruments}
    t = clock.discard_s + np.arange(n_samples) * clock.step_s
    known = np.arange(motion.states.shape[0]) * motion.step_s
    signals = {name: np.interp(t, known, values) for name, values in motion.signals.items()}
    if scenario.air is not None and scenario.air.yaw_path:
        signals["nacelle_yaw"] = scenario.air.heading(np.arange(n_samples, dtype=np.float64) * clock.step_s)
    return {name: values for name, values in signals.items() if name not in taken}
