"""A blade against the clamped beam's closed form, and against ElastoDyn's own frequencies."""

import numpy as np
import pytest

from jackettwin.decks.blade_files import read_flexible_rotor
from jackettwin.errors import InputError
from jackettwin.structure.blades import BladeStructure, blade_modes

N, L, MASS, FLAP, EDGE = 40, 60.0, 300.0, 2e9, 5e9
BETA_L = (1.8751041, 4.6940911)
"""Roots of cos x cosh x = −1."""


def uniform(**changes: object) -> BladeStructure:
    """A blade of one section."""
    z = np.linspace(0.0, L, N + 1)
    values = {"mass_kg_m": MASS, "flap_n_m2": FLAP, "edge_n_m2": EDGE, "twist": 0.0} | changes
    return BladeStructure(
        z=z, damping_ratio=0.005, **{key: np.full(N + 1, float(v)) for key, v in values.items()}
    )


def test_a_uniform_blade_is_a_clamped_beam() -> None:
    """ω = (βL)² √(EI/mL⁴), flap and edge; rotary inertia of (EI/EA)^½ = 0.2 m takes 3e-5."""
    found = blade_modes(uniform(), 4, pitch=0.0)
    wanted = sorted((b / L) ** 2 * np.sqrt(stiffness / MASS) for b in BETA_L for stiffness in (FLAP, EDGE))
    np.testing.assert_allclose(found.omega, wanted, rtol=2e-3)
    assert found.omega[0] == pytest.approx(wanted[0], rel=1e-4)
    # masses lumped at forty middles: the second modes lose 0.35 %
    modal = np.einsum("e,eck,eck->k", found.mass_kg, found.shape, found.shape)
    np.testing.assert_allclose(modal, 1.0, rtol=5e-3)


@pytest.mark.parametrize(("pitch", "direction"), [(0.0, 0), (np.pi / 2, 1)])
def test_a_feathered_blade_flaps_in_the_rotor_s_plane(pitch: float, direction: int) -> None:
    shape = blade_modes(uniform(), 1, pitch=pitch).shape[-1, :, 0]
    assert abs(shape[direction]) > 1e3 * np.abs(np.delete(shape, direction)).max()


def test_twist_and_pitch_turn_alike() -> None:
    turned = [blade_modes(uniform(twist=0.3), 4, pitch=0.2), blade_modes(uniform(), 4, pitch=0.5)]
    np.testing.assert_allclose(np.abs(turned[0].shape), np.abs(turned[1].shape), atol=1e-9)


def test_the_shipped_blade_has_the_frequencies_of_its_elastodyn_file() -> None:
    """IEA 15 MW, ElastoDyn's shapes with its own EI and m: flap 0.543 and 1.608 Hz, edge 0.741 Hz.

    windIO's stiffness is of the same blade at 26 stations, and shapes that are not modes are too stiff.
    """
    rotor = read_flexible_rotor("iea15")
    hz = blade_modes(rotor.blade, 4, pitch=0.0).omega[:3] / (2.0 * np.pi)
    np.testing.assert_allclose(hz, [0.543, 0.741, 1.608], rtol=0.05)
    # its mass in the turbine's documentation: 65 t (65,250 kg)
    assert np.trapezoid(rotor.blade.mass_kg_m, rotor.blade.z) == pytest.approx(65.25e3, rel=0.03)


def test_wrong_blades_are_refused() -> None:
    with pytest.raises(InputError, match="flap_n_m2: must be positive"):
        uniform(flap_n_m2=0.0)
