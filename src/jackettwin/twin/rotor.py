"""The parked rotor of a twin: what wind it stood in, and what damping to expect of it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jackettwin.loads import read_rotor
from jackettwin.loads.rotor import parked_closed_form
from jackettwin.response.modal import UndampedModes
from jackettwin.structure import Assembly
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.measure import Measured, Sighting, fuse
from jackettwin.twin.result import MeasuredMode
from jackettwin.updating import Residuals, Target
from jackettwin.updating.extras import DASHPOTS

_LOG_STD = {"c_fore_aft": 0.8, "c_side_side": 0.4}
"""How far the closed form may be off: blades bend, air lags, turbulence takes 11–18 %; drag is small."""
_DIRECTIONS = {"fore_aft": "c_fore_aft", "side_side": "c_side_side"}

States = dict[str, tuple[Residuals, Mapping[str, float]]]


def mean_wind(config: TwinConfig, found: Measured | None) -> float | None:
    """Return the wind speed [m/s] that nacelle dashpots are stated at: the twin's, or the records' mean."""
    if config.update.wind_speed_m_s is not None:
        return config.update.wind_speed_m_s
    winds = [] if found is None else [s.wind_m_s for seen in found.sightings.values() for s in seen]
    known = [v for v in winds if v is not None]
    return float(np.mean(known)) if known and len(known) == len(winds) else None


def rotor_priors(
    config: TwinConfig, assembly: Assembly, numbered: UndampedModes, wind: float | None
) -> dict[str, tuple[float, float]]:
    """Return lognormal priors of the nacelle's dashpots from the rotor's geometry and the wind.

    A dashpot c on the tower top takes from the first mode in its direction what the rotor's matrix does:
    c = φᵀCφ/φ_j² with the mode's translations and rotations φ there.
    """
    if config.update.rotor is None or wind is None:
        return {}
    C = parked_closed_form(read_rotor(config.update.rotor)[0], wind)
    top = numbered.shapes[assembly.dofs(assembly.structure.top_node)]
    priors = {}
    for name in config.update.dashpots:
        axis = DASHPOTS[name]
        phi = top[:, int(np.argmax(np.abs(top[axis, :2])))]
        priors[name] = (float(phi @ C @ phi / phi[axis] ** 2), _LOG_STD[name])
    return priors


def operating_states(
    config: TwinConfig,
    measured: tuple[MeasuredMode, ...],
    found: Measured | None,
    residuals: Residuals,
    wind: float | None,
) -> States:
    """Return the data by wind speed: what the rotor damps is fitted in each wind, all else once.

    A parked rotor's damping is proportional to the wind (thin aerofoils at the same angle), so that one
    unknown serves every wind. The model's error stays where it is common to all winds: in the first state.
    """
    if found is None or wind is None or residuals.relative or not config.update.dashpots:
        return {"": (residuals, {})}
    apart = [m.mode for m in measured if m.fits_damping and _dashpot(m.label) in config.update.dashpots]
    apart = [mode for mode in apart if mode in (1, 2) and len(_winds(found.sightings[mode])) > 1]
    if not apart:
        return {"": (residuals, {})}
    common = tuple(
        Target(t.mode, t.frequency_hz, t.frequency_std_hz) if t.mode in apart else t
        for t in residuals.targets
    )
    states: States = {"all winds": (Residuals(common, relative=False), {})}
    for v in sorted({v for mode in apart for v in _winds(found.sightings[mode])}):
        targets = []
        for mode in apart:
            seen = tuple(s for s in found.sightings[mode] if s.wind_m_s == v)
            if seen:
                _, _, zeta, std = fuse(seen)
                targets.append(Target(mode, damping_ratio=zeta, damping_ratio_std=std))
        factors = {name: v / wind for name in config.update.dashpots}
        states[f"{v:g} m/s"] = (Residuals(tuple(targets), relative=False), factors)
    return states


def _dashpot(label: str) -> str | None:
    return next((name for start, name in _DIRECTIONS.items() if label.startswith(start)), None)


def _winds(seen: tuple[Sighting, ...]) -> set[float]:
    """Return the wind speeds of sightings; none if one is not known."""
    winds = {s.wind_m_s for s in seen}
    return set() if None in winds else {v for v in winds if v is not None}
