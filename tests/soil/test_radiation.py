"""Radiation dashpots against their closed forms."""

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.piles.impedance import head_impedance, lumped_head
from jackettwin.soil.piles.piles import Pile, linear_springs
from jackettwin.soil.piles.radiation import Radiation, axial_radiation, lateral_radiation
from jackettwin.structure import assemble

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


def test_dashpots_along_a_pile_add_up_to_its_length() -> None:
    """20 m of pile, D 2 m: 5 m near the surface and 15 m below; the node on the edge goes below."""
    pile = Pile(20.0, 2.0, 0.05, element_m=0.5)
    springs = linear_springs(pile, lateral=lambda z: 1e7 + 0.0 * z, axial=lambda z: 1e8 + 0.0 * z)
    found = Radiation(1900.0, 200.0, 3.0 / np.pi, poisson_ratio=0.4).on(pile, springs)
    deep, shallow = (lateral_radiation(**SOIL, poisson_ratio=0.4, shallow=s) for s in (False, True))
    assert found.lateral.sum() == pytest.approx(4.75 * shallow + 15.25 * deep)
    assert found.axial.sum() == pytest.approx(20.0 * axial_radiation(**SOIL))


def test_scoured_ground_radiates_nothing() -> None:
    pile = Pile(20.0, 2.0, 0.05, element_m=0.5)
    springs = linear_springs(pile, lateral=lambda z: 1e7 * (z > 4.0), axial=lambda z: 1e8 * (z > 4.0))
    found = Radiation(1900.0, 200.0, 3.0 / np.pi).on(pile, springs)
    assert (found.lateral[found.node_depth < 3.9] == 0.0).all()
    assert (found.lateral[found.node_depth > 4.6] > 0.0).all()


def test_the_lumped_head_loses_what_the_exact_one_does() -> None:
    """Im K*/ω towards ω = 0 is TᵀCT by Rayleigh's principle."""
    pile = Pile(40.0, 2.0, 0.05)
    springs = linear_springs(pile, lateral=lambda z: 1e7 * z, axial=lambda z: 1e8 + 0.0 * z)
    lost = Radiation(1900.0, 200.0, 3.0 / np.pi).on(pile, springs)
    K = head_impedance(pile, springs, 0.01j, dashpots=lost)[0]
    lumped = lumped_head(pile, springs, dashpots=lost).dashpots
    np.testing.assert_allclose(K.imag / 0.01, lumped, rtol=1e-5, atol=1e-6 * np.abs(lumped).max())


def test_a_foundation_file_asks_for_it(tmp_path) -> None:
    """The first modes lose more, piled and lumped alike to 2 %."""
    text = Path(str(resources.files("jackettwin") / "data/foundations/jacket15_records.yaml")).read_text()
    (tmp_path / "quiet.yaml").write_text(text)
    loud = text + "radiation: {density_kg_m3: 1900, shear_wave_m_s: 200, frequency_hz: 0.183}\n"
    (tmp_path / "loud.yaml").write_text(loud)
    structure = read_structure("jacket15")
    ratio = []
    for name in ("quiet", "loud"):
        for on in ("piled", "heads"):
            foundation = read_foundation(tmp_path / f"{name}.yaml")
            whole, support = (
                foundation.piled(structure) if on == "piled" else (structure, foundation.heads(structure))
            )
            modes = damped_modes(build_system(assemble(whole), support), below_hz=0.3)
            ratio.append(-modes.eigenvalues[0].real / abs(modes.eigenvalues[0]))
    quiet, quiet_heads, loud, loud_heads = ratio
    assert loud > 1.5 * quiet
    assert loud_heads == pytest.approx(loud, rel=0.02)
    assert quiet_heads == pytest.approx(quiet, rel=0.02)
