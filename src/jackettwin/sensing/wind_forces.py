r"""What wind does to a rotor and its tower, as latent forces.

Gusts have Kaimal's spectrum and the coherence of IEC 61400-1 (2019), C.2,

.. math:: γ(f, r) = \exp(-12 \sqrt{(f r/U)^2 + (0.12\, r/L)^2}).

A working rotor's disc averages them, so that its force falls with f⁻⁴ above U/D, and not its moments, which
blades that pass make at their frequency, too. A rotor that stands with feathered blades has lift from v and
w, of which gusts are a third and a twelfth as long as those of u, along three lines. Forces act at the hub.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Literal, NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import AIR_KG_M3, TOWER_DRAG, Coefficients, morison_points, point_forces
from jackettwin.response import nodal_load
from jackettwin.sensing.latent_forces import LatentForce
from jackettwin.structure import Assembly

_INTEGRAL_SCALE_M = 340.2
"""8.1 Λ₁ of hubs above 60 m, IEC 61400-1 (2019) annex C."""
_USUAL_WIND_M_S = 10.0
USUAL_RADIUS_M = 120.0
"""Of a rotor that nobody described."""
_SPACING_M = 4.0
_FORCE_N = 1e5
"""To start from; the record decides."""


class _Push(NamedTuple):
    """How gusts push a rotor.

    Attributes
    ----------
    row : of the load at the hub, x along the axis
    corner : over U/6L
    tail : the upper corner over that one, beyond which the density falls with f⁻⁴ instead of f⁻²; or none
    beside, ratio, log_std : of another's level what this one's is expected to be, of a moment over the radius
    passing : of its level what blades that cut the same gusts make as they pass
    quick : whether what its spectrum lacks above some tenths of a hertz is sought in the record
    """

    name: str
    row: int
    corner: float
    tail: float | None = None
    beside: str | None = None
    ratio: float = 1.0
    log_std: float = 3.0
    passing: float | None = None
    quick: bool = False


_WORKING = (
    _Push("rotor Fx", 0, 0.62, 12.0, quick=True),
    _Push("rotor Fy", 1, 0.62, 12.0, "rotor Fx", 0.2, 0.5, quick=True),
    _Push("rotor Mx", 3, 1.0, None, "rotor Fy", 1.0 / 6.0, 1.0, 0.72, quick=True),
    _Push("rotor My", 4, 1.0, None, "rotor Fx", 1.0 / 6.0, 1.0, 0.72, quick=True),
    _Push("rotor Mz", 5, 1.0, None, "rotor Fx", 1.0 / 6.0, 1.0, 0.72, quick=True),
)
"""Gusts averaged over a disc of 240 m push, those on a point bend; three blades that cut them bend by 0.72.

From 6 to 24 m/s the corners of the mean coherence of all pairs of a disc's points lie at 0.59 to 0.63 and 7
to 10 U/6L. Around circles of three blades they lie at 0.74 and 8, those of moments at 1.45 and 10, and the
thrust has 0.25 of itself at the passing frequency. With these the evidence of records was greater, but
moments at the tower base were 5 % lower, further from the truth; why is not known."""
_STANDING = (
    _Push("rotor Fx", 0, 2.2, quick=True),
    _Push("rotor Fy", 1, 2.6, quick=True),
    _Push("rotor Mx", 3, 4.2, None, "rotor Fy", 0.2, 1.0, quick=True),
    _Push("rotor My", 4, 2.9, None, "rotor Fx", 0.4, 1.0, quick=True),
    _Push("rotor Mz", 5, 2.9, None, "rotor Fx", 0.25, 1.0),
)
"""The shipped rotor with feathered blades. The standard has no coherence of v and w: with that of u the
corners are 1.4 of the force aside, 1.8 of that along, 3.0 and 1.9 of moments; with none between points of a
field's grid of 19 m, where short gusts of many places add up, 5.0, 2.6, 6.0 and 4.0. Expected is a mean.

Without quick gusts whatever else moves the second modes, as drag of waves does, would be taken for slow ones,
whose moments then turn what no sensor sees turn. Quick ones of Mz alone no sensor on the axis would see."""
_PASSING_LOG_STD, _PASSING_RATE_LOG_STD, _PASSING_WIDTH = 0.3, 0.05, 0.05
"""Of the level and frequency of what passes, and its band: half lies within 3 to 5 % of the frequency."""
_QUICK_WORKING, _QUICK_STANDING = (25.0, 0.3), (40.0, 0.4)
"""Corner of quick gusts over U/6L, and their expected ratio to slow ones: the two have Kaimal's f^(-5/3)."""
_QUICK_LOG_STD, _QUICK_RATE_LOG_STD = 1.5, 0.3
"""Deviations of the logarithm of that ratio and of their corner's.

With a free corner the quick gusts fit what lies above 1 Hz and slow moments replace them: those were found
three times too large in a simulated record at work."""
_RATE_LOG_STD, _STANDING_RATE_LOG_STD = 0.2, 0.6
_THRUST_LOG_STD = 0.5
"""Of a working rotor's thrust, given how it damps: turbulence is not class B, a controller answers."""
_TURBULENCE, _GUSTS_LOG_STD = 0.14, 0.7
"""I_ref of class B (IEC 61400-1 (2019), eq. (10)): drag on a tower varies by 2Uσ in a wind that is stated."""
_TOWER = "tower"


@dataclass(frozen=True)
class RotorPlace:
    """Where a rotor's forces act: at the hub, on axes of its own.

    Attributes
    ----------
    hub : from the tower top (3,) [m] at heading 0
    heading_rad : of its axis, anticlockwise from x seen from above
    radius_m : of its blades
    """

    hub: tuple[float, float, float] = (0.0, 0.0, 0.0)
    heading_rad: float = 0.0
    radius_m: float = USUAL_RADIUS_M

    def on_top(self, row: int) -> tuple[float, ...]:
        """Return the load (6,) on the tower top, in global axes, of a unit one at the hub in the rotor's."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        force, moment = np.kron(np.eye(2), turn)[:, row].reshape(2, 3)
        return (*force, *(moment + np.cross(turn @ self.hub, force)))


def with_thrust(forces: tuple[LatentForce, ...], level_n: Mapping[str, float]) -> tuple[LatentForce, ...]:
    """Return forces whose rotor is expected to push by so much; moments and quick gusts go with it.

    Parameters
    ----------
    level_n : {"rotor Fx": standard deviation of its slow gusts}
    """
    named = {force.name: force for force in forces}

    def expected(force: LatentForce) -> LatentForce:
        root = force
        while root.beside is not None:
            root = named[root.beside]
        if root.name not in level_n:
            return force
        level = force.level * level_n[root.name] / root.level
        return replace(
            force, level=level, level_log_std=force.level_log_std if force.beside else _THRUST_LOG_STD
        )

    return tuple(expected(force) for force in forces)


def gusts_std(wind_m_s: float) -> float:
    """Return the standard deviation of the wind's speed [m/s]: IEC 61400-1 (2019), eq. (10), class B."""
    return _TURBULENCE * (0.75 * wind_m_s + 5.6)


def gust_corner(wind_m_s: float | None) -> float:
    """Return the corner a [rad/s] of gusts in a mean wind: U/6L of Kaimal's spectrum, IEC 61400-1 (C.14)."""
    return 2.0 * pi * (_USUAL_WIND_M_S if wind_m_s is None else wind_m_s) / (6.0 * _INTEGRAL_SCALE_M)


def wind_forces(
    assembly: Assembly,
    place: RotorPlace,
    *,
    wind_m_s: float | None = None,
    working: bool = False,
) -> tuple[LatentForce, ...]:
    """Return the wind's forces and moments at the hub and its drag along the tower.

    What sensors hardly tell apart is expected in proportion: a moment to its force, quick gusts to slow ones.
    Quick ones, whose levels the record tells, are for what is above the corners of the others, where spectra
    fall less than theirs.
    """
    corner, nothing = gust_corner(wind_m_s), np.zeros((assembly.mesh.start.size, 12))
    speed = _USUAL_WIND_M_S if wind_m_s is None else wind_m_s
    drag, known = 2.0 * speed * gusts_std(speed), 3.0 if wind_m_s is None else _GUSTS_LOG_STD
    known_rate = _RATE_LOG_STD if working else _STANDING_RATE_LOG_STD
    slow: list[LatentForce] = []
    quick: list[LatentForce] = []
    for push in _WORKING if working else _STANDING:
        root = next((f.level for f in slow if f.name == push.beside), _FORCE_N)
        level = root * push.ratio * (place.radius_m if push.row >= 3 else 1.0)
        load = nodal_load(assembly, {assembly.structure.top_node: place.on_top(push.row)})
        kind: Literal["gust", "disc"] = "gust" if push.tail is None else "disc"
        at = push.corner * corner, level, push.log_std, known_rate, push.beside
        slow.append(LatentForce(push.name, load, nothing, kind, *at, tail=push.tail or 1.0))
        if push.quick:
            quick.append(slow[-1])
    for axis, load in zip("xy", _on_tower(assembly), strict=False):
        slow.append(LatentForce(f"tower {axis}", load, nothing, "gust", corner, drag, known))
        quick.append(slow[-1])
    rate, share = _QUICK_WORKING if working else _QUICK_STANDING
    return (*slow, *(_quick(f, rate * corner, share) for f in quick))


def _quick(force: LatentForce, rate: float, share: float) -> LatentForce:
    return replace(
        force,
        name=f"{force.name}, quick",
        kind="gust",
        rate=rate,
        level=share * force.level,
        level_log_std=_QUICK_LOG_STD,
        rate_log_std=_QUICK_RATE_LOG_STD,
        beside=force.name,
    )


def passing_forces(forces: tuple[LatentForce, ...], passing_hz: float) -> tuple[LatentForce, ...]:
    """Return the moments of gusts that blades cut as they pass, beside the slow ones of the same rotor."""
    named = {force.name: force for force in forces}
    return tuple(
        replace(
            named[push.name],
            name=f"{push.name}, passing",
            kind="wave",
            rate=2.0 * pi * passing_hz,
            level=push.passing * named[push.name].level,
            level_log_std=_PASSING_LOG_STD,
            rate_log_std=_PASSING_RATE_LOG_STD,
            beside=push.name,
            width=_PASSING_WIDTH,
            tail=1.5,
        )
        for push in _WORKING
        if push.passing is not None
    )


def _on_tower(assembly: Assembly) -> tuple[FloatArray, ...]:
    """Return the drag (n_dof,) of unit wind along x and along y on the tower; nothing without one."""
    others = tuple({m.part for m in assembly.structure.members} - {_TOWER})
    if all(m.part != _TOWER for m in assembly.structure.members):
        return ()
    air = Coefficients(TOWER_DRAG, 0.0, 0.0, density_kg_m3=AIR_KG_M3)
    grid = morison_points(assembly, lowest_z=0.0, spacing=_SPACING_M, exclude_parts=others, coefficients=air)
    still = np.zeros_like(grid.points)
    return tuple(
        np.asarray(grid.N @ point_forces(grid, still + unit, still).ravel()) for unit in np.eye(3)[:2]
    )
