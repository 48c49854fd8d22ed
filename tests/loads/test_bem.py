"""Power production of the IEA 15 MW rotor."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import rotor_loads
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.operation.bem import operating_point, steady_operation
from jackettwin.loads.operation.damping import operating_damping


@pytest.fixture(scope="module")
def turbine():
    return read_rotor("iea15")


def coefficients(rotor, operation) -> tuple[float, float]:
    disc = 0.5 * 1.225 * np.pi * 120.97**2 * operation.wind_speed**2
    return operation.power / (disc * operation.wind_speed), operation.thrust / disc


def test_optimal_operation(turbine) -> None:
    """Gaertner et al. 2020 (NREL/TP-5000-75698), table 1-1: Cp 0.489 at tip-speed ratio 9; CT 0.804 there."""
    rotor, control = turbine
    Cp, CT = coefficients(rotor, operating_point(rotor, control, 8.0))
    # BEM without tilt and with stiff blades: 1 % each way
    assert Cp == pytest.approx(0.489, rel=0.02)
    assert CT == pytest.approx(0.804, rel=0.02)


def test_power_is_held_above_rated_and_pitch_grows(turbine) -> None:
    rotor, control = turbine
    points = [operating_point(rotor, control, V) for V in (12.0, 16.0, 24.0)]
    wanted = control.rated_power_w / control.efficiency
    np.testing.assert_allclose([point.power for point in points], wanted, rtol=1e-6)
    pitch = np.degrees([point.pitch for point in points])
    assert (np.diff(pitch) > 2.0).all()
    assert pitch[-1] == pytest.approx(22.0, abs=1.0)  # public reference controller at 24 m/s
    assert points[0].thrust > points[1].thrust > points[2].thrust


def test_induction_balances_momentum(turbine) -> None:
    """Light loading: thrust of the blades equals ∫4a(1−a)ρV²πr dr within the tip's losses."""
    rotor, _ = turbine
    operation = steady_operation(rotor, 10.0, rotor_speed=0.5, pitch=0.05)
    a = operation.induced[:, 0] / 10.0
    r = rotor.hub_radius + rotor.blade.z
    middle = (r > 30.0) & (r < 100.0)
    assert (a[middle] < 0.4).all()
    annuli = 4 * a * (1 - a) * 1.225 * 100.0 * np.pi * r
    wake = rotor_loads(
        rotor, np.array([10.0, 0.0, 0.0]), pitch=0.05, rotor_speed=0.5, induced=operation.induced
    )
    assert np.trapezoid(annuli[middle], r[middle]) < operation.thrust
    # the same elements, tilted and coned in the frame of the tower top
    assert np.linalg.norm(wake[:3]) == pytest.approx(operation.thrust, rel=0.03)


def test_operating_rotor_damps_fore_aft_far_more_than_parked(turbine) -> None:
    """Operating fore-aft damping of large turbines is 5–10 % of critical (van Vondelen 2022, WES 7:161)."""
    rotor, control = turbine
    C = operating_damping(rotor, operating_point(rotor, control, 10.0)).damping
    zeta = C[0, 0] / (2.0 * 1.12e6 * 2.0 * np.pi * 0.183)
    assert 0.05 < zeta < 0.10
    assert C[1, 1] < 0.2 * C[0, 0]


def test_standing_rotors_have_no_operation(turbine) -> None:
    with pytest.raises(InputError, match="rotating rotor"):
        steady_operation(turbine[0], 10.0, rotor_speed=0.0, pitch=0.0)
