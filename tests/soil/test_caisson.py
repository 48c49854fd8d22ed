"""Stiffness of suction caissons: surface limits in closed form, energy, and the file's door."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.soil import read_support
from jackettwin.soil.caisson import Caisson


def test_without_a_skirt_it_is_a_rigid_disc_on_a_half_space() -> None:
    """4GR/(1−ν), 8GR³/3(1−ν), 16GR³/3: Boussinesq, Borowicka, Reissner & Sagoci; 8GR/(2−ν) is close."""
    G, R, nu = 40e6, 4.0, 0.3
    K = Caisson(2 * R, 0.0, G, nu).stiffness()
    by_hand = [8 * G * R / 1.7] * 2 + [4 * G * R / 0.7] + [8 * G * R**3 / 2.1] * 2 + [16 * G * R**3 / 3]
    np.testing.assert_allclose(K, np.diag(by_hand), rtol=1e-12)


def test_a_skirt_of_a_radius_by_hand() -> None:
    """Sway ×5/3, heave ×3/2, rocking at the base ×3, twist ×11/3; at the lid K_R + 0.2 d² K_H, −0.6 d K_H."""
    G, R = 50e6, 5.0
    K = Caisson(10.0, 5.0, G, 0.3).stiffness()
    K_H = 8 * G * R / 1.7 * 5 / 3
    assert K[0, 0] == pytest.approx(K_H)
    assert K[2, 2] == pytest.approx(4 * G * R / 0.7 * 1.5)
    assert K[4, 4] == pytest.approx(8 * G * R**3 / 2.1 * 3 + 0.2 * R**2 * K_H)
    assert K[0, 4] == pytest.approx(-0.6 * R * K_H) == -K[1, 3]
    assert K[5, 5] == pytest.approx(16 * G * R**3 / 3 * 11 / 3)
    # pushed at the lid it turns the way it is pushed, as a pile does
    flexibility = np.linalg.inv(K)
    assert flexibility[4, 0] > 0.0 > flexibility[3, 1]


def test_it_stores_energy_and_rock_stiffens_it() -> None:
    for skirt in (0.0, 2.0, 8.0):
        free, near = (Caisson(8.0, skirt, 30e6, 0.5, rock).stiffness() for rock in (None, 20.0))
        assert np.linalg.eigvalsh(free).min() > 0.0
        assert (np.diag(near)[:5] > np.diag(free)[:5]).all()
        # the unit of force does not matter
        np.testing.assert_allclose(Caisson(8.0, skirt, 60e6, 0.5).stiffness(), 2.0 * free)


def test_a_support_file_has_caissons(tmp_path: Path) -> None:
    path = tmp_path / "caissons.yaml"
    path.write_text(
        "supports:\n  - nodes: reaction\n    caisson: {diameter_m: 9, skirt_m: 8, shear_modulus_pa: 4e7}\n"
        "    law: {type: kelvin-voigt, tau_s: 0.02}\n"
    )
    found = read_support(path, read_structure("jacket15"))
    assert len(found.springs) == 4
    np.testing.assert_allclose(found.springs[0].matrix, Caisson(9.0, 8.0, 4e7).stiffness())


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("caisson: {diameter_m: 9, skirt_m: 8, shear_modulus_pa: 4e7}, stiffness: [1, 1, 1]", "exactly one"),
        ("law: {type: elastic}", "exactly one"),
        ("caisson: {diameter_m: 9, skirt_m: 12, shear_modulus_pa: 4e7}", "skirt_m"),
        ("caisson: {diameter_m: 9, skirt_m: 8, shear_modulus_pa: 40}", "shear_modulus_pa"),
        ("caisson: {diameter_m: 9, skirt_m: 8, shear_modulus_pa: 4e7, bedrock_m: 9}", "rock is too near"),
    ],
)
def test_wrong_caissons_are_refused(tmp_path: Path, entry: str, message: str) -> None:
    path = tmp_path / "caissons.yaml"
    path.write_text(f"supports:\n  - {{nodes: reaction, {entry}}}\n")
    with pytest.raises(InputError, match=message):
        read_support(path, read_structure("jacket15"))
