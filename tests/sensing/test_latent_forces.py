"""Forces as Gaussian processes: their densities, their state space, their patterns."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.sensing.latent_forces import LatentForce, wind_forces
from jackettwin.structure import assemble, rigid_body_motion


@pytest.mark.parametrize("kind", ["gust", "disc", "wave"])
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
    # a history has the density in every band: 16,000 coefficients in the narrowest are within 2.4 %
    drawn = force.drawn(400_000, 0.2, np.random.default_rng(1))
    f, power = (
        2.0 * np.pi * np.fft.rfftfreq(drawn.size, 0.2),
        np.abs(np.fft.rfft(drawn)) ** 2 * 0.2 / drawn.size,
    )
    for low, high in ((0.05, 0.3), (0.5, 1.5), (1.5, 5.0)):
        band = (f > low) & (f < high)
        assert power[band].sum() == pytest.approx(force.density(f[band]).sum(), rel=0.05)


def test_wind_acts_on_top_and_tower() -> None:
    assembly = assemble(read_structure("jacket15"))
    forces = {f.name: f for f in wind_forces(assembly, wind_m_s=12.0)}
    rigid = rigid_body_motion(assembly)
    assert_allclose(forces["rotor Fx"].load @ rigid[:, :3], [1.0, 0.0, 0.0], atol=1e-9)
    assert_allclose(forces["rotor My"].load @ rigid, [0, 0, 0, 0, 1.0, 0], atol=1e-9)
    drag = forces["tower y"].load @ rigid[:, :3]
    assert drag[1] > 0.0
    assert abs(drag[0]) < 1e-9 * drag[1]
    assert forces["rotor My, quick"].rate == pytest.approx(25.0 * forces["rotor My"].rate)
    assert wind_forces(assembly, wind_m_s=24.0)[0].rate == pytest.approx(2.0 * forces["rotor Fx"].rate)


@pytest.mark.parametrize("wind", [8.0, 12.0, 20.0])
def test_a_disc_averages_forces_and_not_moments(wind: float, rng: np.random.Generator) -> None:
    """Kaimal's spectrum times the mean coherence of pairs of points of a disc of 240 m (IEC 61400-1, C.2).

    Within a third in power from a tenth of the corner to 0.05 Hz, and 0.57 of a point's standard deviation.
    """
    radius, angle = 120.0 * np.sqrt(rng.uniform(size=300)), rng.uniform(0.0, 2.0 * np.pi, 300)
    at = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    apart = np.linalg.norm(at[:, None] - at[None], axis=2)
    L = 340.2
    f = np.geomspace(0.1 * wind / (6.0 * L), 0.05, 40)
    kaimal = 4.0 * L / wind / (1.0 + 6.0 * f * L / wind) ** (5.0 / 3.0)
    joined = [np.exp(-12.0 * np.hypot(x * apart / wind, 0.12 * apart / L)).mean() for x in f]
    forces = {f.name: f for f in wind_forces(assemble(read_structure("jacket15")), wind_m_s=wind)}
    disc = forces["rotor Fy"].with_level(0.57).density(2.0 * np.pi * f) * 2.0
    off = np.abs(np.log(disc / (kaimal * joined)))
    assert np.median(off) < 0.3 and off.max() < 0.7
    moment = forces["rotor Mx"].with_level(1.0)
    slow, fast = moment.density(np.array([1e-6, 5.0 * moment.rate]))
    assert fast / slow == pytest.approx(1.0 / 26.0, rel=1e-3)


def test_drag_on_the_tower_is_that_of_the_stated_wind() -> None:
    """½ρ C_D ∫D dz by 2Uσ of class B: 1.225/2 · 0.5 · 2 · 12 · 0.14 (0.75 · 12 + 5.6) N/m of diameter."""
    assembly = assemble(read_structure("jacket15"))
    force = {f.name: f for f in wind_forces(assembly, wind_m_s=12.0)}["tower x"]
    tower = [m for m in assembly.structure.members if m.part == "tower"]
    nodes = assembly.structure.nodes
    area = sum(
        0.5
        * (m.section_start.outer_diameter_m + m.section_end.outer_diameter_m)
        * abs(nodes[m.end][2] - nodes[m.start][2])
        for m in tower
    )
    sigma = 0.14 * (0.75 * 12.0 + 5.6)
    pushed = force.level * (force.load @ rigid_body_motion(assembly)[:, 0])
    assert pushed == pytest.approx(0.5 * 1.225 * 0.5 * area * 2.0 * 12.0 * sigma, rel=1e-3)
    assert force.level_log_std < 1.0 < wind_forces(assembly)[-1].level_log_std


def test_levels_and_rates_are_replaced_together() -> None:
    force = LatentForce("f", np.zeros(1), np.zeros((1, 12)), "gust", 0.8, 3.0)
    assert force.with_level(2.0, 0.1) == replace(force, level=2.0, rate=0.1)
