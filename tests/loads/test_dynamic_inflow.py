"""Lags of wake and lift, and what a rotor at work takes from its tower."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.loads.aerodynamics.blades import ALPHA, Blade
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Rotor, linearise
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.operation.bem import operating_point, ring_forces, ring_radius, steady_operation
from jackettwin.loads.operation.blade_bending import MODES_PER_BLADE
from jackettwin.loads.operation.damping import operating_damping
from jackettwin.loads.operation.dynamic_inflow import lift_share, wake_share
from jackettwin.loads.operation.skewed_wake import redistributed
from jackettwin.structure import FlexibleRotor
from jackettwin.structure.rotor_modes import rotor_modes

LIFT_SLOPE = 2.0 * np.pi
SLOW = 1e-6j
FIRST = 1.07j


@pytest.fixture(scope="module")
def turbine():
    rotor, control = read_rotor("iea15")
    return rotor, control


@pytest.fixture(scope="module")
def upright(turbine):
    """Return the rotor with straight blades square to the wind: no skew, and rings as in the whole."""
    rotor, _ = turbine
    straight = replace(rotor.blade, prebend=np.zeros_like(rotor.blade.prebend))
    return replace(rotor, blade=straight, tilt=0.0, cone=0.0)


@pytest.fixture
def quasi_steady(monkeypatch) -> None:
    """Let lift follow at once."""
    monkeypatch.setattr("jackettwin.loads.operation.blade_air.lift_share", np.ones_like)


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
    inner_disc = replace(rotor, blade=inner)
    slow = operating_damping(inner_disc, operation, pole=SLOW).damping[0, 0]
    h = 0.01
    up, down = (ring_forces(inner_disc, V + dv, Omega * r, 0.0, operation.induced)[0].sum() for dv in (h, -h))
    # swirl, and lift that grows with the square of the speed: λ is 6 to 19 there
    assert slow - (up - down) / (2.0 * h) == pytest.approx(-(area * k) @ dw, rel=0.03)


def test_slow_motion_meets_steady_thrust(turbine, upright) -> None:
    """At λ → 0 the wake is in balance: the slope of steady thrust along the shaft."""
    for wind in (8.0, 18.0):
        at = operating_point(upright, turbine[1], wind)
        speed = {"rotor_speed": at.rotor_speed, "pitch": at.pitch}
        up, down = (steady_operation(upright, wind + dv, **speed).thrust for dv in (0.1, -0.1))
        slow = operating_damping(upright, at, pole=SLOW, bending=False).damping[0, 0]
        assert slow == pytest.approx((up - down) / 0.2, rel=2e-3)
        frozen = operating_damping(upright, at).damping[0, 0]
        assert abs(slow / frozen - 1.0) > 0.05


def test_slow_roll_about_the_shaft_meets_the_slope_of_steady_torque(turbine, upright) -> None:
    """A hub at the tower top, shaft locked: rolling adds to the rotor's speed, and loses −dQ/dΩ."""
    rotor = replace(upright, overhang=0.0, hub_height=0.0)
    at = operating_point(rotor, turbine[1], 12.0)
    h = 1e-3
    up, down = (
        steady_operation(rotor, 12.0, rotor_speed=at.rotor_speed + dp, pitch=at.pitch).torque
        for dp in (h, -h)
    )
    slow = operating_damping(rotor, at, pole=SLOW, bending=False).damping[3, 3]
    assert slow == pytest.approx(-(up - down) / (2.0 * h), rel=2e-3)


def test_a_slow_turn_of_the_tower_turns_the_steady_load(turbine, quasi_steady) -> None:
    """Of a rotor turned at rest by a small yaw the load is that of wind from there, turned: K θ = −δF."""
    rotor, control = turbine
    at = operating_point(rotor, control, 9.0)
    small = 1e-3

    def turned(angle: float) -> np.ndarray:
        # a nacelle yawed by +θ sees wind from −θ
        load = operating_damping(rotor, at, pole=SLOW, yaw_error=-angle, bending=False).load
        return load + angle * np.concatenate([np.cross([0, 0, 1.0], part) for part in np.split(load, 2)])

    K = operating_damping(rotor, at, pole=SLOW, bending=False).stiffness[:, 5]
    found = -(turned(small) - turned(-small)) / (2.0 * small)
    np.testing.assert_allclose(found, K, rtol=2e-3, atol=2e-3 * np.abs(K[1]))


def test_skewed_wake_of_pitt_and_peters() -> None:
    """15π/32 tan(χ/2) r/R, most where the blade points downwind; yaw 20°, a = 1/3: χ = 24°."""
    induced = np.full((4, 1, 2), 3.0)
    skew = np.array([0.0, np.tan(np.radians(20.0))])
    pointing = np.array([[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]])
    found = redistributed(induced, np.full((4, 1), 9.0), skew, pointing=pointing, share=np.array([0.8]))
    more = 3.0 * 15.0 * np.pi / 32.0 * np.tan(np.radians(12.0)) * 0.8
    np.testing.assert_allclose(found[:, 0, 0] - 3.0, [more, 0.0, -more, 0.0], atol=1e-9)
    np.testing.assert_array_equal(found[..., 1], induced[..., 1])


def test_skew_of_the_towers_own_motion_pushes_across_the_wind(turbine, quasi_steady) -> None:
    """AeroDyn's driver (5.0.0), 8 m/s, the base swaying 0.3 m at 1/6 Hz, rigid blades, UA off.

    Force across −954 N·s/m with skew (+1007 without), yaw moment 5.27e5 N·s (−7.88e5 without), tilt moment
    1.551e6 N·s.
    """
    rotor, control = turbine
    at = operating_point(rotor, control, 8.0)
    rigid = replace(rotor, bending=None)
    C = operating_damping(rigid, at, pole=2j * np.pi / 6.0).damping[:, 1]
    # what is left of parts that cancel: of the force 1.8e5 N·s/m along the wind
    assert C[1] == pytest.approx(-954.0, abs=50.0)
    assert C[5] == pytest.approx(5.27e5, rel=0.06)
    assert C[4] == pytest.approx(1.551e6, rel=0.01)


def test_six_tenths_of_the_wake_answer_past_the_first_lag(turbine) -> None:
    """H → 0.6/(1 + iωτ₂) for ωτ₁ ≫ 1 (Øye), τ₂/τ₁ = 0.39 − 0.26 (r/R)²."""
    rotor, control = turbine
    at = operating_point(rotor, control, 10.0)
    fast = np.abs(wake_share(rotor, at, 100.0j))
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
    share = np.abs(wake_share(rotor, at, 2j * np.pi * 0.17))
    assert (share > 0.0).all()
    assert (share < 0.35).all()
    assert np.abs(wake_share(rotor, at, 1e-9j) - 1.0).max() < 1e-6
    frozen = operating_damping(rotor, at).damping
    real = operating_damping(replace(rotor, bending=None), at, pole=FIRST).damping
    assert real[0, 0] == pytest.approx(frozen[0, 0], rel=0.06)
    assert real[0, 0] != frozen[0, 0]


def test_lift_of_a_step_begins_with_nothing_and_becomes_steady() -> None:
    """1 − 0.3 e^{−0.14 s} − 0.7 e^{−0.53 s} of semichords s: slow changes lag by 0.3/0.14 + 0.7/0.53."""
    assert lift_share(np.array([0.0j]))[0] == 1.0
    assert abs(lift_share(np.array([1e9j]))[0]) < 1e-8
    slow = lift_share(np.array([1e-6j]))[0]
    assert (slow - 1.0) / 1e-6j == pytest.approx(-(0.3 / 0.14 + 0.7 / 0.53), rel=1e-4)


def test_a_free_shaft_gives_no_torque(turbine) -> None:
    rotor, control = turbine
    rotor = replace(rotor, tilt=0.0, overhang=0.0, hub_height=0.0)
    at = operating_point(rotor, control, 14.0)
    free, locked = (
        operating_damping(rotor, at, pole=FIRST, shaft=shaft).damping for shaft in ("free", "locked")
    )
    assert abs(free[3, 3] / locked[3, 3]) < 1e-9
    # how the tower rolls turns no free rotor; thrust does not see the shaft
    assert free[0, 0] == pytest.approx(locked[0, 0], rel=1e-9)


def test_air_forces_scale_with_the_air(turbine) -> None:
    rotor, control = turbine
    rotor = replace(rotor, bending=None)
    at = operating_point(rotor, control, 9.0)
    one, two = (operating_damping(rotor, at, pole=1j, density=density) for density in (1.2, 2.4))
    np.testing.assert_allclose(two.damping, 2.0 * one.damping, rtol=1e-12)
    np.testing.assert_allclose(two.stiffness, 2.0 * one.stiffness, rtol=1e-12)


def test_a_wake_too_slow_to_answer_leaves_the_frozen_rotor(turbine, upright, quasi_steady) -> None:
    """The harmonics' matrix is that of whole rotors differenced, but for sidewise motion."""
    rotor = replace(upright, bending=None, overhang=0.0, hub_height=0.0)
    at = operating_point(rotor, turbine[1], 15.0)
    ours = operating_damping(rotor, at, pole=2000.0j).damping
    still = linearise(rotor, 15.0, pitch=at.pitch, rotor_speed=at.rotor_speed, induced=at.induced).damping
    scale = np.sqrt(np.outer(np.diag(still), np.diag(still)))
    apart = (ours - still) / scale
    # motion across the wind skews the wake at once
    np.testing.assert_allclose(apart[:, [0, 3]], 0.0, atol=2e-3)
    assert abs(apart[1, 2]) > 0.1


def test_a_spinning_rotor_is_a_gyroscope(turbine) -> None:
    """No air: J_p Ω between pitch and yaw about the hub, J_p = Σ m r² of the blades; it takes no work."""
    rotor, control = turbine
    rotor = replace(rotor, tilt=0.0, cone=0.0, overhang=0.0, hub_height=0.0)
    at = operating_point(rotor, control, 12.0)
    C = operating_damping(rotor, at, pole=FIRST, bending=False, density=1e-9).damping
    blade = rotor.bending
    middle = rotor.hub_radius + 0.5 * (blade.z[1:] + blade.z[:-1])
    mass = 0.5 * (blade.mass_kg_m[1:] + blade.mass_kg_m[:-1]) * np.diff(blade.z)
    polar = 3.0 * float(mass @ middle**2) * at.rotor_speed
    # pitching up about y, a rotor that turns about +x throws its moment about −z: M = −θ̇ × (J_p Ω x)
    assert C[5, 4] == pytest.approx(-polar, rel=2e-3)
    assert C[4, 5] == pytest.approx(polar, rel=2e-3)
    np.testing.assert_allclose(C[:3], 0.0, atol=1e-6 * polar)


def stiffer(rotor: Rotor, times: float) -> Rotor:
    blade = rotor.bending
    assert blade is not None
    return replace(
        rotor,
        bending=replace(blade, flap_n_m2=times * blade.flap_n_m2, edge_n_m2=times * blade.edge_n_m2),
    )


def test_stiff_blades_do_not_bend(turbine) -> None:
    rotor, control = turbine
    at = operating_point(rotor, control, 12.0)
    rigid = operating_damping(rotor, at, pole=FIRST, bending=False)
    scale = np.sqrt(np.outer(*[np.abs(np.diag(rigid.damping))] * 2))
    bent = [operating_damping(stiffer(rotor, times), at, pole=FIRST).damping for times in (1.0, 100.0, 400.0)]
    apart = [np.abs((C - rigid.damping) / scale).max() for C in bent]
    assert apart[0] > 0.1
    # as one over the stiffness
    assert apart[2] < 5e-3
    assert apart[1] / apart[2] == pytest.approx(4.0, rel=0.2)


def test_bending_blades_at_rest_are_their_modes_beside_the_rigid_rotor() -> None:
    """No air, no turning: M ω² LLᵀ/(ω_k² − ω²) of modes with coupling L (rotor_modes), three of them kept."""
    rotor, _ = read_rotor("iea15")
    blade, none = rotor.blade, np.zeros_like(rotor.blade.cl)
    straight = replace(rotor, blade=replace(blade, prebend=np.zeros_like(blade.prebend), cl=none, cd=none))
    assert straight.bending is not None
    at = steady_operation(straight, 1.0, rotor_speed=0.01, pitch=0.1)
    undamped = replace(straight, bending=replace(straight.bending, damping_ratio=0.0))
    omega = 1.5
    K = operating_damping(undamped, at, pole=1j * omega).stiffness
    flexible = FlexibleRotor(
        undamped.bending, rotor.hub_radius, rotor.overhang, rotor.hub_height, rotor.tilt, rotor.cone, 0.1
    )
    modes = rotor_modes(flexible)
    kept = np.arange(modes.omega.size) < 3 * MODES_PER_BLADE
    L, own = modes.coupling[:, kept], modes.omega[kept]
    wanted = -(L * (omega**4 / (own**2 - omega**2))) @ L.T
    scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    # turning at 0.01 rad/s is a hundredth of ω, and its square counts
    np.testing.assert_allclose(K / scale, wanted / scale, atol=2e-3)


def test_air_and_steel_take_work_from_bending_blades(turbine) -> None:
    """Whatever the tower top does at 1.07 rad/s along the shaft and about its axes, the rotor takes work."""
    rotor, control = turbine
    for wind in (6.0, 12.0, 20.0):
        C = operating_damping(rotor, operating_point(rotor, control, wind), pole=FIRST).damping
        along = C[np.ix_([0, 4, 5], [0, 4, 5])]
        assert np.linalg.eigvalsh(along + along.T)[0] > 0.0
