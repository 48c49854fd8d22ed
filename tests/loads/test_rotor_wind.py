"""Wind over the rotor: mean profile, frames, rotational sampling, and the compiled blade elements in it."""

import numpy as np
import pytest

from jackettwin.loads import read_rotor
from jackettwin.loads.aerodynamics.rotor import compiled_rotor, elements, linearise, rotation, rotor_loads
from jackettwin.loads.aerodynamics.rotor_wind import RINGS, SPOKES, rotor_wind
from jackettwin.loads.aerodynamics.standing_blades import grid_nodes
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.loads.kernels import _arctan2

ROTOR, _ = read_rotor("iea15")
HUB = 149.6


def steady(shear: float = 0.14, azimuth: float | None = 0.0):
    return rotor_wind(Wind(12.0, HUB, 0.0, shear), ROTOR, duration=10.0, step=0.5, seed=0, azimuth=azimuth)


def test_shear_reaches_the_blades() -> None:
    """The first blade points up, the others down: power law at their heights, to tilt and rings' spacing."""
    z = HUB + elements(ROTOR, 0.5 * np.pi).arm[:, :, 2]
    for azimuth in (0.0, None):
        field = steady(0.2, azimuth)
        found = field.on_blades(ROTOR, np.zeros(field.n_times))[0].reshape(3, -1, 3)
        np.testing.assert_allclose(found[..., 0], 12.0 * (z / HUB) ** 0.2, rtol=0.012)
        np.testing.assert_array_equal(found[..., 1:], 0.0)


def test_blades_cut_through_the_wind_where_they_are() -> None:
    """Element e at azimuth ψ: its place in the disc and the wind's, both in the disc's own coordinates."""
    field = steady(0.2, None)
    psi = np.linspace(0.0, 2.0 * np.pi, field.n_times)
    found = field.on_blades(ROTOR, psi)[:, ROTOR.blade.z.size - 1, 0]
    tip = HUB + (ROTOR.hub_radius + ROTOR.blade.z[-1]) * np.cos(psi)
    # twelve spokes cut the circle short by up to 3.4 % of the radius, which tells most low down
    np.testing.assert_allclose(found, 12.0 * (tip / HUB) ** 0.2, rtol=0.04)


def test_a_yawed_nacelle_sees_the_wind_from_its_side() -> None:
    """Turned anticlockwise by 30°: the wind heads 30° clockwise of its axis."""
    field = steady(0.0)
    seen = field.on_blades(ROTOR, np.zeros(field.n_times), yaw=np.radians(30.0))[0, 0]
    np.testing.assert_allclose(
        seen, 12.0 * np.array([np.cos(np.pi / 6), -np.sin(np.pi / 6), 0.0]), atol=1e-12
    )


def test_ring_points_have_the_spectrum_and_lose_coherence() -> None:
    """σ of the samples within 10 %; neighbours on the inner ring are alike, tips across the disc are not."""
    wind = Wind(12.0, HUB, "B")
    field = rotor_wind(wind, ROTOR, duration=1200.0, step=0.25, seed=3, azimuth=None)
    u = field.rotor[..., 0]
    assert u.shape[1] == 1 + len(RINGS) * SPOKES
    assert u.std(axis=0).mean() == pytest.approx(wind.sigma, rel=0.1)
    R = np.corrcoef(u.T)
    assert R[1, 2] > 0.6
    assert R[-1, -1 - SPOKES // 2] < 0.5


def test_loads_do_not_depend_on_the_pieces_if_all_components_are_coherent() -> None:
    """Net side force at 0.1 to 0.3 Hz on pieces of 30 m and 8 m; with u alone coherent it grows by 1.7."""
    wind = Wind(12.0, HUB, "B")
    rotor = compiled_rotor(ROTOR, pitch=0.5 * np.pi)

    def level(coherent: str, piece: float) -> float:
        power = []
        for seed in range(6):
            field = rotor_wind(
                wind, ROTOR, duration=600.0, step=0.5, seed=seed, coherent=coherent, piece=piece
            )
            still = np.zeros(field.n_times)
            force = rotor.loads(field.on_blades(ROTOR, still), np.zeros((field.n_times, 6)), still)[:, 1]
            f = np.fft.rfftfreq(force.size, 0.5)
            band = (f > 0.1) & (f < 0.3)
            power.append((np.abs(np.fft.rfft(force - force.mean())) ** 2)[band].mean())
        return float(np.sqrt(np.mean(power)))

    # 120 lines, six seeds: each level is known to 2 %
    assert level("all", 30.0) == pytest.approx(level("all", 8.0), rel=0.1)
    assert level("u", 30.0) > 1.5 * level("u", 8.0)


def test_tower_wind_follows_the_profile() -> None:
    field, z = steady(0.14), np.array([5.0, 60.0, 140.0])
    np.testing.assert_allclose(field.at_heights(z)[0, :, 0], 12.0 * (z / HUB) ** 0.14, rtol=1e-12)


@pytest.mark.parametrize("shaft", ["locked", "free"])
def test_loads_change_with_motion_as_the_linearisation_says(shaft: str) -> None:
    """Small motions in uniform wind: F(v) − F(0) = −C v to second order in v."""
    wind = np.array([15.0, 0.0, 0.0])
    C = linearise(ROTOR, 15.0, pitch=0.5 * np.pi, azimuth=0.2, shaft=shaft).damping
    rotor = compiled_rotor(ROTOR, pitch=0.5 * np.pi, shaft=shaft)
    n = ROTOR.n_blades * ROTOR.blade.z.size
    v = np.diag([0.02, 0.02, 0.02, 2e-4, 2e-4, 2e-4])
    moving = rotor.loads(np.broadcast_to(wind, (6, n, 3)).copy(), v, np.full(6, 0.2))
    still = rotor_loads(ROTOR, wind, pitch=0.5 * np.pi, azimuth=0.2, shaft=shaft)
    np.testing.assert_allclose(moving - still, -(C @ v).T, atol=0.02 * np.abs(C @ v).max())


def test_a_turned_rotor_carries_its_load_along() -> None:
    """Reciprocity of frames: turning rotor, wind and load by a third of a turn changes nothing."""
    wind = np.array([10.0, 2.0, -1.0])
    d = ROTOR.shaft
    third = 2.0 * np.pi / 3.0
    first = rotor_loads(ROTOR, wind, pitch=1.2)
    again = rotor_loads(ROTOR, wind, pitch=1.2, azimuth=third)
    np.testing.assert_allclose(again, first, rtol=1e-9, atol=1e-6)
    assert rotation(d, third) @ d == pytest.approx(d)


def test_nodes_of_a_grid_average_more_for_blades_that_slant() -> None:
    """Between nodes of independent winds the shares' squares add up: 1 at a node, 2/3 along a grid line.

    The first blade stands on such a line (2/3 in the mean), the others cut across: (2/3)² in the mean.
    """
    places = grid_nodes(HUB, ROTOR, 0.0, 3.0)
    np.testing.assert_allclose(places.shares.sum(axis=1), 1.0, rtol=1e-12)
    # a plane wind is interpolated without error, at the elements' own places
    arm = ROTOR.hub_radius + ROTOR.blade.z
    angle = np.repeat(2.0 * np.pi * np.arange(3) / 3.0, arm.size)
    at = np.stack([-np.sin(angle) * np.tile(arm, 3), HUB + np.cos(angle) * np.tile(arm, 3)], axis=1)
    np.testing.assert_allclose(places.shares @ places.points[:, 0], at, atol=1e-9)
    power = (places.shares**2).sum(axis=1).reshape(3, -1).mean(axis=1)
    # fifty elements, 117 m: the mean over the cells is met within some percent
    assert power[0] == pytest.approx(2.0 / 3.0, rel=0.05)
    np.testing.assert_allclose(power[1:], 4.0 / 9.0, rtol=0.05)


def test_a_standing_rotor_takes_its_wind_from_the_grid() -> None:
    wind = Wind(12.0, HUB, "B")
    field = rotor_wind(wind, ROTOR, duration=300.0, step=0.5, seed=3, coherent="u", grid=24.0)
    seen = field.on_blades(ROTOR, np.zeros(field.n_times)).reshape(field.n_times, 3, -1, 3)
    root = seen[:, :, 0]
    # all roots lie 4 m from one node: its share is 0.79 to 0.83 of the wind there
    for component in range(3):
        apart = (root[:, 0, component] - root[:, 1, component]).std()
        assert apart < 0.4 * root[:, 0, component].std()
    assert np.corrcoef(root[:, 0, 0], field.at_hub()[:, 0])[0, 1] > 0.95
    tips = seen[:, 1:, -1, 1].std(axis=0) / seen[:, 0, 0, 1].std()
    assert (tips < 1.0).all()


def test_the_angle_of_the_flow_is_right_in_every_quarter() -> None:
    """2e-8 rad, the polynomial's stated error, against the library's; the axes and nothing at all."""
    angle = np.linspace(-np.pi, np.pi, 2001)
    arctan2 = _arctan2.py_func  # compiled, it has no door to Python
    found = np.array([arctan2(np.sin(a), np.cos(a)) for a in angle])
    np.testing.assert_allclose(found[1:-1], angle[1:-1], atol=2.1e-8)
    assert arctan2(0.0, 0.0) == 0.0
    assert arctan2(0.0, -1.0) == np.pi
