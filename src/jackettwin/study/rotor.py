"""The parked rotor of a twin: what wind it stood in, and what damping to expect of it."""

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
"""How far it may be off: blades bend, air lags, turbulence takes 11–18 %; drag is small."""
_BLADES = 3
"""Of a rotor nobody describes."""
_ANY_WIND_M_S = 10.0
"""A parked rotor's damping is proportional to the wind."""
_SIDES = {"c_fore_aft": (0, 2, 4), "c_side_side": (1, 3, 5)}
"""The tower top's DOFs that a rotor straight in the wind couples with each other."""

States = dict[str, tuple[Residuals, Mapping[str, float]]]


def mean_wind(config: TwinConfig, state: TwinState | None) -> float | None:
    """Return the wind speed [m/s] that nacelle dashpots are stated at: the twin's, or the records' mean."""
    if config.update.wind_speed_m_s is not None:
        return config.update.wind_speed_m_s
    total = None if state is None else state.totals.get(ALL)
    return None if total is None else total.conditions.wind_m_s


def rotor_speed_hz(config: TwinConfig) -> tuple[tuple[float, float] | None, int]:
    """Return lowest and highest speed of the rotor [Hz], as the twin or its rotor says, and its blades."""
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
    """What the rotor's geometry says of the nacelle's dashpots; empty without a rotor.

    A dashpot of c N·s/m takes from the first bending mode in its direction what c on the tower top's
    translation would; the rotor's 6×6 matrix says what it takes from all others: in the second bending mode
    the blades turn with the tower's slope.

    Attributes
    ----------
    patterns : {dashpot: (6, 6)}
    priors : {dashpot: median and standard deviation of ln c}
        Known only with the wind.
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
    """Return the damping (6, 6) of a feathered rotor for each m/s of wind: symmetric, averaged over azimuth.

    Of the whole geometry: cone and prebend bring the blades upwind of the hub, which doubles what a pitching
    or yawing tower top loses to straight blades.
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
    """Return the data by wind speed: what the rotor damps is fitted in each wind, all else once.

    A parked rotor's damping is proportional to the wind (thin aerofoils at the same angle), so that one
    unknown serves every wind. The model's error stays where it is common to all winds: in the first state.
    """
    if state is None or wind is None or residuals.relative or "c_side_side" not in config.update.dashpots:
        return {"": (residuals, {})}
    # fore-aft the rotor's drag is a small part: there its growth drowns in the records' scatter
    wanted = [m.mode for m in measured if m.fits_damping and m.label.startswith("side_side")]
    # a dashpot without the rotor's pattern touches the first modes alone
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
    """Tell whether a mode was seen in several states of operation, all of which say their wind."""
    seen = [v for total, v in winds.values() if mode in total.modes]
    return len(seen) > 1 and None not in seen
