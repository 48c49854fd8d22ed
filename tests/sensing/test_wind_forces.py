"""What wind does to a rotor and its tower, against IEC 61400-1 (2019), C.2 on blades as lines."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.sensing import LatentForce
from jackettwin.sensing.wind_forces import RotorPlace, wind_forces
from jackettwin.structure import Assembly, assemble, rigid_body_motion

L = 340.2
RADIUS = 120.0
AT_TOP = RotorPlace()


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return assemble(read_structure("jacket15"))


def kaimal(f: np.ndarray, wind: float, scale: float = L) -> np.ndarray:
    """Return the one-sided density of gusts of a standard deviation of 1."""
    return np.asarray(4.0 * scale / wind / (1.0 + 6.0 * f * scale / wind) ** (5.0 / 3.0))


def coherence(f: np.ndarray, wind: float, apart: np.ndarray) -> np.ndarray:
    """Return the coherence of each frequency (n, …)."""
    f = f.reshape(-1, *[1] * apart.ndim)
    return np.asarray(np.exp(-12.0 * np.hypot(f * apart / wind, 0.12 * apart / L)))


def off(force: LatentForce, f: np.ndarray, S: np.ndarray) -> float:
    """Return the root mean square of ln of a force's density over another (n,), levels apart."""
    ratio = np.log(force.density(2.0 * np.pi * f) / S)
    return float(np.std(ratio))


def test_wind_acts_at_the_hub_and_on_the_tower(assembly: Assembly) -> None:
    """A force at the hub turns the tower top by its lever, along axes that turn with the rotor."""
    place = RotorPlace((-12.0, 0.0, 5.6), 0.5 * np.pi, RADIUS)
    forces = {f.name: f for f in wind_forces(assembly, place, wind_m_s=12.0)}
    rigid = rigid_body_motion(assembly)
    top = np.array(assembly.structure.nodes[assembly.structure.top_node])
    hub = top + [0.0, -12.0, 5.6]
    for name, way in (("rotor Fx", [0.0, 1.0, 0.0]), ("rotor Fy", [-1.0, 0.0, 0.0])):
        assert_allclose(forces[name].load @ rigid, [*way, *np.cross(hub, way)], atol=1e-9)
    assert_allclose(forces["rotor My"].load @ rigid, [0, 0, 0, -1.0, 0, 0], atol=1e-9)
    drag = forces["tower y"].load @ rigid[:, :3]
    assert drag[1] > 0.0
    assert abs(drag[0]) < 1e-9 * drag[1]
    assert forces["tower y, quick"].rate == pytest.approx(40.0 * forces["tower y"].rate)
    faster = wind_forces(assembly, place, wind_m_s=24.0)[0]
    assert faster.rate == pytest.approx(2.0 * forces["rotor Fx"].rate)


@pytest.mark.parametrize("wind", [8.0, 12.0, 20.0])
def test_a_disc_averages_forces_and_not_moments(
    assembly: Assembly, wind: float, rng: np.random.Generator
) -> None:
    """Kaimal's spectrum times the mean coherence of pairs of points of a disc of 240 m.

    Within a third in power from a tenth of the corner to 0.05 Hz, and 0.57 of a point's standard deviation.
    """
    radius, angle = RADIUS * np.sqrt(rng.uniform(size=300)), rng.uniform(0.0, 2.0 * np.pi, 300)
    at = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    apart = np.linalg.norm(at[:, None] - at[None], axis=2)
    f = np.geomspace(0.1 * wind / (6.0 * L), 0.05, 40)
    joined = np.array([coherence(np.array([x]), wind, apart).mean() for x in f])
    forces = {g.name: g for g in wind_forces(assembly, AT_TOP, wind_m_s=wind, working=True)}
    disc = forces["rotor Fx"].with_level(0.57).density(2.0 * np.pi * f) * 2.0
    error = np.abs(np.log(disc / (kaimal(f, wind) * joined)))
    assert np.median(error) < 0.3 and error.max() < 0.7
    moment = forces["rotor Mx"].with_level(1.0)
    slow, fast = moment.density(np.array([1e-6, 5.0 * moment.rate]))
    assert fast / slow == pytest.approx(1.0 / 26.0, rel=1e-3)


@pytest.mark.parametrize("wind", [8.0, 14.0, 22.0])
def test_a_standing_rotor_bears_the_short_gusts_across(assembly: Assembly, wind: float) -> None:
    """Lift of v and w along three feathered blades, whose scales are 2.7 and 0.66 Λ₁ (table C.1).

    The standard has no coherence of theirs: that of u, and none between cells of 19 m, are both within two
    deviations of what is expected.
    """
    psi, r = np.repeat(2.0 * np.pi * np.arange(3) / 3, 12), np.tile((np.arange(12) + 0.5) / 12 * RADIUS, 3)
    at, across = (
        r[:, None] * np.column_stack([np.sin(psi), np.cos(psi)]),
        np.column_stack([np.cos(psi), -np.sin(psi)]),
    )
    f = np.geomspace(1.0 / 600.0, 0.5, 25)
    cell = np.round(at / 19.1)
    alike = (cell[:, None] == cell[None]).all(axis=2) * np.ones((f.size, 1, 1))
    forces = {g.name: g for g in wind_forces(assembly, AT_TOP, wind_m_s=wind)}
    for joined in (coherence(f, wind, np.linalg.norm(at[:, None] - at[None], axis=2)), alike):
        for name, lever in (("rotor Fy", across[:, 0]), ("rotor Mx", r)):
            S = sum(
                ratio**2 * kaimal(f, wind, scale * 42.0) * np.einsum("i,fij,j->f", g, joined, g)
                for ratio, scale, g in zip((0.8, 0.5), (2.7, 0.66), (lever[:, None] * across).T, strict=True)
            )
            one = forces[name]
            away = one.rate_log_std * np.linspace(-2.0, 2.0, 41)
            errors = [off(one.with_level(1.0, one.rate * np.exp(a)), f, S) for a in away]
            assert min(errors) < 0.45 and 0 < np.argmin(errors) < away.size - 1
            assert off(forces["tower x"], f, S) > min(errors) + 0.05
    quick = {name.partition(",")[0] for name in forces if "rotor" in name and "quick" in name}
    assert quick == {"rotor Fx", "rotor Fy", "rotor Mx", "rotor My"}  # no sensor on the axis sees Mz


def test_drag_on_the_tower_is_that_of_the_stated_wind(assembly: Assembly) -> None:
    """½ρ C_D ∫D dz by 2Uσ of class B: 1.225/2 · 0.5 · 2 · 12 · 0.14 (0.75 · 12 + 5.6) N/m of diameter."""
    force = {f.name: f for f in wind_forces(assembly, AT_TOP, wind_m_s=12.0)}["tower x"]
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
    assert force.level_log_std < 1.0 < wind_forces(assembly, AT_TOP)[-1].level_log_std
