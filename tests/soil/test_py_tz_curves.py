"""Reaction curves against API RP 2GEO / RP 2A values computed independently (tests/data/soil)."""

import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.ground import py_curves, tz_curves
from jackettwin.soil.ground.curves import CubeRoot, TabulatedCurve, Tanh, force_and_tangent, secant_stiffness
from jackettwin.soil.ground.profile import Clay, Layer, Sand, Scour, SoilProfile, ground_at

CASES = {
    case["id"]: case
    for case in json.loads(
        (Path(__file__).parents[1] / "data" / "soil" / "soil_values.json").read_text(encoding="utf-8")
    )["cases"]
}
CLOSED_FORM = 1e-9  # the same formulas in another program: rounding only
KILO = 1e3


@pytest.mark.parametrize("name", ["PY_SAND_1", "PY_SAND_2"])
def test_sand_py(name: str) -> None:
    case = CASES[name]
    given = case["inputs"]
    z, D = given["z_m"], given["D_m"]
    phi = given["phi_deg"]
    np.testing.assert_allclose(
        py_curves.sand_coefficients(phi), [case["C1"], case["C2"], case["C3"]], rtol=CLOSED_FORM
    )
    curve = py_curves.sand_py(friction_angle_deg=phi, stress_pa=given["gamma_eff_kN_m3"] * z * KILO, z=z, D=D)
    assert curve.capacity == pytest.approx(case["A"] * case["pu"] * KILO, rel=CLOSED_FORM)
    assert curve.initial_stiffness == pytest.approx(case["k_init_kN_m2"] * KILO, rel=CLOSED_FORM)
    for y, p in case["p_kN_m"].items():
        assert float(curve.force(float(y))) == pytest.approx(p * KILO, rel=CLOSED_FORM)


@pytest.mark.parametrize("name", ["PY_CLAY_1", "PY_CLAY_3"])
def test_clay_py(name: str) -> None:
    case = CASES[name]
    given = case["inputs"]
    stress = given["gamma_eff_kN_m3"] * given["z_m"] * KILO
    clay = {
        "strength_pa": given["su_kPa"] * KILO,
        "stress_pa": stress,
        "z": given["z_m"],
        "D": given["D_m"],
        "strain_50": given["eps50"],
        "J": given["J"],
    }
    table = py_curves.soft_clay_py(**clay)
    parabola = py_curves.soft_clay_py(**clay, form="cube-root")
    y = np.array(case["y_m"])
    np.testing.assert_allclose(table.force(y), np.multiply(case["p_table_kN_m"], KILO), rtol=CLOSED_FORM)
    np.testing.assert_allclose(
        parabola.force(y), np.multiply(case["p_cuberoot_kN_m"], KILO), rtol=CLOSED_FORM
    )
    for curve in (table, parabola):
        assert curve.initial_stiffness == pytest.approx(case["k_init_0p1y50_kN_m2"] * KILO, rel=CLOSED_FORM)


def test_clay_tz() -> None:
    case = CASES["TZ_CLAY_1"]
    given = case["inputs"]
    f = tz_curves.clay_friction(strength_pa=given["su_kPa"] * KILO, stress_pa=given["sigma_v_eff_kPa"] * KILO)
    assert f == pytest.approx(case["f_kPa"] * KILO, rel=CLOSED_FORM)
    curve = tz_curves.clay_tz(friction_pa=f, D=given["D_m"], residual=given["residual"])
    perimeter = np.pi * given["D_m"]
    np.testing.assert_allclose(
        curve.force(case["z_m"]), np.multiply(case["t_kPa"], KILO * perimeter), rtol=CLOSED_FORM
    )
    assert curve.initial_stiffness == pytest.approx(case["k_init_kN_m_per_m"] * KILO, rel=CLOSED_FORM)


def test_sand_tz_in_both_forms() -> None:
    case = CASES["TZ_SAND_1"]
    given = case["inputs"]
    f = tz_curves.sand_friction(
        stress_pa=given["sigma_v_eff_kPa"] * KILO, beta=given["beta"], limit_pa=case["f_lim_kPa"] * KILO
    )
    assert f == pytest.approx(case["f_kPa"] * KILO, rel=CLOSED_FORM)
    perimeter = np.pi * given["D_m"]
    for form, key in (("rp2a", "2.54mm"), ("rp2geo", "0.3f at 0.16%D")):
        curve = tz_curves.sand_tz(friction_pa=f, D=given["D_m"], form=form)
        assert curve.initial_stiffness == pytest.approx(
            case["k_init_kPa_per_m"][key] * KILO * perimeter, rel=CLOSED_FORM
        )
    with pytest.raises(InputError, match="rp2geo, rp2a"):
        tz_curves.sand_tz(friction_pa=f, D=2.0, form="iso")


def test_clay_tip() -> None:
    case = CASES["QZ_CLAY_1"]
    D = case["inputs"]["D_m"]
    q = tz_curves.clay_bearing(case["inputs"]["su_kPa"] * KILO)
    assert q == pytest.approx(case["q_kPa"] * KILO, rel=CLOSED_FORM)
    curve = tz_curves.tip_qz(bearing_pa=q, D=D, area_m2=0.25 * np.pi * D**2)
    np.testing.assert_allclose(
        curve.force(case["z_m"]) / (0.25 * np.pi * D**2), np.multiply(case["Q_kPa"], KILO), rtol=CLOSED_FORM
    )
    assert curve.initial_stiffness == pytest.approx(case["k_init_tip_kN_m_full_area"] * KILO, rel=CLOSED_FORM)


def test_deep_soft_clay_flows_around_the_pile() -> None:
    """Below z_R the capacity is 9 s_u D whatever the overburden."""
    shallow, deep = (
        py_curves.soft_clay_capacity(strength_pa=30e3, stress_pa=6e3 * z, z=z, D=2.0, J=0.5)
        for z in (2.0, 40.0)
    )
    assert deep == pytest.approx(9.0 * 30e3 * 2.0)
    assert shallow < deep


def test_cyclic_clay_keeps_072_below_the_transition_and_loses_it_above() -> None:
    """API RP 2GEO (2011) table 2: 0.72 beyond 3 y50, and 0.72 z/z_R at 15 y50 above z_R."""
    clay = {"strength_pa": 50e3, "D": 2.0, "strain_50": 0.01, "cyclic": True}
    y50 = 0.05
    deep = py_curves.soft_clay_py(**clay, stress_pa=8e3 * 30, z=30.0)
    assert float(deep.force(20 * y50)) == pytest.approx(0.72 * 9.0 * 50e3 * 2.0)
    z = 4.0
    shallow = py_curves.soft_clay_py(**clay, stress_pa=8e3 * z, z=z)
    z_R = CASES["PY_CLAY_1"]["z_R"]
    assert float(shallow.force(20 * y50)) == pytest.approx(0.72 * 464e3 * z / z_R, rel=CLOSED_FORM)


@pytest.mark.parametrize("cyclic", [False, True])
def test_stiff_clay_is_continuous_brittle_and_never_pulls(cyclic: bool) -> None:
    """Reese 1975: the pieces meet (0.936 A at 0.6 y_p is rounded to three digits) and fall after a peak."""
    D, z, su, e50 = 1.5, 6.0, 150e3, 0.005
    curve = py_curves.stiff_clay_py(strength_pa=su, stress_pa=9e3 * z, z=z, D=D, strain_50=e50, cyclic=cyclic)
    pc = min((2 * su + 9e3 * z) * D + 2.83 * su * z, 11 * su * D)
    p = np.array(curve.p)
    assert p.min() >= 0.0
    assert np.abs(np.diff(p)).max() < 0.02 * pc  # 400 steps: a jump would be larger
    A = 0.2 + (0.1 * np.tanh(1.5 * z / D) if cyclic else 0.4 * np.tanh(0.62 * z / D))
    if cyclic:
        assert p.max() == pytest.approx(A * pc, rel=1e-3)
    else:
        assert float(curve.force(A * e50 * D)) == pytest.approx(0.5 * np.sqrt(A) * pc, rel=1e-3)
        assert p[-1] / pc == pytest.approx(0.5 * np.sqrt(6 * A) - 0.411 - 0.75 * A, rel=1e-6)
    assert p[-1] < 0.7 * p.max()


def test_stiff_clay_takes_its_mean_strength_near_the_bed_and_its_own_deep_down() -> None:
    """Reese 1975: (2 s_a + σ'_v) D + 2.83 s_a z against 11 s_u D; strength grows from 50 to 250 kPa."""
    D, e50 = 2.0, 0.005
    for z, su, mean, deep in ((3.0, 80e3, 65e3, False), (60.0, 250e3, 150e3, True)):
        curve = py_curves.stiff_clay_py(
            strength_pa=su, stress_pa=9e3 * z, z=z, D=D, strain_50=e50, mean_strength_pa=mean
        )
        pc = min((2 * mean + 9e3 * z) * D + 2.83 * mean * z, 11 * su * D)
        A = 0.2 + 0.4 * np.tanh(0.62 * z / D)
        assert (pc == 11 * su * D) == deep
        assert float(curve.force(A * e50 * D)) == pytest.approx(0.5 * np.sqrt(A) * pc, rel=1e-3)


def test_stiff_clay_without_free_water() -> None:
    """Welch & Reese 1972: half pu at y50, pu at 16 y50 and beyond; 100 cycles add 19.2 (p/pu)⁴ y50."""
    D, z, su, e50 = 1.2, 5.0, 100e3, 0.005
    clay = {"strength_pa": su, "stress_pa": 18e3 * z, "z": z, "D": D, "strain_50": e50}
    pu, y50 = (3 * su + 18e3 * z) * D + 0.5 * su * z, 2.5 * e50 * D
    still = py_curves.dry_stiff_clay_py(**clay)
    # straight lines between points 4 % apart
    np.testing.assert_allclose(still.force(np.array([1.0, 16.0, 40.0]) * y50), [pu / 2, pu, pu], rtol=1e-4)
    assert still.initial_stiffness == pytest.approx(0.5 * 0.1**0.25 * pu / (0.1 * y50))
    cycled = py_curves.dry_stiff_clay_py(**clay, cycles=100.0)
    assert float(cycled.force((1.0 + 9.6 * 2.0 / 16.0) * y50)) == pytest.approx(pu / 2, rel=1e-3)
    deep = py_curves.dry_stiff_clay_py(**{**clay, "z": 40.0, "stress_pa": 720e3})
    assert float(deep.force(1.0)) == pytest.approx(9.0 * su * D)


def test_mean_strength_counts_the_clay_above_without_what_is_scoured() -> None:
    """5 m of 20 to 40 kPa, 5 m of sand, then 60 kPa growing to 100 kPa in 10 m and staying."""
    layers = (
        Layer(5.0, 8e3, clay=Clay((20e3, 40e3))),
        Layer(5.0, 10e3, Sand(35.0)),
        Layer(10.0, 9e3, clay=Clay((60e3, 100e3), stiff=True)),
    )
    point = ground_at(SoilProfile(layers), 15.0, 2, diameter=2.0)
    assert point is not None
    assert (point.strength_pa, point.mean_strength_pa) == pytest.approx((80e3, (30e3 * 5 + 70e3 * 5) / 10))
    below = ground_at(SoilProfile(layers), 25.0, 2, diameter=2.0)
    assert below is not None
    assert (below.strength_pa, below.mean_strength_pa) == pytest.approx(
        (100e3, (30e3 * 5 + 80e3 * 10 + 100e3 * 5) / 20)
    )
    scoured = ground_at(SoilProfile(layers, Scour(general_m=2.5)), 4.5, 0, diameter=2.0)
    assert scoured is not None
    assert scoured.mean_strength_pa == pytest.approx(0.5 * (30e3 + 38e3))


def test_local_scour_leaves_the_capacity_of_a_linear_recovery() -> None:
    """σ'_v = γ'(S + 6 D) d/(6 D) below a hole S deep, API's wedge on it; γ'(S + d) from 6 D on.

    A third of a diameter down, S = 1.3 D: the square that was taken here before is 4.5 times less.
    """
    D, S, gamma = 2.0, 2.6, 10e3
    profile = SoilProfile((Layer(50.0, gamma, Sand(35.0)),), Scour(local_m=S))
    C1, C2, C3 = py_curves.sand_coefficients(35.0)
    for d in (0.1 * D, D / 3.0, 2.0 * D, 6.0 * D, 9.0 * D):
        stress = gamma * (S + 6.0 * D) * d / (6.0 * D) if d < 6.0 * D else gamma * (S + d)
        point = ground_at(profile, S + d, 0, diameter=D)
        assert point is not None
        curve = py_curves.sand_py(friction_angle_deg=35.0, stress_pa=point.stress_pa, z=point.depth_m, D=D)
        wanted = max(3.0 - 0.8 * d / D, 0.9) * min(C1 * d + C2 * D, C3 * D) * stress
        assert curve.capacity == pytest.approx(wanted)


def test_local_scour_recovers_across_layers() -> None:
    """Straight from the bottom of the hole to what lies over the recovery depth, whatever the layers."""
    layers = (Layer(4.0, 8e3, Sand(30.0)), Layer(50.0, 11e3, Sand(35.0)))
    profile = SoilProfile(layers, Scour(general_m=1.0, local_m=2.0))
    at_recovery = 8e3 * 3.0 + 11e3 * (3.0 + 6.0 - 4.0)
    for d in (0.0, 0.5, 3.0, 6.0):
        point = ground_at(profile, 3.0 + d, 0 if d < 1.0 else 1, diameter=1.0)
        assert point is not None
        assert point.stress_pa == pytest.approx(at_recovery * d / 6.0)


def test_cyclic_clay_is_reduced_over_two_and_a_half_diameters_at_least() -> None:
    """Soft clay of heavy ground: 6 s_u D/(γ' D + J s_u) is 1.9 D, so z/z_R at 1 D is 1/2.5."""
    D, z, su, gamma = 2.0, 2.0, 10e3, 13.3e3
    zone = 6.0 * su * D / (gamma * D + 0.5 * su)
    assert zone < 2.5 * D
    clay = {"strength_pa": su, "stress_pa": gamma * z, "z": z, "D": D, "strain_50": 0.01}
    curve = py_curves.soft_clay_py(**clay, cyclic=True)
    assert float(curve.force(1.0)) == pytest.approx(0.72 * curve_capacity(clay) * z / (2.5 * D))


def curve_capacity(clay: dict[str, float]) -> float:
    """(3 s_u + σ'_v) D + J s_u z, or 9 s_u D."""
    su, D, z = clay["strength_pa"], clay["D"], clay["z"]
    return min((3.0 * su + clay["stress_pa"]) * D + 0.5 * su * z, 9.0 * su * D)


def test_linearisation_of_a_curve() -> None:
    curve = Tanh(capacity=1e6, initial_stiffness=1e8)
    assert float(secant_stiffness(curve, 0.0)) == 1e8
    assert float(secant_stiffness(curve, 0.02)) == pytest.approx(1e6 * np.tanh(2.0) / 0.02)
    assert force_and_tangent(curve, 0.02)[1] == pytest.approx(1e8 / np.cosh(2.0) ** 2, rel=1e-6)


@pytest.mark.parametrize(
    "curve", [Tanh(1e6, 1e8), TabulatedCurve((0.0, 0.01, 0.02), (0.0, 1e5, 8e4)), CubeRoot(1e6, 0.05, 1e8)]
)
def test_curves_are_odd(curve) -> None:
    y = np.linspace(0.0, 0.1, 11)
    np.testing.assert_array_equal(curve.force(-y), -curve.force(y))
