"""ISO 19902 14.3 by hand, its branches, and the load paths that name a joint's kind."""

import numpy as np
import pytest

from jackettwin.checks.iso19902_joints import (
    BraceForces,
    Joint,
    gap_factor,
    joint_use,
    load_path,
    strength_factors,
)
from jackettwin.errors import InputError

Y_ONLY = np.array([[0.0], [1.0], [0.0]])


def joint(D=1.0, T=0.025, d=0.5, t=0.015, degrees=45.0, gap=np.nan) -> Joint:
    return Joint(D, T, d, t, np.radians(degrees), 355e6, 355e6, gap)


def forces(axial=0.0, in_plane=0.0, out_of_plane=0.0) -> BraceForces:
    return BraceForces(*(np.array([v]) for v in (axial, in_plane, out_of_plane)))


@pytest.mark.parametrize(
    ("d", "tension", "compression", "in_plane", "out_of_plane"),
    [
        # γ 20. β 0.5: Q_β 1; K 11.4, Y 15 | 11.4, X 11.5 | 2.8 + 14·0.5; 4.5·0.5·√20; 3.2·20^0.125
        (0.5, (11.4, 15.0, 11.5), (11.4, 11.4, 9.8), 10.0623, 4.6535),
        # β 0.8: Q_β = 0.3/(0.8·0.3336) = 1.12410; 17.1·√Q_β; X 18.4 | 14·Q_β; 3.2·20^0.32
        (0.8, (18.1300, 24.0, 18.4), (18.1300, 18.1300, 15.7374), 16.0997, 8.3460),
        # β 1: Q_β = 0.3/0.167 = 1.79641; X in tension 20.7 + 0.1·120
        (1.0, (28.0121, 30.0, 32.7), (28.0121, 28.0121, 30.1796), 20.1246, 14.3108),
    ],
)
def test_strength_factors_by_hand(d, tension, compression, in_plane, out_of_plane) -> None:
    """Table 14.3-1 with γ = 20; without a brace beside, Q_g = 1."""
    q = strength_factors(joint(d=d))
    np.testing.assert_allclose(q.tension, tension, rtol=1e-4)
    np.testing.assert_allclose(q.compression, compression, rtol=1e-4)
    assert (q.in_plane, q.out_of_plane) == pytest.approx((in_plane, out_of_plane), rel=1e-4)


@pytest.mark.parametrize(
    ("d", "kind", "axial", "Q_u", "P_a"), [(0.4, 1, 1.0, 24.0, 3351.8), (0.475, 2, -1.0, 23.289, 3255.7)]
)
def test_published_worked_examples_of_api_joints(d, kind, axial, Q_u, P_a) -> None:
    """Bentley, STAAD.Pro verification manual (2026), "V. API Y Joint" and "V. API X Joint", their hand sums.

    D 500, T 20 mm, θ = atan 2, F_y 500 MPa: a Y joint in tension and an X joint in compression, for which API
    RP 2A-WSD (21st edition, supplements 2 and 3) has ISO 19902's Q_u. P_a holds its factor of safety 1.6 and
    a Q_f within 0.1 % of 1; for moments and chord stresses API has other formulas.
    """
    one = Joint(0.5, 0.02, d, 0.02, np.arctan(2.0), 500e6, 500e6)
    shares, none = np.eye(3)[:, [kind]], np.zeros(1)
    use = joint_use(one, forces(axial * 1e6), shares, none, none)
    assert float(use.Q_u[0]) == pytest.approx(Q_u, rel=1e-4)
    assert 1e6 / float(use.utilisation[0]) * 1.05 == pytest.approx(1.6e3 * P_a, rel=2e-3)


def test_the_branches_of_the_table_meet() -> None:
    """X in tension at β = 0.9, Q_β at 0.6 (0.3/(0.6·0.5002) = 0.9996)."""
    for beta, rel in ((0.9, 1e-4), (0.6, 1e-3)):
        low, high = (strength_factors(joint(d=beta * s)) for s in (1.0 - 1e-6, 1.0 + 1e-6))
        np.testing.assert_allclose(low.tension, high.tension, rtol=rel)
        np.testing.assert_allclose(low.compression, high.compression, rtol=rel)


def test_gaps_and_overlaps_by_hand() -> None:
    """γ 20, g/T 4: 1.9 − 0.7·√(4/20) = 1.58695; overlap: 0.13 + 0.65·0.6·√20 = 1.87413; their middle at 0."""
    assert gap_factor(joint(gap=0.1)) == pytest.approx(1.58695, rel=1e-5)
    assert gap_factor(joint(gap=1.0)) == 1.0
    assert gap_factor(joint(gap=-0.2)) == pytest.approx(1.87413, rel=1e-5)
    ends = gap_factor(joint(gap=0.05)), gap_factor(joint(gap=-0.05))
    assert gap_factor(joint(gap=0.0)) == pytest.approx(np.mean(ends))
    # the same as the Norwegian N-004 (1998) writes it: 1.9 − √(g/D), within the rounding of 0.7·√2
    assert gap_factor(joint(gap=0.1)) == pytest.approx(1.9 - 0.1**0.5, rel=3e-3)


def test_a_y_joint_by_hand() -> None:
    """1 MN at 45° on f_y T² = 0.221875 MN: P_d = 0.221875/(1.05·0.70711)·Q_u = 0.298838·Q_u.

    Tension Q_u 15, compression 11.4. In-plane 0.1 MN·m: M_d = 0.298838·0.5·10.0623 = 1.50349; squared.
    Out-of-plane 0.1: M_d = 0.298838·0.5·4.6535 = 0.69532.
    """
    none = np.zeros(1)
    for axial, wanted in ((1e6, 1.0 / (0.298838 * 15.0)), (-1e6, 1.0 / (0.298838 * 11.4))):
        use = joint_use(joint(), forces(axial), Y_ONLY, none, none)
        assert float(use.utilisation[0]) == pytest.approx(wanted, rel=1e-4)
    use = joint_use(joint(), forces(1e6, 1e5, -1e5), Y_ONLY, none, none)
    wanted = 1.0 / (0.298838 * 15.0) + (0.1 / 1.50349) ** 2 + 0.1 / 0.69532
    assert float(use.utilisation[0]) == pytest.approx(wanted, rel=1e-4)


def test_the_chord_s_own_stress_by_hand() -> None:
    """P_C = P_y/3, M_C = M_p/4, Y: q_A² = 1.1025·(25/9 + 11/16) = 3.82043; Q_f 0.88539.

    Against moments q_A² = 1.1025·(25/9 + 43/16) = 6.02547: Q_f 0.72885 in plane, 0.87347 out of plane.
    """
    one = joint()
    P_y = 355e6 * 0.25 * np.pi * (1.0 - 0.95**2)
    M_p = 355e6 * (1.0 - 0.95**3) / 6.0
    use = joint_use(one, forces(1e6), Y_ONLY, np.array([P_y / 3.0]), np.array([-M_p / 4.0]))
    np.testing.assert_allclose(use.Q_f[:, 0], (0.88539, 0.72885, 0.87347), rtol=1e-4)
    # of two sides of the chord the worse counts
    sides = np.array([[0.0], [P_y / 3.0]]), np.array([[0.0], [M_p / 4.0]])
    np.testing.assert_allclose(joint_use(one, forces(1e6), Y_ONLY, *sides).Q_f, use.Q_f)


def test_conservative_is_the_weakest_kind() -> None:
    none = np.zeros(1)
    worst = joint_use(joint(), forces(-1e6), Y_ONLY, none, none, conservative=True)
    assert float(worst.Q_u[0]) == pytest.approx(9.8)


def test_load_paths_of_textbook_joints() -> None:
    """ISO 19902 figure 14.2-2's ideas: balanced K, Y alone, X through the chord, and their mixtures."""
    up, down = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])
    right = np.array([0.0, 1.0, 0.0])
    angle = np.full(2, np.radians(45.0))

    def paths(axial, across, theta=angle):
        return load_path(np.array(axial)[:, None], theta, np.array(across))[:, :, 0].T

    # a K joint: one pulls, its neighbour pushes as much
    np.testing.assert_allclose(paths([1.0, -1.0], [up, up]), [[1, 0, 0], [1, 0, 0]])
    # half of it balanced: the stronger brace is half K, half Y
    np.testing.assert_allclose(paths([2.0, -1.0], [up, up]), [[0.5, 0.5, 0], [1, 0, 0]])
    # both pull on one side: Y
    np.testing.assert_allclose(paths([1.0, 1.0], [up, up]), [[0, 1, 0], [0, 1, 0]])
    # both pull, from opposite sides: X; one pulls and one pushes: the chord carries both
    np.testing.assert_allclose(paths([1.0, 1.0], [up, down]), [[0, 0, 1], [0, 0, 1]])
    np.testing.assert_allclose(paths([1.0, -1.0], [up, down]), [[0, 1, 0], [0, 1, 0]])
    # braces in other planes have nothing to do with each other
    np.testing.assert_allclose(paths([1.0, -1.0], [up, right]), [[0, 1, 0], [0, 1, 0]])
    # angles count: 1 at 30° balances ½ at 90°
    theta = np.radians([30.0, 90.0])
    np.testing.assert_allclose(paths([1.0, -0.5], [up, up], theta), [[1, 0, 0], [1, 0, 0]], atol=1e-12)


def test_shares_add_up() -> None:
    """Whatever the forces, K, Y and X make the whole, and none is negative."""
    rng = np.random.default_rng(2)
    across = np.array([[0, 0, 1.0], [0, 0, 1.0], [0, 0, -1.0], [0, 1.0, 0]])
    shares = load_path(rng.standard_normal((4, 200)), rng.uniform(0.6, 1.5, 4), across)
    np.testing.assert_allclose(shares.sum(axis=0), 1.0)
    assert shares.min() >= -1e-12


def test_ranges_are_said() -> None:
    assert joint().beyond_validity == ()
    said = " ".join(Joint(1.0, 0.005, 0.1, 0.01, np.radians(20.0), 600e6, 355e6, -1.0).beyond_validity)
    for word in ("β", "γ", "θ", "f_y", "overlap"):
        assert word in said
    with pytest.raises(InputError, match="must be positive"):
        joint(T=0.0)
