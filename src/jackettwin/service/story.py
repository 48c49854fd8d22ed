"""Two years of days that nobody measured: what a turbine's modes might have done, for the demonstration.

A day is the mean of its 144 records. Season and tide move every mode, the rotor damps in proportion to the
wind, a storm in the second spring washes the ground from around the feet, and the mast says nothing for four
days of a maintenance stop. The size of each effect is stated below; what scour does is the model's own. The
days say of themselves that they are simulated, and go the way of every observation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from math import exp, pi, sin

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change import Ground
from jackettwin.constants import DAY_S, YEAR_DAYS
from jackettwin.files import digest
from jackettwin.identification import (
    Identification,
    ModalEstimate,
    ResolvedSettings,
    Spectrum,
    Stabilisation,
)
from jackettwin.intervals import log_interval_90
from jackettwin.records import Channel
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import Spring, Support
from jackettwin.twin import Observation, Recognised, TwinConfig, TwinModel
from jackettwin.version import __version__

DAYS, UNTIL = 730, date(2025, 12, 1)
"""Length of the story, and the day after it: always the same, so that everybody sees the same."""
STORM, SCOUR_M = 500, 1.4
"""The day after whose storm the ground is gone, and how deep."""
_STOP = range(400, 404)
"""Days of a maintenance stop, on which nothing is measured."""
_PARKED_EVERY = 30
"""Days from one on which the shaft is locked to the next; on the others the rotor idles."""
_GROUND = (0.84e9, 4.7e9)
"""Stiffness of a foot sideways and along its pile [N/m]: what the five records of the demonstration say."""
_MODES = {
    "side_side_1": (0.17533, 0.0057, 0.02582, 0.012, 0.40),
    "fore_aft_1": (0.17817, 0.00603, 0.00196, 0.006, 0.50),
    "torsion_1": (0.64211, 0.01068, 0.00505, 0.0036, 0.44),
    "side_side_2": (0.74352, 0.01325, 0.01291, 0.0048, 0.18),
    "fore_aft_2": (0.76326, 0.01553, 0.00060, 0.0036, 0.21),
}
"""Frequency [Hz], damping ratio of ground and steel, damping ratio of the rotor in the wind below, and the
standard deviations of the logarithms of frequency and damping ratio in a record.

The twin's own modes as its five records update it (``jackettwin run``), so that days and records agree; the
deviations are those of the records."""
_WIND_M_S = 11.6
"""Mean wind of the five records. The damping of a rotor that stands is proportional to the wind."""
_RECORDS = 144
_PER_DEGREE, _PER_METRE = -2.5e-4, -6e-4
"""Relative frequency by air temperature [1/°C] (the tower's steel) and sea level [1/m] (added mass)."""
_OWN = 4e-4
"""Scatter of a day's frequencies beyond that of the estimates."""


@dataclass(frozen=True)
class DayWeather:
    """What a day was like."""

    wind_m_s: float
    wave_m: float
    air_c: float
    level_m: float


def story(config: TwinConfig, model: TwinModel, until: date = UNTIL, seed: int = 7) -> Iterator[Observation]:
    """Yield an observation for every day that something was measured on, the last one the day before a date.

    Parameters
    ----------
    config, model : the twin and its model; modes that it does not have are left out
    seed : of weather and scatter
    """
    rng = np.random.default_rng(seed)
    scour = _scour_effect(config, model)
    numbers = {label: model.labels.index(label) + 1 for label in _MODES if label in model.labels}
    for day, weather in enumerate(_weather(rng, until)):
        common = _PER_DEGREE * (weather.air_c - 10.0) + _PER_METRE * weather.level_m
        modes = {}
        for label, number in numbers.items():
            f, still, rotor, f_std, zeta_std = _MODES[label]
            zeta = still + rotor * weather.wind_m_s / _WIND_M_S
            own = common + SCOUR_M * scour[number - 1] * (day > STORM)
            std = np.array([f_std, zeta_std]) / np.sqrt(_RECORDS)
            x, y = rng.standard_normal(2) * np.hypot(std, [_OWN, 0.06])
            f, zeta = _rounded(f * exp(own + x)), _rounded(zeta * exp(y))
            modes[label] = ModalEstimate(
                f, zeta, np.ones(1, complex), 1.0, 0.0, 1.0, frequency_std_hz=f * std[0],
                damping_ratio_std=zeta * std[1], log_covariance=np.diag(std**2),
                damping_ratio_interval_90=log_interval_90(zeta, std[1]),
            )  # fmt: skip
        if day not in _STOP:
            yield _observation(model, day, until - timedelta(days=DAYS - day), weather, modes)


def _rounded(value: float) -> float:
    """Return a number without the digits in which machines differ."""
    return float(f"{value:.6g}")


def _weather(rng: np.random.Generator, until: date) -> Iterator[DayWeather]:
    """Yield the weather of each day: wind and temperature remember yesterday's."""
    wind = air = 0.0
    first = (until - timedelta(days=DAYS)).timetuple().tm_yday
    for day in range(DAYS):
        wind = 0.6 * wind + 2.0 * rng.standard_normal()
        air = 0.8 * air + 0.9 * rng.standard_normal()
        winter = sin(2.0 * pi * (first + day + 75) / YEAR_DAYS)  # most in the middle of January
        v = 24.0 if day == STORM else float(np.clip(10.0 + 1.5 * winter + wind, 3.0, 21.0))
        yield DayWeather(
            wind_m_s=v,
            wave_m=8.5 if day == STORM else 0.1 * v**1.1 * exp(0.1 * rng.standard_normal()),
            air_c=10.0 - 6.0 * winter + air,
            level_m=0.8 * sin(2.0 * pi * day / 14.77) + 0.15 * rng.standard_normal(),
        )


def _scour_effect(config: TwinConfig, model: TwinModel) -> FloatArray:
    """Return d ln f/d scour of every mode [1/m], by the model on springs under its feet."""
    assembly = model.assembly
    assert assembly is not None
    feet = assembly.structure.reaction_nodes

    def frequencies(scour_m: float) -> FloatArray:
        h, v = (k * exp(-loss * scour_m) for k, loss in zip(_GROUND, loss_per_m, strict=True))
        springs = tuple(Spring(node, np.diag([h, h, v, 0.0, 0.0, 0.0])) for node in feet)
        system = build_system(assembly, Support(springs))
        return np.asarray(undamped_modes(system, len(_MODES)).frequency_hz)

    loss_per_m = Ground.of(config).scour_loss[:2]  # of a foot that does not turn
    return np.log(frequencies(SCOUR_M) / frequencies(0.0)) / SCOUR_M


def _observation(
    model: TwinModel, day: int, of: date, weather: DayWeather, modes: dict[str, ModalEstimate]
) -> Observation:
    start = datetime(of.year, of.month, of.day, tzinfo=UTC)
    seen = Identification(
        records=(f"simulated day {day + 1}",),
        channels=(Channel("simulated"),),
        modes=tuple(modes.values()),
        rejected=(),
        stabilisation=Stabilisation.none(1),
        spectrum=Spectrum(np.empty(0), np.empty((1, 0)), np.empty((1, 0))),
        settings=ResolvedSettings(0.1, 2.0, 5.0, 20, (2, 4), 8.0),
        duration_s=DAY_S,
    )
    conditions = {
        "simulated": "a day of the demonstration that nobody measured; the mean of 144 records",
        "state": "parked" if day % _PARKED_EVERY == 0 else "idling",
        "mean_wind_speed_m_s": round(weather.wind_m_s, 2),
        "wave_height_m": round(weather.wave_m, 2),
        "wave_period_s": round(4.0 + weather.wave_m**0.5 * 3.0, 2),
        "air_temperature_c": round(weather.air_c, 2),
        "water_level_m": round(weather.level_m, 3),
    }
    # no shape was measured: whatever record has one shows its mode more clearly
    recognised = tuple(Recognised(model.labels.index(label) + 1, label, 0.0) for label in modes)
    return Observation(
        record_id=digest(["story", of.isoformat(), [m.frequency_hz for m in modes.values()]]),
        model_hash=model.model_hash,
        settings_hash=model.settings_hash(""),
        code_version=__version__,
        name=f"simulated day {day + 1}",
        start_utc=start,
        conditions=conditions,
        quality={"score": 1.0},
        identification=seen,
        recognised=recognised,
        sensors=(),
    )
