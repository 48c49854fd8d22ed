"""What the blades' passing and turbulence do to the tower top."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.loads.aerodynamics.rotor import elements, rotation, rotor_loads
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.loads.operation.bem import operating_point
from jackettwin.loads.operation.damping import operating_damping
from jackettwin.loads.operation.excitation import TowerOutline, _steady_wind, passing_loads, turbulent_loads

TOWER = TowerOutline(np.array([-129.0, 0.0]), np.array([10.0, 6.5]))


@pytest.fixture(scope="module")
def turbine():
    rotor, control = read_rotor("iea15")
    return rotor, control, operating_point(rotor, control, 12.0)


def test_even_wind_on_alike_blades_shakes_nothing(turbine) -> None:
    rotor, _, at = turbine
    rotor = replace(rotor, tilt=0.0)
    still = passing_loads(rotor, at, Wind(12.0, 150.0, 0.0, shear=0.0))
    assert np.abs(still).max() < 1e-6 * at.thrust
    tower = passing_loads(rotor, at, Wind(12.0, 150.0, 0.0, shear=0.0), tower=TOWER)
    assert tower[0, 0] > 1e-3 * at.thrust
    shear = passing_loads(rotor, at, Wind(12.0, 150.0, 0.0, shear=0.3))
    assert shear[0, 4] > 1e5


def test_passing_is_the_fourier_line_of_the_turning_rotor(turbine) -> None:
    """Against loads turn by turn: their line at three times the rotor's frequency, by another sampling."""
    rotor, _, at = turbine
    wind = Wind(12.0, 150.0, 0.0, shear=0.2)
    angles = 2.0 * np.pi * np.arange(60) / 60
    arm = elements(rotor, at.pitch).arm
    loads = []
    for angle in angles:
        height = 150.0 + (arm @ rotation(rotor.shaft, float(angle)).T)[..., 2]
        blown = np.stack([wind.mean(height), np.zeros_like(height), np.zeros_like(height)], axis=-1)
        loads.append(
            rotor_loads(
                rotor, blown, pitch=at.pitch, azimuth=float(angle), rotor_speed=at.rotor_speed,
                induced=at.induced,
            )
        )  # fmt: skip
    line = 2.0 / 60 * np.abs(np.exp(-3j * angles) @ np.array(loads))
    # polars are straight between their points: lines of high orders fold differently
    np.testing.assert_allclose(passing_loads(rotor, at, wind)[0], line, rtol=2e-4)


def test_the_tower_holds_up_the_wind_as_a_cylinder_does(turbine) -> None:
    """Potential flow: V(1 − a²/x²) upstream on the axis, V(1 + a²/y²) beside it, none at its front."""
    rotor = turbine[0]
    wind = Wind(10.0, 150.0, 0.0, shear=0.0)
    a = 4.0
    tower = TowerOutline(np.array([-100.0, 0.0]), np.array([2.0 * a, 2.0 * a]))
    places = np.array([[-10.0, 0.0, -50.0], [0.0, 10.0, -50.0], [-a, 0.0, -50.0], [-10.0, 0.0, 5.0]])
    found = _steady_wind(places, wind, rotor, tower)
    np.testing.assert_allclose(found[:, 0], [8.4, 11.6, 0.0, 10.0], atol=1e-12)
    np.testing.assert_allclose(found[:, 1:], 0.0, atol=1e-12)


def test_thrust_follows_turbulence_less_than_a_gust_over_the_whole_rotor(turbine) -> None:
    rotor, _, at = turbine
    wind = Wind(12.0, 150.0, "B")
    found = turbulent_loads(rotor, at, wind, seed=1)
    whole_gust = operating_damping(rotor, at).damping[0, 0] * wind.sigma
    assert 0.3 * whole_gust < found.whole[0] < 0.7 * whole_gust
    assert (found.passing < found.whole).all()
    # blades cut through eddies: the tower's side and yaw are shaken most at their passing
    assert found.passing[5] > 0.3 * found.whole[5]
