"""Series of wave loads against closed forms on a cylinder, and against loads computed one by one."""

import numpy as np
import pytest
from tests.support.wave_loads import wave_loads

from jackettwin.decks import read_structure
from jackettwin.loads.members.coefficients import SEA_WATER_KG_M3, Coefficients
from jackettwin.loads.members.morison import morison_points
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.wave_series import resultant_columns, wave_series
from jackettwin.loads.sea.waves import airy_wave, irregular_sea
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member

D, DEPTH, T = 1.5, 50.0, 10.0


@pytest.fixture(scope="module")
def cylinder():
    tube = Section(D, 0.04)
    structure = Structure(
        "cylinder",
        {"a": (3.0, -2.0, 0.0), "b": (3.0, -2.0, 60.0)},
        (Member("m", "a", "b", tube, tube, STEEL),),
        sea_level_z_m=DEPTH,
    )
    return assemble(structure, subdivide=4)


def test_resultant_of_inertia_is_the_closed_form(cylinder) -> None:
    """F = ρ C_M (π/4)D² g (H/2) tanh kd; about still water its arm is −(cosh kd − 1)/(k sinh kd)."""
    grid = morison_points(cylinder, highest_z=5.0, coefficients=Coefficients(drag=0.0), spacing=0.5)
    wave = airy_wave(height=4.0, period=T, depth=DEPTH)
    loads = wave_series(grid, wave, resultant_columns(grid.points), depth=DEPTH, period=T).loads
    k = float(wave.k[0])
    F = SEA_WATER_KG_M3 * 2.0 * 0.25 * np.pi * D**2 * 9.80665 * 2.0 * np.tanh(k * DEPTH)
    arm = (np.cosh(k * DEPTH) - 1.0) / (k * np.sinh(k * DEPTH))
    # 256 times a period: the largest sample is within 1e-4 of the crest
    assert loads[:, 0].max() == pytest.approx(F, rel=3e-4)
    assert loads[:, 4].max() == pytest.approx(F * arm, rel=3e-4)
    # the force acts 2 m to the right of the origin: moment about the vertical
    np.testing.assert_allclose(loads[:, 5], 2.0 * loads[:, 0], atol=1e-6 * F)
    np.testing.assert_allclose(loads[:, 1:3], 0.0, atol=1e-9 * F)


def test_a_sea_gives_what_single_times_give(cylinder) -> None:
    """0.2 % of the largest force: Chebyshev levels instead of each point's own."""
    sea = irregular_sea(Hs=5.0, Tp=9.0, depth=DEPTH, duration=200.0, seed=2)
    grid = morison_points(cylinder, highest_z=6.0, spacing=2.0)
    current = Current(DEPTH, subsurface_m_s=0.6, direction=0.5)
    fast = wave_series(grid, sea, np.asarray(grid.N.T.todense()), depth=DEPTH, period=200.0, current=current)
    some = np.arange(0, fast.loads.shape[0], 61)
    direct = wave_loads(grid, sea, some * fast.step_s, current=current)
    np.testing.assert_allclose(fast.loads[some], direct, atol=2e-3 * np.abs(direct).max())


def test_the_spread_is_that_of_the_water(cylinder) -> None:
    """σ² at the surface of a cylinder: Σ ½ a² ω² coth² kd along the wave, half of it each way across."""
    sea = irregular_sea(Hs=5.0, Tp=9.0, depth=DEPTH, duration=400.0, seed=2, stretching="none")
    grid = morison_points(cylinder, highest_z=0.0, spacing=1.0)
    series = wave_series(grid, sea, resultant_columns(grid.points), depth=DEPTH, period=400.0)
    top = int(np.argmin(np.abs(grid.points[:, 2])))
    z = min(grid.points[top, 2], 0.0)
    amplitude = sea.amplitude * sea.omega * np.cosh(sea.k * (z + DEPTH)) / np.sinh(sea.k * DEPTH)
    # every fourth sample: 1 s apart, 2 % of the variance
    assert series.sigma[top] == pytest.approx(np.sqrt(0.25 * (amplitude**2).sum()), rel=0.02)


def test_long_pieces_are_enough_for_the_jacket() -> None:
    """Force and moment of 8 m pieces against 1 m: 0.2 % of their spread (documented)."""
    assembly = assemble(read_structure("jacket15"))
    sea = irregular_sea(Hs=6.0, Tp=11.0, depth=72.0, duration=200.0, seed=1)
    spread = []
    for spacing in (1.0, 8.0):
        grid = morison_points(assembly, highest_z=7.0, spacing=spacing)
        spread.append(
            wave_series(grid, sea, resultant_columns(grid.points), depth=72.0, period=200.0).loads.std(0)
        )
    np.testing.assert_allclose(spread[1][[0, 4]], spread[0][[0, 4]], rtol=2e-3)


def test_nothing_below_the_bed_is_loaded(cylinder) -> None:
    grid = morison_points(cylinder, highest_z=0.0, spacing=1.0)
    wave = airy_wave(height=2.0, period=T, depth=30.0)
    columns = np.zeros((3 * grid.weight.size, 1))
    columns[0::3, 0] = grid.points[:, 2] < -30.0
    assert columns.any()
    loads = wave_series(grid, wave, columns, depth=30.0, period=T).loads
    np.testing.assert_array_equal(loads, 0.0)
