r"""Waves as latent forces, and the damping by their drag on moving members.

A sea of many periods is three bands, since its waves reach down as far as they are long: long waves bend the
whole jacket, short ones of the same record push near the surface only. Each band has the forces of a regular
wave of its own period, at the phase of every member's place (Morison's equation, its drag linearised):

.. math:: f = ρ C_M \tfrac{π}{4} D^2 \dot u_n + ½ ρ C_D D\, c\, σ_u\, u_n

for water of unit acceleration at the surface, with c such that ranges of the drag have the third moment of
those of u|u|, since ranges do the damage: the usual c = √(8/π), which errs least on average, is a third too
small. The level expected of a band is the standard deviation of that acceleration in it, of a JONSWAP sea.
Drag with the usual coefficient damps the motion of members, braces most of all.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.loads import (
    MorisonPoints,
    SeaState,
    depth_functions,
    jonswap,
    loads_along,
    morison_points,
    point_forces,
    sea_drag_damping,
    velocity_std,
    wave_number,
    wetness,
)
from jackettwin.sensing.latent_forces import LatentForce
from jackettwin.sensing.readings import Weather
from jackettwin.structure import Assembly


class _Band(NamedTuple):
    """Waves about a multiple of the peak frequency, how far their own may lie from it, and their spectrum."""

    name: str
    multiple: float
    rate_log_std: float
    width: float
    tail: float


_BANDS = (
    _Band("long", 1.02, 0.1, 0.09, 1.25),
    _Band("middle", 1.56, 0.05, 0.12, 0.87),
    _Band("short", 2.85, 0.05, 0.15, 0.6),
)
"""Waves of each reach as deep as those at its multiple do, whatever their frequency, so that its tail must be
short: chosen for the water's acceleration at 1, 8, 20, 30 and 42 m under JONSWAP's seas of 1.5 to 8 m, which
it has within 8 % where it is not small, and its rate, too. As wide as a sea’s (a ratio of 0.25) it was 5
to 14 % too large at 20 to 42 m, its rate 10 to 28 %, and twice to ten times where deep braces vibrate."""
_SHORTEST = 5.0
"""Multiple of the peak frequency beyond which waves reach no member but at the surface."""
_SPACING_M = 4.0
_USUAL_HEIGHT_M, _USUAL_PERIOD_S = 1.5, 7.0
_ALONG, _ACROSS = sqrt(0.75), 0.5
"""Of the water's acceleration in a sea that spreads as cos² about its mean direction, along and across it."""
_KNOWN, _UNKNOWN = 0.3, 1.5
"""Of the logarithm of a sea's level, whose height is stated or not."""
_DRAG = (48.0 / (3.0 * sqrt(pi / 2.0))) ** (1.0 / 3.0)
"""c = (E A⁶ / E A³)^⅓ of Rayleigh's amplitudes A of unit standard deviation: 2.34."""
_SAME = 0.05
"""Of a level at crests over that between them: waves pass, so that both are one of a long record."""


@dataclass(frozen=True)
class SeaOnMembers:
    """A sea on the members of a structure.

    Attributes
    ----------
    assembly : Assembly
    grid : MorisonPoints
        Below still water.
    state : SeaState
    depth_m : float
    level_log_std : how far the logarithm of its height may lie from what is stated
    """

    assembly: Assembly
    grid: MorisonPoints
    state: SeaState
    depth_m: float
    level_log_std: float

    @classmethod
    def of(cls, assembly: Assembly, weather: Weather) -> SeaOnMembers:
        """Return the sea of a record, a usual one where it is not stated.

        Raises
        ------
        InputError
            If no tube reaches into the water.
        """
        structure = assembly.structure
        depth = weather.depth_m or structure.sea_level_z_m - min(z for _, _, z in structure.nodes.values())
        grid = morison_points(
            assembly,
            highest_z=0.0,
            lowest_z=-depth,
            coefficients=weather.coefficients,
            spacing=_SPACING_M,
        )
        state = SeaState(
            weather.wave_height_m or _USUAL_HEIGHT_M,
            weather.wave_period_s or _USUAL_PERIOD_S,
            weather.wave_direction_rad,
        )
        return cls(assembly, grid, state, depth, _KNOWN if weather.wave_height_m else _UNKNOWN)

    def damping(self) -> sp.csr_array:
        """Return the linearised drag on the members' own motion, (n_dof, n_dof)."""
        return sea_drag_damping(self.grid, self.state, self.depth_m, self.speed_std)

    @cached_property
    def speed_std(self) -> FloatArray:
        """Standard deviation of the water's velocity normal to the members, (n_points,) [m/s]."""
        return velocity_std(self.grid, self.state, self.depth_m)

    def forces(self) -> tuple[LatentForce, ...]:
        """Return the forces of each band along and across the sea, at its crests and between them."""
        peak, heading, found = 2.0 * pi / self.state.Tp, self.state.direction, []
        spread = loads_along(self.assembly, self.grid)
        ways = (("along", heading, _ALONG), ("across", heading + 0.5 * pi, _ACROSS))
        speed = _DRAG * self.speed_std
        for band, level in zip(_BANDS, self._levels(), strict=True):
            omega = band.multiple * peak
            for way, angle, share in ways:
                between = f"{band.name} waves {way}, between crests"
                for place, turn in (("between crests", 0.0), ("at crests", 0.5 * pi)):
                    push = self._push(omega, angle, turn, speed).ravel()
                    found.append(
                        LatentForce(
                            f"{band.name} waves {way}, {place}",
                            np.asarray(self.grid.N @ push),
                            np.asarray(spread @ push).reshape(-1, 12),
                            "wave",
                            omega,
                            share * level,
                            _SAME if turn else self.level_log_std,
                            band.rate_log_std,
                            between if turn else None,
                            width=band.width,
                            tail=band.tail,
                        )
                    )
        return tuple(found)

    def _levels(self) -> list[float]:
        """Return the standard deviation of the surface's acceleration in each band [m/s²]."""
        ends = [0.0, *(sqrt(a.multiple * b.multiple) for a, b in pairwise(_BANDS)), _SHORTEST]
        found = []
        for low, high in pairwise(ends):
            f = np.linspace(low, high, 200) / self.state.Tp
            S = jonswap(f, Hs=self.state.Hs, Tp=self.state.Tp)
            found.append(sqrt(float(np.trapezoid((2.0 * pi * f) ** 4 * S, f))))
        return found

    def _push(self, omega: float, angle: float, turn: float, speed: FloatArray) -> FloatArray:
        """Return the forces (n, 3) of a wave of unit acceleration at the surface, at a phase.

        Drag is linear in the sea's mean ``speed`` (n,) across the members.
        """
        grid, d = self.grid, np.array([cos(angle), sin(angle), 0.0])
        k, z = wave_number(np.array([omega]), self.depth_m), np.minimum(self.grid.points[:, 2], 0.0)
        across, up = (part[:, 0, None] for part in depth_functions(k, z, self.depth_m))
        turned = np.exp(1j * (turn - float(k[0]) * (grid.points @ d)))[:, None]
        water = turned * (across * d + 1j * up * [0.0, 0.0, 1.0])
        wet = wetness(grid, np.zeros(grid.weight.size))
        inertia = point_forces(grid, np.zeros(water.shape), water.real, wet=wet)
        drag = 0.5 * grid.density_kg_m3 * grid.drag * grid.diameter * speed * grid.weight * wet
        return np.asarray(
            inertia + drag[:, None] * np.einsum("nij,nj->ni", grid.normal, (water / (1j * omega)).real)
        )
