"""Scattered waves on wide cylinders: MacCamy & Fuchs (1954)."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import jvp, yvp

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.morison import morison_points
from jackettwin.loads.sea.diffraction import scattered
from jackettwin.loads.sea.wave_series import resultant_columns, wave_series
from jackettwin.loads.sea.waves import airy_wave, irregular_sea
from jackettwin.simulate import read_scenario
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, Reaction

RHO, G, DEPTH = 1025.0, 9.80665, 40.0


def column(diameter: float):
    tube = Section(diameter, 0.05)
    structure = Structure(
        name="column",
        nodes={"foot": (0.0, 0.0, -DEPTH), "top": (0.0, 0.0, 10.0)},
        members=(Member("column", "foot", "top", tube, tube, STEEL),),
        reactions=(Reaction("foot"),),
        sea_level_z_m=0.0,
    )
    inertia = Coefficients(drag=0.0, added_mass=1.0, pressure=1.0, density_kg_m3=RHO)
    return morison_points(assemble(structure), highest_z=0.0, lowest_z=-DEPTH, coefficients=inertia)


def forces(diameter: float, waves, period: float, *, diffraction: bool) -> np.ndarray:
    grid = column(diameter)
    columns = resultant_columns(grid.points)
    return wave_series(grid, waves, columns, depth=DEPTH, period=period, diffraction=diffraction).loads[:, 0]


@pytest.mark.parametrize("period", [4.0, 7.0, 12.0])
def test_a_column_in_an_airy_wave_in_closed_form(period: float) -> None:
    """Per length (4ρg a/k) cosh k(z+d)/cosh kd · A(ka) cos(ωt − α), A = 1/√(J₁′² + Y₁′²), tan α = J₁′/Y₁′."""
    D, H = 12.0, 0.5
    waves = airy_wave(height=H, period=period, depth=DEPTH, stretching="none")
    k = float(waves.k[0])
    ka = 0.5 * k * D
    J, Y = float(jvp(1, ka)), float(yvp(1, ka))
    amplitude = 4.0 * RHO * G * 0.5 * H / k**2 * np.tanh(k * DEPTH) / np.hypot(J, Y)
    found = forces(D, waves, period, diffraction=True)
    first = np.fft.rfft(found)[1] * 2.0 / found.size
    # two Gauss points a metre over cosh
    assert abs(first) == pytest.approx(amplitude, rel=1e-3)
    plain = np.fft.rfft(forces(D, waves, period, diffraction=False))[1] * 2.0 / found.size
    lag = np.angle(plain / first)
    assert lag == pytest.approx(np.arctan2(J, Y), abs=1e-6)
    assert abs(first / plain) == pytest.approx(2.0 / (np.pi * ka**2 * np.hypot(J, Y)), rel=1e-9)


def test_slender_members_do_not_scatter() -> None:
    assert scattered(np.array([0.05]), np.array([1e-4, 0.5]))[:, 0] == pytest.approx(1.0, abs=1e-3)
    sea = irregular_sea(Hs=2.0, Tp=9.0, depth=DEPTH, duration=100.0, seed=1)
    with_it, without = (forces(0.8, sea, 100.0, diffraction=on) for on in (True, False))
    # ka is 0.2 at the shortest waves that carry anything: some percent there, little in all
    assert np.std(with_it - without) < 0.06 * np.std(without)
    wide, morison = (forces(15.0, sea, 100.0, diffraction=on) for on in (True, False))
    assert np.std(wide) < 0.9 * np.std(morison)


def test_steep_waves_have_no_scattering(tmp_path: Path) -> None:
    path = tmp_path / "steep.yaml"
    text = "structure: jacket15\nsupport: pinned\nwaves: {type: %s, diffraction: maccamy-fuchs, %s}\n"
    path.write_text(text % ("stokes5", "height_m: 5, period_s: 9"))
    with pytest.raises(InputError, match="waves.diffraction: not known for waves of type stokes5"):
        read_scenario(path)
    path.write_text(text % ("airy", "height_m: 5, period_s: 9"))
    sea = read_scenario(path).sea
    assert sea is not None
    assert sea.diffraction
