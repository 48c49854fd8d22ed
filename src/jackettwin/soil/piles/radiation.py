"""Radiation damping of a pile: waves into the ground, as a dashpot per metre.

A named option, for frequencies above the ground's own: below the first shear frequency V_s/4H of a layer of
depth H on rock nothing is radiated, and 0.2–1 Hz lies below it for most sites. Soil loss under a jacket's
first modes is hysteretic (``dashpots``, springpots).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.errors import require, require_between
from jackettwin.soil.piles.piles import Pile, PileSprings

SHALLOW_DIAMETERS = 2.5
"""Down to here a pile sends surface waves rather than waves of compression."""


@dataclass(frozen=True)
class Radiation:
    """Ground into which a pile sends waves of one frequency."""

    density_kg_m3: float
    shear_wave_m_s: float
    frequency_hz: float
    poisson_ratio: float = 0.5

    def __post_init__(self) -> None:
        require_between("density_kg_m3", self.density_kg_m3, 500.0, 5000.0)
        require_between("shear_wave_m_s", self.shear_wave_m_s, 1.0, 1e4)
        require_between("frequency_hz", self.frequency_hz, 1e-3, 1e3)
        require_between("poisson_ratio", self.poisson_ratio, 0.0, 0.5)

    def on(self, pile: Pile, springs: PileSprings) -> PileSprings:
        """Return the dashpots at the nodes of a pile [N·s/m]; none where the springs have nothing to hold.

        Each node stands for half of the elements beside it.
        """
        z, D = springs.node_depth, pile.outer_diameter_m
        half = 0.5 * np.diff(z)
        length = np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half])
        waves = (self.density_kg_m3, self.shear_wave_m_s, D, 2.0 * np.pi * self.frequency_hz)
        deep, shallow = (
            lateral_radiation(*waves, self.poisson_ratio, shallow=near) for near in (False, True)
        )
        lateral = np.where(z < SHALLOW_DIAMETERS * D, shallow, deep) * length * (springs.lateral > 0.0)
        axial = axial_radiation(*waves) * length * (springs.axial > 0.0)
        return PileSprings(z, lateral, axial, np.zeros_like(z))


def lateral_radiation(
    density_kg_m3: float,
    shear_wave_m_s: float,
    D: float,
    omega: float,
    poisson_ratio: float = 0.5,
    *,
    shallow: bool = False,
) -> float:
    """Return the lateral dashpot per metre [N·s/m²], Gazetas & Dobry (1984, J. Geotech. Eng. 110:20).

    c = 2 D ρ V_s [1 + r^{5/4}] (π/4)^{3/4} a0^{−1/4} with a0 = ωD/V_s and r = 3.4/(π(1 − ν)), the wave speed
    of compression over that of shear; near the surface (within 2.5 D, ``shallow``) r = 1.

    >>> c = lateral_radiation(density_kg_m3=1900, shear_wave_m_s=200, D=2, omega=6, shallow=True)
    >>> round(c / (4 * 2 * 1900 * 200 * (3.141592653589793 / 4) ** 0.75 * (0.06) ** -0.25), 9)
    1.0

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    _check(density_kg_m3, shear_wave_m_s, D, omega)
    require_between("poisson_ratio", poisson_ratio, 0.0, 0.5)
    r = 1.0 if shallow else 3.4 / (np.pi * (1.0 - poisson_ratio))
    a0 = omega * D / shear_wave_m_s
    c = 2.0 * D * density_kg_m3 * shear_wave_m_s * (1.0 + r**1.25)
    return float(c * (0.25 * np.pi) ** 0.75 * a0**-0.25)


def axial_radiation(density_kg_m3: float, shear_wave_m_s: float, D: float, omega: float) -> float:
    """Return the axial dashpot per metre [N·s/m²], Gazetas & Makris (1991): c = πDρV_s a0^{−1/4}."""
    _check(density_kg_m3, shear_wave_m_s, D, omega)
    return float(np.pi * D * density_kg_m3 * shear_wave_m_s * (omega * D / shear_wave_m_s) ** -0.25)


def _check(density: float, speed: float, D: float, omega: float) -> None:
    values = {"density_kg_m3": density, "shear_wave_m_s": speed, "D": D, "omega": omega}
    for field, value in values.items():
        require(
            np.isfinite(value) and value > 0.0, "must be positive", field=field, value=value, allowed="> 0"
        )
