"""Observations made up of modes with known values, for tests of what comes after them."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from jackettwin.files import digest
from jackettwin.identification import Identification, ModalEstimate, RealPole, Spectrum, Stabilisation
from jackettwin.identification.estimate import ResolvedSettings
from jackettwin.records import Channel
from jackettwin.response.sensors import Sensor
from jackettwin.twin import Observation
from jackettwin.twin.observation import Recognised

NONE, NO, WHOLE = np.empty(0), np.empty(0, dtype=bool), np.empty(0, dtype=np.int64)


def estimate(
    f: float, zeta: float, f_std: float | None = 5e-4, zeta_std: float = 0.1, rho: float = 0.0
) -> ModalEstimate:
    """Return a mode; the standard deviations are of logarithms."""
    std = None if f_std is None else np.array([f_std, zeta_std])
    covariance = None if std is None else np.outer(std, std) * np.array([[1.0, rho], [rho, 1.0]])
    return ModalEstimate(f, zeta, np.ones(1, complex), 1.0, 0.0, 1.0, log_covariance=covariance)


def observation(
    modes: Mapping[int, ModalEstimate],
    start: datetime | None,
    *,
    name: str = "record",
    model_hash: str = "model",
    conditions: Mapping[str, Any] | None = None,
    sensors: tuple[Sensor, ...] = (),
    real_poles: tuple[RealPole, ...] = (),
    mac: float = 1.0,
    duration_s: float = 600.0,
) -> Observation:
    """Return an observation that recognises these modes of the model."""
    channels = tuple(Channel(s.channel, direction=s.direction) for s in sensors) or (Channel("a"),)
    shapes = np.empty((0, len(channels)), complex)
    found = Identification(
        records=(name,),
        channels=channels,
        modes=tuple(modes.values()),
        rejected=(),
        stabilisation=Stabilisation(WHOLE, NONE, NONE, shapes, NO, NO, NO, WHOLE),
        spectrum=Spectrum(NONE, np.empty((len(channels), 0)), np.empty((len(channels), 0))),
        settings=ResolvedSettings(0.1, 2.0, 5.0, 20, (2, 4), 8.0),
        duration_s=duration_s,
        real_poles=real_poles,
    )
    return Observation(
        record_id=digest([name, [[m.frequency_hz, m.damping_ratio] for m in modes.values()], start]),
        model_hash=model_hash,
        settings_hash="settings",
        code_version="0",
        name=name,
        start_utc=start,
        conditions=conditions or {},
        quality={"score": 1.0},
        identification=found,
        recognised=tuple(Recognised(mode, f"mode_{mode}", mac) for mode in modes),
        sensors=sensors,
    )


BEGUN = 75
"""Day on which a season of two modes changes."""


def seen(days: int, step: float = 0.0, seed: int = 1) -> list[Observation]:
    """Return four records a day of two modes that temperature and a slow process move; perhaps a step."""
    rng = np.random.default_rng(seed)
    out, slow = [], 0.0
    for day in range(days):
        slow = 0.6 * slow + 0.8 * 5e-4 * rng.standard_normal()
        air = 10.0 + 5.0 * np.sin(day / 9.0)
        for hour in (3, 9, 15, 21):
            own = slow - 1e-4 * air + step * (day >= BEGUN) + 1e-3 * rng.standard_normal(2)
            modes = {
                k + 1: estimate(
                    float(f * np.exp(x)), float(0.012 * np.exp(0.1 * rng.standard_normal())), 1e-3
                )
                for k, (f, x) in enumerate(zip((0.18, 0.183), own, strict=True))
            }
            start = datetime(2025, 1, 1, hour, tzinfo=UTC) + timedelta(days=day)
            conditions = {"state": "parked", "mean_wind_speed_m_s": 5.0 + hour, "air_temperature_c": air}
            out.append(observation(modes, start, name=f"{day}-{hour}", conditions=conditions))
    return out
