r"""Waves as latent forces, and the damping by their drag on moving members.

A sea of many periods is three bands, since its waves reach down as far as they are long: long waves bend the
whole jacket, short ones of the same record push near the surface only. Waves of a band have many periods and
ways, each with the forces at the phase of every member's place (Morison's equation, its drag linearised):

.. math:: f = ρ C_M \tfrac{π}{4} D^2 \dot u_n + ½ ρ C_D D \sqrt{8/π}\, σ_u\, u_n

for water of unit acceleration at the surface. Drag that errs least on average does the damage of u|u|, too,
in a sea from several ways, whose drag is largest where inertia is least. Forces of all waves of a band have
few principal patterns, whose histories are independent. A wave of one period in their stead would push legs
together that stand half a wave apart, or all against each other: a band's force on the jacket as a whole was
a quarter to twice of what it is, so that the level by which sensors were followed was wrong for every brace.
What principal patterns leave out moves nothing that sensors see, and is a seventh of the stress of braces
about the sea: it is not estimated, but drawn at the band's level. The level expected of a band is that of
the water's acceleration in it, of a JONSWAP sea. Drag damps the motion of members, braces most of all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import pi, sqrt
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.integrate import cumulative_trapezoid

from jackettwin.arrays import FloatArray
from jackettwin.loads import (
    MorisonPoints,
    SeaState,
    depth_functions,
    jonswap,
    loads_along,
    morison_points,
    sea_drag_damping,
    velocity_std,
    wave_number,
    wetness,
)
from jackettwin.sensing.latent_forces import LatentForce, LocalWaves
from jackettwin.sensing.readings import Weather
from jackettwin.structure import Assembly


class _Band(NamedTuple):
    """Waves about a multiple of the peak frequency, how far their own may lie from it, and their spectrum."""

    name: str
    multiple: float
    rate_log_std: float
    width: float
    tail: float
    patterns: int


_BANDS = (
    _Band("long", 1.02, 0.1, 0.09, 1.25, 4),
    _Band("middle", 1.56, 0.05, 0.12, 0.87, 5),
    _Band("short", 2.85, 0.05, 0.15, 0.6, 6),
)
"""Waves of each reach as deep as those at its multiple do, whatever their frequency, so that its tail must be
short: chosen for the water's acceleration at 1, 8, 20, 30 and 42 m under JONSWAP's seas of 1.5 to 8 m, which
it has within 8 % where it is not small, and its rate, too. As wide as a sea’s (a ratio of 0.25) it was 5
to 14 % too large at 20 to 42 m, its rate 10 to 28 %, and twice to ten times where deep braces vibrate."""
_SHORTEST = 5.0
"""Multiple of the peak frequency beyond which waves reach no member but at the surface."""
_SPACING_M = 4.0
_USUAL_HEIGHT_M, _USUAL_PERIOD_S = 1.5, 7.0
_WAVES, _WAYS = 8, 11
"""Frequencies of a band, and ways in which its waves run: with seven short waves push 23 % less across."""
_WHOLE = 0.3
"""Weight of a resultant beside the forces: from 0.3 to 1 the first nine modes are pushed alike within 1 %."""
_LOCAL = 12
"""Patterns of a band beyond its principal ones: all but 0.5 % of what stress of braces is left by these."""
_SPREADING = 4
"""n of cosⁿ about the mean direction: wind seas have 2 to 4, swell more (DNV-RP-C205 (2021), 3.5.8)."""
_BESIDE = 0.3
"""Of a pattern's level over that of its band: a sea spreads less or more than that."""
_KNOWN, _UNKNOWN = 0.3, 1.5
"""Of the logarithm of a sea's level, whose height is stated or not."""
_DRAG = sqrt(8.0 / pi)
"""c of the drag that errs least on average (Borgman 1967)."""


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

    def with_other_water(self, growth: float, added_mass: float, drag: float) -> SeaOnMembers:
        """Return the sea on members with so many times the growth's thickness, C_a and C_D."""
        grid, steel = self.grid, self.grid.tube_diameter
        other = replace(
            grid,
            diameter=steel + growth * (grid.diameter - steel),
            added_mass=added_mass * grid.added_mass,
            drag=drag * grid.drag,
        )
        return replace(self, grid=other)

    def forces(self) -> tuple[LatentForce, ...]:
        """Return the forces of each band: the principal patterns of its waves, the largest first."""
        return tuple(force for band in self._principal for force in band)

    def local(self) -> tuple[LocalWaves, ...]:
        """Return what of each band its principal patterns do not hold."""
        return tuple(
            LocalWaves(
                principal,
                np.asarray(self.grid.N @ others.T),
                np.array([np.asarray(self._along @ push).reshape(-1, 12) for push in others]),
            )
            for principal, (band, _, patterns) in zip(self._principal, self._patterns, strict=True)
            for others in (patterns[band.patterns :],)
        )

    @cached_property
    def _principal(self) -> tuple[tuple[LatentForce, ...], ...]:
        peak = 2.0 * pi / self.state.Tp
        return tuple(
            tuple(
                LatentForce(
                    f"{band.name} waves {k}",
                    np.asarray(self.grid.N @ push),
                    np.asarray(self._along @ push).reshape(-1, 12),
                    "wave",
                    band.multiple * peak,
                    level,
                    _BESIDE,
                    band.rate_log_std,
                    shared_log_std=self.level_log_std,
                    width=band.width,
                    tail=band.tail,
                )
                for k, push in enumerate(patterns[: band.patterns], start=1)
            )
            for band, level, patterns in self._patterns
        )

    @cached_property
    def _along(self) -> sp.csr_array:
        return loads_along(self.assembly, self.grid)

    @cached_property
    def _patterns(self) -> list[tuple[_Band, float, FloatArray]]:
        """Bands, their levels, and their patterns (n, 3 n_points), the largest first."""
        peak, found = 2.0 * pi / self.state.Tp, []
        for band, (level, multiples) in zip(_BANDS, self._bands(), strict=True):
            waves = self._waves(multiples * peak)
            kept = np.linalg.eigh(self._likeness(waves))[1].T[: -band.patterns - _LOCAL - 1 : -1]
            found.append((band, level, kept @ waves))
        return found

    def _bands(self) -> list[tuple[float, FloatArray]]:
        """Return the standard deviation of the surface's acceleration in each band [m/s²], and its waves.

        Waves are multiples of the peak frequency, each of which has as much of its variance.
        """
        ends = [0.0, *(sqrt(a.multiple * b.multiple) for a, b in pairwise(_BANDS)), _SHORTEST]
        found = []
        for low, high in pairwise(ends):
            x = np.linspace(low, high, 200)
            f = x / self.state.Tp
            S = (2.0 * pi * f) ** 4 * jonswap(f, Hs=self.state.Hs, Tp=self.state.Tp)
            below = cumulative_trapezoid(S, f, initial=0)
            shares = (np.arange(_WAVES) + 0.5) / _WAVES
            found.append((sqrt(float(below[-1])), np.interp(shares * below[-1], below, x)))
        return found

    def _likeness(self, waves: FloatArray) -> FloatArray:
        """Return the products (n, n) of waves (n, 3 n_points): of forces, and of what they sum up to.

        Resultants sideways and their moments weigh a third of all forces each. By forces alone the push of
        short waves across the sea, which moves the tower, was lost among those that legs bear of themselves.
        """
        x, y, z = self.grid.points.T
        o, one = np.zeros_like(x), np.ones_like(x)
        per_force = np.array([[one, o, o, z], [o, one, -z, o], [o, o, y, -x]])
        sums = waves @ per_force.transpose(2, 0, 1).reshape(-1, 4)
        alike = waves @ waves.T
        whole = float(np.trace(alike))
        for own in (sums[:, :2], sums[:, 2:]):
            alike = alike + _WHOLE * whole / max(float(np.square(own).sum()), 1e-300) * own @ own.T
        return np.asarray(alike)

    def _waves(self, omega: FloatArray) -> FloatArray:
        """Return forces (n, 3 n_points) of waves of a unit of acceleration at the surface, in all.

        Of each frequency they run from all sides, by cos⁴ about the mean direction, and each has two phases.
        Drag is linear in the sea's mean speed across the members.
        """
        grid = self.grid
        wet = wetness(grid, np.zeros(grid.weight.size)) * grid.weight
        mass = grid.inertia_per_length * wet
        # the speed's deviation is of one of two ways across a member, and a sea runs along one
        dashpot = sqrt(2.0) * grid.drag_per_length * wet * self.speed_std
        away = 0.5 * pi * (2.0 * (np.arange(_WAYS) + 0.5) / _WAYS - 1.0)
        spread = np.cos(away) ** _SPREADING
        share = np.sqrt(spread / spread.sum() / omega.size)
        angle = self.state.direction + away
        d = np.stack([np.cos(angle), np.sin(angle), np.zeros(_WAYS)], axis=1)
        level, upright, along = grid.normal @ d.T, grid.normal[:, :, 2].T, grid.points @ d.T
        level, found = level.transpose(2, 1, 0).copy(), []
        z, numbers = np.minimum(grid.points[:, 2], 0.0), wave_number(omega, self.depth_m)
        for w, k, across, up in zip(
            omega, numbers, *(part.T for part in depth_functions(numbers, z, self.depth_m)), strict=True
        ):
            turned = (share * np.exp(-1j * float(k) * along)).T * (mass + _DRAG * dashpot / (1j * w))
            found.append(turned[:, None] * (across * level + 1j * up * upright))
        every = np.concatenate(found).transpose(0, 2, 1)
        return np.concatenate([every.real, every.imag]).reshape(2 * len(every), -1)
