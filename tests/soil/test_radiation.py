"""Radiation dashpots against their closed forms."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.radiation import axial_radiation, lateral_radiation

SOIL = {"density_kg_m3": 1900.0, "shear_wave_m_s": 200.0, "D": 2.0, "omega": 6.0}


def test_lateral_dashpots() -> None:
    """Deep, ν = 0.4: 1 + (3.4/0.6π)^{5/4} against 2 near the surface."""
    deep, shallow = (lateral_radiation(**SOIL, poisson_ratio=0.4, shallow=s) for s in (False, True))
    assert deep / shallow == pytest.approx(0.5 * (1.0 + (3.4 / (0.6 * np.pi)) ** 1.25))
    plain = 4 * 2.0 * 1900.0 * 200.0 * (np.pi / 4) ** 0.75 * 0.06**-0.25
    assert shallow == pytest.approx(plain)


def test_axial_dashpot_and_frequency() -> None:
    """It falls with ω^{−1/4}; at a0 = 1 it is πDρV_s."""
    at_one = axial_radiation(**{**SOIL, "omega": 100.0})
    assert at_one == pytest.approx(np.pi * 2.0 * 1900.0 * 200.0)
    assert axial_radiation(**{**SOIL, "omega": 1600.0}) == pytest.approx(0.5 * at_one)


def test_bad_soils_are_refused() -> None:
    with pytest.raises(InputError, match="shear_wave_m_s"):
        axial_radiation(**{**SOIL, "shear_wave_m_s": 0.0})
    with pytest.raises(InputError, match="0 to 0.5"):
        lateral_radiation(**SOIL, poisson_ratio=0.7)
