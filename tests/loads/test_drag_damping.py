"""Linear drag of members in a random sea."""

import numpy as np
import pytest
from scipy.integrate import quad

from jackettwin.decks import read_structure
from jackettwin.loads.members.drag_damping import sea_drag_damping, velocity_std
from jackettwin.loads.members.morison import MorisonPoints, morison_points, point_forces
from jackettwin.loads.sea.waves import SeaState, irregular_sea, jonswap
from jackettwin.structure import Assembly, assemble

SEA, DEPTH = SeaState(3.0, 8.0), 72.0


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return assemble(read_structure("jacket15"))


@pytest.fixture(scope="module")
def grid(assembly: Assembly) -> MorisonPoints:
    return morison_points(assembly, highest_z=0.0, lowest_z=-DEPTH, spacing=8.0)


def test_deep_water_on_a_level_brace_along_the_waves(grid: MorisonPoints) -> None:
    """Only the vertical velocity crosses it: σ² = ½ ∫ S ω² e^{2kz} df, k = ω²/g."""
    along = np.flatnonzero((np.abs(grid.normal[:, 0, 0]) < 1e-9) & (grid.points[:, 2] < 0.0))
    assert along.size
    sigma = velocity_std(grid, SEA, 2000.0)
    z = grid.points[along[0], 2]

    def density(f: float) -> float:
        omega = 2 * np.pi * f
        return float(jonswap(np.array([f]), Hs=3.0, Tp=8.0)[0] * omega**2 * np.exp(2 * omega**2 / 9.81 * z))

    variance = quad(density, 1e-3, 4.0 / 8.0, limit=200)[0]
    # steps of 1 mHz on a peak of 20 mHz
    assert sigma[along[0]] == pytest.approx(np.sqrt(0.5 * variance), rel=5e-3)


def test_it_is_the_spread_of_the_simulated_velocity(grid: MorisonPoints) -> None:
    few = np.flatnonzero(grid.points[:, 2] < -2.0)[::40]
    sea = irregular_sea(Hs=3.0, Tp=8.0, depth=DEPTH, duration=3600.0, seed=3, stretching="none")
    u, _ = sea.motion(grid.points[few], np.arange(0.0, 3600.0, 1.0))
    across = np.einsum("nij,tnj->tni", grid.normal[few], u)
    sigma = np.sqrt(0.5 * across.var(axis=0).sum(axis=1))
    # an hour of waves of 8 s in a narrow band: 4 % of a standard deviation, four times
    np.testing.assert_allclose(velocity_std(grid, SEA, DEPTH)[few], sigma, rtol=0.16, atol=1e-12)


def test_it_takes_the_energy_of_drag_on_the_members_own_motion(grid: MorisonPoints) -> None:
    """Borgman: the mean work of quadratic drag on a slow member in a Gaussian stream, by brute force."""
    rng = np.random.default_rng(1)
    one = int(np.argmin(grid.points[:, 2]))
    P = grid.normal[one]
    own = P @ np.array([0.0, 1.0, 0.0])
    own *= 0.01 / np.linalg.norm(own)
    # one component across the member, along its own motion
    u = rng.standard_normal(2000)[:, None] * own / np.linalg.norm(own)
    zero = np.zeros((u.shape[0], grid.weight.size, 3))
    stream, still = zero.copy(), zero[:1]
    stream[:, one] = u
    velocity = still.copy()
    velocity[:, one] = own
    with_motion = point_forces(grid, stream, zero, velocity=velocity)[:, one]
    without = point_forces(grid, stream, zero)[:, one]
    power = -float(((with_motion - without) @ own).mean())
    per_length = 0.5 * grid.density_kg_m3 * grid.drag[one] * grid.diameter[one] * np.sqrt(8 / np.pi)
    # 2000 draws of |u|: 1.7 %, four times
    assert power == pytest.approx(per_length * grid.weight[one] * float(own @ own), rel=0.07)


def test_damping_grows_with_the_sea_and_is_never_negative(assembly: Assembly, grid: MorisonPoints) -> None:
    small, large = (sea_drag_damping(grid, SeaState(h, 8.0, gamma=2.0), DEPTH).toarray() for h in (1.0, 3.0))
    np.testing.assert_allclose(large, 3.0 * small, rtol=1e-9, atol=1e-9)
    values = np.linalg.eigvalsh(0.5 * (large + large.T))
    assert values.min() > -1e-9 * values.max()
