"""Forces as Gaussian processes: their densities, their state space, their patterns."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.loads import wave_number
from jackettwin.sensing.latent_forces import LatentForce, wave_forces, wind_forces
from jackettwin.structure import assemble, rigid_body_motion


@pytest.mark.parametrize("kind", ["gust", "wave"])
def test_the_state_space_has_the_density_that_is_said(kind: str) -> None:
    force = LatentForce("f", np.zeros(1), np.zeros((1, 12)), kind, 0.8, 3.0)
    A, Q, h = force.dynamics()
    assert h @ la.solve_continuous_lyapunov(A, -Q) @ h == pytest.approx(9.0, rel=1e-10)
    omega = np.array([0.05, 0.3, 0.8, 2.0, 9.0])
    made = [abs(h @ np.linalg.solve(1j * w * np.eye(len(A)) - A, np.sqrt(np.diag(Q)))) ** 2 for w in omega]
    assert_allclose(force.density(omega), made, rtol=1e-10)
    w = np.linspace(0.0, 4000.0, 4_000_001)
    # of a gust, 2a/πω lies beyond
    beyond = 9.0 * 2.0 * 0.8 / np.pi / 4000.0 if kind == "gust" else 0.0
    assert np.trapezoid(force.density(w), w) / np.pi + beyond == pytest.approx(9.0, rel=1e-5)


def test_waves_push_as_their_inertia_does() -> None:
    """Half a wave apart legs are pushed apart; together, by ρ(C_p + C_a)A ∫ cosh/sinh dz of each."""
    assembly = assemble(read_structure("jacket15"))
    rigid = rigid_body_motion(assembly)
    period = 20.0
    at_crests, between = (
        f.load @ rigid for f in reversed(wave_forces(assembly, period_s=period, depth_m=72.0)[:2])
    )
    # at a long wave all legs are pushed at once, and what is a quarter of a wave behind is small
    assert abs(between[0]) > 3.0 * abs(at_crests[0])
    assert abs(between[1]) < 1e-6 * abs(between[0])
    assert float(wave_number(2.0 * np.pi / period, 72.0)) < 0.02
    turned = wave_forces(assembly, period_s=period, depth_m=72.0, direction_rad=np.pi)[0].load @ rigid
    assert turned[0] == pytest.approx(-between[0], rel=1e-9)


def test_wind_acts_on_top_and_tower() -> None:
    assembly = assemble(read_structure("jacket15"))
    forces = {f.name: f for f in wind_forces(assembly, wind_m_s=12.0)}
    rigid = rigid_body_motion(assembly)
    assert_allclose(forces["rotor Fx, slow"].load @ rigid[:, :3], [1.0, 0.0, 0.0], atol=1e-9)
    assert_allclose(forces["rotor My, slow"].load @ rigid, [0, 0, 0, 0, 1.0, 0], atol=1e-9)
    drag = forces["tower y, slow"].load @ rigid[:, :3]
    assert drag[1] > 0.0
    assert abs(drag[0]) < 1e-9 * drag[1]
    assert forces["rotor Fx, quick"].rate == pytest.approx(25.0 * forces["rotor Fx, slow"].rate)
    assert wind_forces(assembly, wind_m_s=24.0)[0].rate == pytest.approx(2.0 * forces["rotor Fx, slow"].rate)


def test_levels_and_rates_are_replaced_together() -> None:
    force = LatentForce("f", np.zeros(1), np.zeros((1, 12)), "gust", 0.8, 3.0)
    assert force.with_level(2.0, 0.1) == replace(force, level=2.0, rate=0.1)
