"""What wind does to a rotor and its tower, against IEC 61400-1 (2019), C.2 on blades as lines."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.sensing import LatentForce
from jackettwin.sensing.wind_forces import RotorPlace, passing_forces, wind_forces
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
    assert forces["tower y, quick"].rate == pytest.approx(25.0 * forces["tower y"].rate)
    faster = wind_forces(assembly, place, wind_m_s=24.0)[0]
    assert faster.rate == pytest.approx(2.0 * forces["rotor Fx"].rate)


@pytest.mark.parametrize("wind", [8.0, 12.0, 20.0])
def test_a_working_rotor_averages_gusts_around_circles(assembly: Assembly, wind: float) -> None:
    """Harmonics of gusts by azimuth, as three blades that are pushed alike along their length feel them.

    The m-th one turns with the blades: multiples of three push, and what is one beside them bends the shaft.
    """
    r = (np.arange(16) + 0.5) / 16 * RADIUS
    f, turned = np.geomspace(1.0 / 700.0, 0.2, 25), 2.0 * np.pi * np.arange(48) / 48
    apart = np.sqrt(
        r[:, None, None] ** 2 + r[:, None] ** 2 - 2.0 * r[:, None, None] * r[:, None] * np.cos(turned)
    )
    joined = np.fft.rfft(coherence(f, wind, apart), axis=3).real / turned.size
    thrust, moment = (np.einsum("i,fijm,j->fm", g, joined, g) for g in (np.ones(16), r))
    S = kaimal(f, wind)
    forces = wind_forces(assembly, RotorPlace(radius_m=RADIUS), wind_m_s=wind, working=True)
    passing = {g.name: g for g in passing_forces(forces, 0.4, wind, RADIUS)}
    known = {g.name: g for g in forces}
    assert off(known["rotor Fx"], f, S * thrust[:, 0]) < 0.3
    assert off(known["rotor My"], f, S * moment[:, 1]) < 0.3
    # with one corner, as it were a gust on a point, neither is met by half
    assert off(known["tower x"], f, S * thrust[:, 0]) > 0.4

    def variance(density: np.ndarray) -> float:
        return float(np.trapezoid(S * density, f))

    push, bend = variance(9.0 * thrust[:, 0]), variance(4.5 * moment[:, 1])
    third = variance(18.0 * thrust[:, 3]), variance(4.5 * (moment[:, 2] + moment[:, 4]))
    level = {name: g.level for name, g in (known | passing).items()}
    lever = level["rotor My"] / level["rotor Fx"]
    assert lever == pytest.approx(np.sqrt(bend / push), rel=0.3)
    # a record holds the less of the slow parts, the more of what passes
    share = level["rotor Fx, passing"] / level["rotor Fx"]
    assert share == pytest.approx(np.sqrt(third[0] / push), rel=0.25)
    share = level["rotor My, passing"] / level["rotor My"]
    assert share == pytest.approx(np.sqrt(third[1] / bend), rel=0.1)
    # half of what passes lies within a density's own corner of the frequency
    half = np.interp(0.5, np.cumsum(S * moment[:, 2] * f) / np.sum(S * moment[:, 2] * f), f)
    width = passing["rotor My, passing"].width * 0.4
    assert 0.7 < width / half < 1.5


@pytest.mark.parametrize("wind", [8.0, 14.0, 22.0])
def test_a_standing_rotor_bears_the_short_gusts_across(assembly: Assembly, wind: float) -> None:
    """Lift of v and w along three feathered blades, whose scales are 2.7 and 0.66 Λ₁ (table C.1)."""
    psi, r = np.repeat(2.0 * np.pi * np.arange(3) / 3, 12), np.tile((np.arange(12) + 0.5) / 12 * RADIUS, 3)
    at, across = (
        r[:, None] * np.column_stack([np.sin(psi), np.cos(psi)]),
        np.column_stack([np.cos(psi), -np.sin(psi)]),
    )
    f = np.geomspace(1.0 / 600.0, 0.5, 25)
    joined = coherence(f, wind, np.linalg.norm(at[:, None] - at[None], axis=2))
    forces = {g.name: g for g in wind_forces(assembly, AT_TOP, wind_m_s=wind)}
    for name, lever in (("rotor Fy", across[:, 0]), ("rotor Mx", r)):
        S = sum(
            ratio**2 * kaimal(f, wind, scale * 42.0) * np.einsum("i,fij,j->f", g, joined, g)
            for ratio, scale, g in zip((0.8, 0.5), (2.7, 0.66), (lever[:, None] * across).T, strict=True)
        )
        assert off(forces[name], f, S) < 0.3
        assert off(forces["tower x"], f, S) > off(forces[name], f, S) + 0.05
    assert not any("rotor" in name and "quick" in name for name in forces)


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
