r"""Screening of members for vortex-induced vibration by their reduced velocity.

.. math:: V_R = \frac{U}{f D}

Below its onset nothing needs to be shown. In air the onset is that of EN 1991-1-4:2005, E.1.2(2):
:math:`v_{crit} = fD/St > 1.25\,v_m` with St = 0.18 (table E.1). In water it is 1 in line with the flow and 3
across it (DNV-RP-C205, 2010, section 9). Within its ranges of lock-in (in line 1 to 4.5, across 3 to 16 in
water; 1.7 to 3.2 and 4.7 to 8 in air) vortices follow the member's motion. Beyond the onset the response
itself has to be shown: not done here.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, sqrt
from typing import Literal, NamedTuple

from jackettwin.checks.columns import columns
from jackettwin.constants import SEA_WATER_KG_M3
from jackettwin.errors import require_between
from jackettwin.structure import PILES, Member, Structure

STROUHAL = 0.18
"""Of a circular cylinder, EN 1991-1-4:2005, table E.1."""
ONSET_IN_AIR = 1.0 / (1.25 * STROUHAL)
ONSET_IN_LINE, ONSET_ACROSS = 1.0, 3.0
LOCK_IN: Mapping[str, tuple[tuple[float, float], tuple[float, float]]] = {
    "water": ((ONSET_IN_LINE, 4.5), (ONSET_ACROSS, 16.0)),
    "air": ((1.7, 3.2), (4.7, 8.0)),
}
"""Reduced velocities from and up to which vortices lock on, in line and across (DNV-RP-C205 section 9)."""
CLAUSES: Mapping[str, str] = {"air": "EN 1991-1-4 E.1.2(2)", "water": "DNV-RP-C205 section 9"}


class VortexUse(NamedTuple):
    """A member in a flow.

    Attributes
    ----------
    member, part : str
    medium : {"air", "water"}
    diameter_m, frequency_hz : float
        Lowest frequency of the straight run that the member is part of.
    reduced_velocity, onset : float
        V_R, and from where on it matters.
    """

    member: str
    part: str
    medium: Literal["air", "water"]
    diameter_m: float
    frequency_hz: float
    reduced_velocity: float
    onset: float

    @property
    def onset_m_s(self) -> float:
        """Speed of the flow from where on it matters [m/s]."""
        return self.onset * self.frequency_hz * self.diameter_m

    @property
    def locks_in(self) -> tuple[str, ...]:
        """The motions on which vortices lock at this speed."""
        ways = zip(("in line", "across"), LOCK_IN[self.medium], strict=True)
        return tuple(way for way, (low, high) in ways if low <= self.reduced_velocity <= high)

    @property
    def lock_in_m_s(self) -> tuple[float, float]:
        """Speeds between which vortices lock on the motion across the flow [m/s]."""
        low, high = (V * self.frequency_hz * self.diameter_m for V in LOCK_IN[self.medium][1])
        return low, high

    @property
    def ratio(self) -> float:
        """V_R over its onset: below 1 nothing needs to be shown."""
        return self.reduced_velocity / self.onset

    @property
    def direction(self) -> str:
        """Motion that vortices may excite: none, in line with the flow, or across it."""
        if self.ratio < 1.0:
            return "none"
        return "in line" if self.medium == "water" and self.reduced_velocity < ONSET_ACROSS else "across"


def vortex_uses(
    structure: Structure,
    *,
    wind_m_s: float | None = None,
    current_m_s: float | None = None,
    first_frequency_hz: float,
) -> tuple[VortexUse, ...]:
    """Return every member in a flow, the nearest to its onset (or farthest beyond) first.

    A straight run between joints counts as pinned at its ends, with the section of the member in question:
    its frequency is the lowest that it can have. A member whose lower end is below the sea is wholly in
    water, and full of it. Of a run that ends free, a tower, the frequency is the structure's own.

    Parameters
    ----------
    wind_m_s, current_m_s : speed of the flow across the members; None leaves those in that medium out
    first_frequency_hz : lowest frequency of the structure on its supports

    Raises
    ------
    InputError
        If a speed is out of range.
    """
    require_between("wind", 0.0 if wind_m_s is None else wind_m_s, 0.0, 150.0)
    require_between("current", 0.0 if current_m_s is None else current_m_s, 0.0, 10.0)
    runs = columns(structure)
    found = []
    for member in structure.members:
        if member.part == PILES:
            continue
        level = min(structure.nodes[name][2] for name in (member.start, member.end))
        medium: Literal["air", "water"] = "water" if level < structure.sea_level_z_m else "air"
        speed = current_m_s if medium == "water" else wind_m_s
        if speed is None:
            continue
        run = runs[member.name]
        D = 0.5 * (member.section_start.outer_diameter_m + member.section_end.outer_diameter_m)
        f = first_frequency_hz if run.is_cantilever else _pinned_hz(member, run.length_m, medium == "water")
        onset = ONSET_IN_LINE if medium == "water" else ONSET_IN_AIR
        found.append(VortexUse(member.name, member.part, medium, D, f, speed / (f * D), onset))
    return tuple(sorted(found, key=lambda use: -use.ratio))


def _pinned_hz(member: Member, L: float, in_water: bool) -> float:
    """Return π/(2L²) √(EI/m) of a tube, with added mass and water inside where it is in water."""
    ends = (member.section_start, member.section_end)
    D, t = (0.5 * sum(getattr(s, key) for s in ends) for key in ("outer_diameter_m", "thickness_m"))
    d = D - 2.0 * t
    steel, material = pi / 4.0 * (D**2 - d**2), member.material
    m = steel * material.density_kg_m3
    if in_water:
        m += SEA_WATER_KG_M3 * pi / 4.0 * (D**2 + d**2)
    EI = material.youngs_modulus_pa * pi / 64.0 * (D**4 - d**4)
    return pi / (2.0 * L**2) * sqrt(EI / m)
