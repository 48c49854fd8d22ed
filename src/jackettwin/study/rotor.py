"""The rotor of a twin, parked or at work: what wind it was in, and what damping to expect of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import located
from jackettwin.loads import OPERATING_LOG_STD, linearise, read_rotor
from jackettwin.response import Matrix, UndampedModes
from jackettwin.structure import Assembly
from jackettwin.study.measure import mean_target
from jackettwin.study.measurements import MeasuredMode
from jackettwin.twin import (
    ALL,
    USUAL_WIND_M_S,
    OperationTotal,
    TwinConfig,
    TwinState,
    of_side,
    rotor_at_work,
    stiffness_at_work,
)
from jackettwin.updating import DASHPOTS, Residuals, Target

_LOG_STD = {
    "parked": {"c_fore_aft": 0.8, "c_side_side": 0.4},
    "operating": {f"c_{side}": std for side, std in OPERATING_LOG_STD.items()},
}
"""Its error, as a ratio: blades bend, air lags, turbulence takes 11–18 %; drag is small."""
_BLADES = 3
"""Number of blades of a rotor without a description."""
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
    """Dashpots of the nacelle, and stiffness, derived from the rotor's geometry; empty without a rotor.

    A dashpot of c N·s/m damps the first bending mode in its direction like a damper c on the tower top's
    translation. Its effect on all other modes follows from the rotor's 6×6 matrix, for in the second bending
    mode the blades rotate with the tower's slope.

    Attributes
    ----------
    patterns : {dashpot: (6, 6)}
    priors : {dashpot: median and standard deviation of ln c}
        Known only if the wind speed is known.
    stiffness : what a rotor at work adds to the structure's, (n_dof, n_dof), or None
    """

    patterns: Mapping[str, FloatArray]
    priors: Mapping[str, tuple[float, float]]
    stiffness: Matrix | None = None


def rotor_damping(
    config: TwinConfig, assembly: Assembly, numbered: UndampedModes, wind: float | None
) -> RotorDamping:
    """Return the dashpots' patterns S and priors, and the stiffness of a rotor at work.

    C = cS with c = φᵀCφ/φ_j², φ the tower top's motion in the first mode of that direction.

    Raises
    ------
    InputError
        If the rotor's files are wrong, or its schedule does not reach the wind.
    """
    if config.update.rotor is None:
        return RotorDamping({}, {})
    seen, stiffness = wind or USUAL_WIND_M_S, None
    names: tuple[str, ...] = config.update.dashpots
    if config.update.rotor_state == "operating":
        sides = rotor_at_work(config, assembly, numbered, seen)
        patterns = {name: sides[name].pattern for name in names}
        sizes = {name: sides[name].dashpot for name in names}
        stiffness = stiffness_at_work(sides, assembly)
    else:
        C = _parked_matrix(config, seen)
        parts = {name: of_side(C, name) for name in names}
        sizes = {name: _dashpot(part, name, assembly, numbered) for name, part in parts.items()}
        patterns = {name: part / sizes[name] for name, part in parts.items()}
    stds = _LOG_STD[config.update.rotor_state]
    priors = {} if wind is None else {name: (c, stds[name]) for name, c in sizes.items()}
    return RotorDamping(patterns, priors, stiffness)


def _dashpot(C: FloatArray, name: str, assembly: Assembly, numbered: UndampedModes) -> float:
    """Return the dashpot at the tower top that takes what C does from the first mode of its direction."""
    top = numbered.shapes[assembly.dofs(assembly.structure.top_node)]
    axis = DASHPOTS[name]
    phi = top[:, int(np.argmax(np.abs(top[axis, :2])))]
    return float(phi @ C @ phi / phi[axis] ** 2)


def _parked_matrix(config: TwinConfig, wind: float) -> FloatArray:
    """Return the damping (6, 6) of a parked rotor in a wind, averaged over azimuth.

    The geometry includes cone and prebend, which place the blades upwind of the hub and so double the damping
    of a pitching or yawing tower top compared with straight blades. It is proportional to the wind.
    """
    given = config.update
    with located(file=config.path, field="update"):
        rotor, _ = read_rotor(given.rotor or "")
        return linearise(rotor, wind, pitch=0.5 * np.pi, shaft=given.shaft or "locked").damping


def operating_states(
    config: TwinConfig,
    measured: tuple[MeasuredMode, ...],
    state: TwinState | None,
    residuals: Residuals,
    wind: float | None,
    *,
    assembly: Assembly,
    numbered: UndampedModes,
) -> States:
    """Return the data by wind speed: modes that the rotor damps in each wind, all other modes once.

    A parked rotor's damping is proportional to the wind (thin aerofoils at the same angle), that of one at
    work changes as computed: one unknown serves every wind. The model's error stays where it is common to all
    winds, in the first state.
    """
    if state is None or wind is None or residuals.relative or "c_side_side" not in config.update.dashpots:
        return {"": (residuals, {})}
    # fore-aft a parked rotor's drag is a small part: there its growth drowns in the records' scatter
    works = config.update.rotor_state == "operating"
    sides = ("side_side", "fore_aft") if works else ("side_side",)
    wanted = [m.mode for m in measured if m.fits_damping and m.label.startswith(sides)]
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
    # without a rotor's description dashpots grow as a parked rotor's
    described = works and config.update.rotor is not None
    stated = rotor_at_work(config, assembly, numbered, wind) if described else {}
    states: States = {"all winds": (Residuals(common, relative=False), {})}
    for name, (total, v) in sorted(winds.items(), key=lambda item: (item[1][1] or 0.0, item[0])):
        targets = [
            replace(mean_target(mode, total.modes[mode]), frequency_hz=None, frequency_std_hz=None)
            for mode in apart
            if mode in total.modes
        ]
        if targets and v is not None:
            grown: dict[str, float] = dict.fromkeys(config.update.dashpots, v / wind)
            if stated:
                here = stated if v == wind else rotor_at_work(config, assembly, numbered, v)
                grown = {name: here[name].dashpot / stated[name].dashpot for name in grown}
            states[name] = (Residuals(tuple(targets), relative=False), grown)
    return states


def _in_several_winds(mode: int, winds: Mapping[str, tuple[OperationTotal, float | None]]) -> bool:
    """Return whether a mode was measured in several states of operation, all with a known wind speed."""
    seen = [v for total, v in winds.values() if mode in total.modes]
    return len(seen) > 1 and None not in seen
