"""The wake's answer to a moving tower, and what a rotor at work takes from it."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.loads.aerodynamics.blades import ALPHA, Blade
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Rotor
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.operation.bem import operating_point, ring_radius, steady_operation
from jackettwin.loads.operation.dynamic_inflow import operating_damping, wake_damping, wake_share

LIFT_SLOPE = 2.0 * np.pi


@pytest.fixture(scope="module")
def turbine():
    return read_rotor("iea15")


def disc() -> Rotor:
    """Return a hundred narrow straight blades without drag: a disc without losses at tip and hub."""
    z = np.linspace(1.0, 99.0, 60)
    chord = 2.0 / z
    weight = np.gradient(z)
    cl = np.tile(LIFT_SLOPE * ALPHA, (z.size, 1))
    # 0.03 rad of lift, but for the wake, at its wind of 10 m/s and 2 rad/s
    twist = 10.0 / (2.0 * z) - 0.03
    blade = Blade(z, np.zeros_like(z), chord, twist, np.full(z.size, 0.2), weight, cl, np.zeros_like(cl))
    return Rotor(blade, 100, 1e-3, overhang=0.0, hub_height=0.0, tilt=0.0, cone=0.0)


def test_wake_in_balance_is_that_of_an_actuator_disc() -> None:
    """A ring with thrust k(V − w) + const and 2ρ(V − w)w of momentum: dw/dV = (k − 2ρw)/(k + 2ρ(V − 2w)).

    k = ρBcC_l′Ω/4π per area, λ large so that swirl counts little.
    """
    rotor, V, Omega = disc(), 10.0, 2.0
    operation = steady_operation(rotor, V, rotor_speed=Omega, pitch=0.0)
    r, w = ring_radius(rotor), operation.induced[:, 0]
    k = AIR_KG_M3 * rotor.n_blades * rotor.blade.chord * LIFT_SLOPE * Omega / (4.0 * np.pi)
    dw = (k - 2.0 * AIR_KG_M3 * w) / (k + 2.0 * AIR_KG_M3 * (V - 2.0 * w))
    # within, swirl; at the very tip, Prandtl's loss
    outside = (r > 30.0) & (r < 95.0)
    area = 2.0 * np.pi * r * rotor.blade.weight * outside
    inner = replace(rotor.blade, weight=rotor.blade.weight * outside)
    found = wake_damping(replace(rotor, blade=inner), operation, 1e-9)[0, 0].real
    # swirl, and lift that grows with the square of the speed: λ is 6 to 19 there
    assert found == pytest.approx(-(area * k) @ dw, rel=0.03)


def test_slow_motion_meets_steady_thrust(turbine) -> None:
    """Frozen wake and the whole of its answer together are the slope of steady thrust along the shaft."""
    rotor, control = turbine
    rotor = replace(rotor, tilt=0.0, cone=0.0)
    for wind in (8.0, 18.0):
        at = operating_point(rotor, control, wind)
        speed = {"rotor_speed": at.rotor_speed, "pitch": at.pitch}
        up, down = (steady_operation(rotor, wind + dv, **speed).thrust for dv in (0.1, -0.1))
        slow = operating_damping(rotor, at, omega=1e-9).damping[0, 0]
        # prebend turns the sections in the whole geometry, not in the rings
        assert slow == pytest.approx((up - down) / 0.2, rel=0.03)
        frozen = operating_damping(rotor, at).damping[0, 0]
        assert abs(slow / frozen - 1.0) > 0.05


def test_slow_roll_about_the_shaft_meets_the_slope_of_steady_torque(turbine) -> None:
    """A hub at the tower top, shaft locked: rolling adds to the rotor's speed, and loses −dQ/dΩ."""
    rotor, control = turbine
    rotor = replace(rotor, tilt=0.0, cone=0.0, overhang=0.0, hub_height=0.0)
    at = operating_point(rotor, control, 12.0)
    h = 1e-3
    up, down = (
        steady_operation(rotor, 12.0, rotor_speed=at.rotor_speed + dp, pitch=at.pitch).torque
        for dp in (h, -h)
    )
    slow = operating_damping(rotor, at, omega=1e-9).damping[3, 3]
    assert slow == pytest.approx(-(up - down) / (2.0 * h), rel=0.03)


def test_six_tenths_of_the_wake_answer_past_the_first_lag(turbine) -> None:
    """H → 0.6/(1 + iωτ₂) for ωτ₁ ≫ 1 (Øye), τ₂/τ₁ = 0.39 − 0.26 (r/R)²."""
    rotor, control = turbine
    at = operating_point(rotor, control, 10.0)
    fast = np.abs(wake_share(rotor, at, 100.0))
    ratio = fast[-1] / fast[0]
    edge = ring_radius(rotor)[[0, -1]] / rotor.radius
    tau = 0.39 - 0.26 * edge**2
    assert ratio == pytest.approx(tau[0] / tau[1], rel=1e-3)
    area = ring_radius(rotor) * rotor.blade.weight
    a = area @ at.induced[:, 0] / area.sum() / 10.0
    first = 1.1 / (1.0 - 1.3 * a) * rotor.radius / 10.0
    np.testing.assert_allclose(fast[[0, -1]] * 100.0 * first * tau, 0.6, rtol=1e-3)


def test_the_wake_hardly_answers_a_tower(turbine) -> None:
    """Øye's lags against a first mode of 0.17 Hz: what is left of the wake's answer is a few percent."""
    rotor, control = turbine
    at = operating_point(rotor, control, 10.0)
    share = np.abs(wake_share(rotor, at, 2.0 * np.pi * 0.17))
    assert (share > 0.0).all()
    assert (share < 0.35).all()
    assert np.abs(wake_share(rotor, at, 1e-9) - 1.0).max() < 1e-6
    frozen, real = (operating_damping(rotor, at, omega=omega).damping for omega in (None, 1.07))
    assert real[0, 0] == pytest.approx(frozen[0, 0], rel=0.03)
    assert real[0, 0] != frozen[0, 0]


def test_a_free_shaft_gives_no_torque(turbine) -> None:
    rotor, control = turbine
    rotor = replace(rotor, tilt=0.0)
    at = operating_point(rotor, control, 14.0)
    free, locked = (
        operating_damping(rotor, at, omega=1.07, shaft=shaft).damping for shaft in ("free", "locked")
    )
    # what is left is of the overhang and the hub's height, which move the hub across
    assert abs(free[3, 3] / locked[3, 3]) < 0.01
    # how the tower rolls turns no free rotor; thrust does not see the shaft
    assert free[0, 0] == pytest.approx(locked[0, 0], rel=1e-9)


def test_damping_scales_with_the_air(turbine) -> None:
    rotor, control = turbine
    at = operating_point(rotor, control, 9.0)
    one, two = (wake_damping(rotor, at, 1.0, density=density) for density in (1.2, 2.4))
    np.testing.assert_allclose(two, 2.0 * one, rtol=1e-12)
