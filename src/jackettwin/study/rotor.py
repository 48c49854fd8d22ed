"""The parked rotor of a twin: its wind speed and its expected damping."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import located
from jackettwin.loads import Rotor, linearise, read_rotor
from jackettwin.response import UndampedModes
from jackettwin.structure import Assembly
from jackettwin.study.measure import mean_target
from jackettwin.study.measurements import MeasuredMode
from jackettwin.twin import ALL, OperationTotal, TwinConfig, TwinState
from jackettwin.updating import DASHPOTS, Residuals, Target

_LOG_STD = {"c_fore_aft": 0.8, "c_side_side": 0.4}
"""Standard deviation of ln c: blades bend, the flow lags, turbulence reduces c by 11–18 %; drag is small."""
_BLADES = 3
"""Number of blades of a rotor without a description."""
_ANY_WIND_M_S = 10.0
"""Arbitrary wind speed for the damping of a parked rotor, which is proportional to it."""
_SIDES = {"c_fore_aft": (0, 2, 4), "c_side_side": (1, 3, 5)}
"""Degrees of freedom of the tower top that a rotor without yaw error couples with each other."""

States = dict[str, tuple[Residuals, Mapping[str, float]]]


def mean_wind(config: TwinConfig, state: TwinState | None) -> float | None:
    """Return the wind speed [m/s] that nacelle dashpots are stated at: the twin's, or the records' mean."""
    if config.update.wind_speed_m_s is not None:
        return config.update.wind_speed_m_s
    total = None if state is None else state.totals.get(ALL)
    return None if total is None else total.conditions.wind_m_s


def rotor_speed_hz(config: TwinConfig) -> tuple[tuple[float, float] | None, int]:
    """Return the speed range of the rotor [Hz], as the twin or its rotor states, and its number of blades."""
    blades, speed = _BLADES, None
    if config.update.rotor is not None:
        with located(file=config.path, field="update"):
            rotor, control = read_rotor(config.update.rotor)
        blades = rotor.n_blades
        speed = (control.lowest_speed_rad_s / (2.0 * np.pi), control.highest_speed_rad_s / (2.0 * np.pi))
    if config.rotor_speed_rpm is not None:
        low, high = config.rotor_speed_rpm
        speed = (low / 60.0, high / 60.0)
    return speed, blades


@dataclass(frozen=True)
class RotorDamping:
    """Dashpots of the nacelle derived from the rotor's geometry; empty without a rotor.

    A dashpot of c N·s/m damps the first bending mode in its direction like a damper c on the tower top's
    translation. Its effect on all other modes follows from the rotor's 6×6 matrix, for in the second bending
    mode the blades rotate with the tower's slope.

    Attributes
    ----------
    patterns : {dashpot: (6, 6)}
    priors : {dashpot: median and standard deviation of ln c}
        Known only if the wind speed is known.
    """

    patterns: Mapping[str, FloatArray]
    priors: Mapping[str, tuple[float, float]]


def rotor_damping(
    config: TwinConfig, assembly: Assembly, numbered: UndampedModes, wind: float | None
) -> RotorDamping:
    """Return the dashpots' patterns S and priors.

    C = cS with c = φᵀCφ/φ_j², φ the tower top's motion in the first mode of that direction.
    """
    if config.update.rotor is None:
        return RotorDamping({}, {})
    with located(file=config.path, field="update"):
        per_wind = _per_wind(read_rotor(config.update.rotor)[0], config.update.shaft)
    top = numbered.shapes[assembly.dofs(assembly.structure.top_node)]
    patterns: dict[str, FloatArray] = {}
    priors: dict[str, tuple[float, float]] = {}
    for name in config.update.dashpots:
        axis, dofs = DASHPOTS[name], np.ix_(_SIDES[name], _SIDES[name])
        C = np.zeros((6, 6))
        C[dofs] = per_wind[dofs]
        phi = top[:, int(np.argmax(np.abs(top[axis, :2])))]
        c = float(phi @ C @ phi / phi[axis] ** 2)
        patterns[name] = C / c
        if wind is not None:
            priors[name] = (c * wind, _LOG_STD[name])
    return RotorDamping(patterns, priors)


def _per_wind(rotor: Rotor, shaft: str) -> FloatArray:
    """Return the symmetric damping (6, 6) of a feathered rotor per m/s of wind, averaged over azimuth.

    The geometry includes cone and prebend, which place the blades upwind of the hub and so double the damping
    of a pitching or yawing tower top compared with straight blades.
    """
    C = linearise(rotor, _ANY_WIND_M_S, pitch=0.5 * np.pi, shaft=shaft).damping / _ANY_WIND_M_S
    return np.asarray(0.5 * (C + C.T))


def operating_states(
    config: TwinConfig,
    measured: tuple[MeasuredMode, ...],
    state: TwinState | None,
    residuals: Residuals,
    wind: float | None,
) -> States:
    """Return the data by wind speed: modes that the rotor damps in each wind, all other modes once.

    A parked rotor's damping is proportional to the wind (thin aerofoils at the same angle), so that one
    unknown suffices for all winds. The model error, common to all winds, is assigned to the first state.
    """
    if state is None or wind is None or residuals.relative or "c_side_side" not in config.update.dashpots:
        return {"": (residuals, {})}
    # fore-aft the rotor's drag is small, and its growth is less than the scatter between records
    wanted = [m.mode for m in measured if m.fits_damping and m.label.startswith("side_side")]
    # a dashpot without the rotor's pattern damps the first modes only
    touched = (1, 2) if config.update.rotor is None else (1, 2, 4, 5)
    winds = {name: (total, total.conditions.wind_m_s) for name, total in state.totals.items() if name != ALL}
    apart = [mode for mode in wanted if mode in touched and _in_several_winds(mode, winds)]
    if not apart:
        return {"": (residuals, {})}
    common = tuple(
        Target(t.mode, t.frequency_hz, t.frequency_std_hz) if t.mode in apart else t
        for t in residuals.targets
    )
    states: States = {"all winds": (Residuals(common, relative=False), {})}
    for name, (total, v) in sorted(winds.items(), key=lambda item: (item[1][1] or 0.0, item[0])):
        targets = [
            replace(mean_target(mode, total.modes[mode]), frequency_hz=None, frequency_std_hz=None)
            for mode in apart
            if mode in total.modes
        ]
        if targets and v is not None:
            factors: dict[str, float] = dict.fromkeys(config.update.dashpots, v / wind)
            states[name] = (Residuals(tuple(targets), relative=False), factors)
    return states


def _in_several_winds(mode: int, winds: Mapping[str, tuple[OperationTotal, float | None]]) -> bool:
    """Return whether a mode was measured in several states of operation, all with a known wind speed."""
    seen = [v for total, v in winds.values() if mode in total.modes]
    return len(seen) > 1 and None not in seen
