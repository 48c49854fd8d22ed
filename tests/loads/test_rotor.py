"""Parked rotor against an independent linearisation (tests/data/rotor) and closed forms."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.support.rotor_closed_form import added_damping_ratio, lift_slope, parked_closed_form

from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import in_global_axes, linearise, rotor_loads
from jackettwin.loads.aerodynamics.turbine_files import read_rotor

ROWS = json.loads(
    (Path(__file__).parents[1] / "data/rotor/parked_aero_damping.json").read_text(encoding="utf-8")
)
MODE = {"modal_mass": 1.12e6, "omega": 2.0 * np.pi * 0.183}
FEATHER = 0.5 * np.pi


@pytest.fixture(scope="module")
def rotor():
    return read_rotor("iea15")[0]


def ratios(locked, free, slope: float) -> list[float]:
    """Fore-aft, side-side locked, side-side free [%] of a mode with this slope at the tower top."""
    fore_aft = np.array([1.0, 0.0, 0.0, 0.0, slope, 0.0])
    side_side = np.array([0.0, 1.0, 0.0, -slope, 0.0, 0.0])
    return [
        100.0 * added_damping_ratio(C, shape, **MODE)
        for C, shape in ((locked, fore_aft), (locked, side_side), (free, side_side))
    ]


@pytest.mark.parametrize("pitch_deg", [90.0, 86.0, 82.0])
def test_parked_damping_of_the_full_geometry(rotor, pitch_deg: float) -> None:
    """Every row of the table within 2 %."""
    rows = [row for row in ROWS if row.get("pitch") == pitch_deg]
    assert len(rows) == 20
    for V in sorted({row["V"] for row in rows}):
        locked, free = (
            linearise(rotor, V, pitch=np.radians(pitch_deg), shaft=shaft).damping
            for shaft in ("locked", "free")
        )
        for row in (row for row in rows if row["V"] == V):
            wanted = [row["FA_parked"], row["SS_parked_locked"], row["SS_parked_free"]]
            np.testing.assert_allclose(ratios(locked, free, row["slope"]), wanted, rtol=0.02)


@pytest.mark.parametrize("yaw_deg", [-30, -15, -8, 0, 8, 15, 30, 60, 90])
def test_yawed_rotor(rotor, yaw_deg: int) -> None:
    """At ±30° the sections stall, and damping hangs on how polars are blended: 0.07 points of ζ there."""
    row = next(row for row in ROWS if row.get("yaw") == yaw_deg)
    locked, free = (
        linearise(rotor, 20.0, pitch=FEATHER, shaft=shaft, yaw_error=np.radians(yaw_deg)).damping
        for shaft in ("locked", "free")
    )
    got = ratios(locked, free, 0.012)
    tolerance = {"atol": 0.07} if abs(yaw_deg) == 30 else {"rtol": 0.02, "atol": 0.01}
    np.testing.assert_allclose(got, [row["FA"], row["SS_locked"], row["SS_free"]], **tolerance)
    if abs(yaw_deg) == 30:
        assert got[0] < 0.0  # stall makes fore-aft damping negative


def test_closed_form_beside_the_full_geometry(rotor) -> None:
    """Locked side-side within 4 % (no tilt, cone, prebend); fore-aft right at slope 0."""
    full = linearise(rotor, 20.0, pitch=FEATHER)
    closed = parked_closed_form(rotor, 20.0)
    got, wanted = (ratios(C, C, 0.012) for C in (closed, full.damping))
    assert got[1] == pytest.approx(wanted[1], rel=0.04)
    assert closed[0, 0] == pytest.approx(full.damping[0, 0], rel=0.03)  # tilt adds a little lift


def test_integrals_of_the_published_blade(rotor) -> None:
    """Independent values at 90°: ∫c 476.5 m², ∫cCd 30.0 m², ∫c(Cl′+Cd) 2941 m², r²-weighted 1.270e7 m⁴."""
    blade = rotor.blade
    alpha = -blade.twist
    cd = blade.coefficients(alpha)[1]
    lift = lift_slope(blade, alpha) + cd
    cw, r = blade.chord * blade.weight, rotor.hub_radius + blade.z
    got = [cw.sum(), cw @ cd, cw @ lift, cw @ (lift * r**2)]
    np.testing.assert_allclose(got, [476.5, 30.0, 2941.0, 1.270e7], rtol=0.005)


def test_openfast_free_decays(rotor) -> None:
    """Side-side decays of the 15 MW monopile in OpenFAST within 4 %, slope 0.0121, by one frequency.

    Free shaft 1.66 % at 15 m/s (modal mass 1.217e6 kg), locked 3.42 % at 15, 5.82 % at 25 (1.269e6 kg).
    The frequency of that monopile is not printed; the three decays agree on 0.174 Hz.
    """
    shape = np.array([0.0, 1.0, 0.0, -0.0121, 0.0, 0.0])
    decays = (("free", 15.0, 1.217e6, 1.66), ("locked", 15.0, 1.269e6, 3.42), ("locked", 25.0, 1.269e6, 5.82))
    per_hz = np.array(
        [
            100.0
            * added_damping_ratio(
                linearise(rotor, V, pitch=FEATHER, shaft=shaft).damping,
                shape,
                modal_mass=mass,
                omega=2.0 * np.pi,
            )
            for shaft, V, mass, _ in decays
        ]
    )
    measured = np.array([ratio for *_, ratio in decays])
    frequency = float(np.exp(np.log(per_hz / measured).mean()))
    assert frequency == pytest.approx(0.174, abs=0.003)  # public value 0.17 to 0.18 Hz
    np.testing.assert_allclose(per_hz / frequency, measured, rtol=0.04)


def test_symmetry_scaling_and_yaw_of_the_nacelle(rotor) -> None:
    one, two = (linearise(rotor, V, pitch=FEATHER).damping for V in (10.0, 20.0))
    np.testing.assert_allclose(two[:3, :3], 2.0 * one[:3, :3], rtol=0.01, atol=50.0)
    turned = in_global_axes(one, FEATHER)
    assert turned[1, 1] == pytest.approx(one[0, 0])
    assert np.trace(turned) == pytest.approx(np.trace(one))


def test_loads_follow_the_wind_over_the_rotor(rotor) -> None:
    """A uniform wind at every element is the uniform wind; a rotor moving with the wind feels nothing."""
    wind = np.array([12.0, 1.0, -0.5])
    spread = np.broadcast_to(wind, (2, 3, rotor.blade.z.size, 3))
    whole = rotor_loads(rotor, wind, pitch=1.3, azimuth=0.4)
    np.testing.assert_allclose(rotor_loads(rotor, spread, pitch=1.3, azimuth=0.4), [whole, whole])
    still = rotor_loads(rotor, wind, pitch=1.3, motion=np.concatenate([wind, np.zeros(3)]))
    np.testing.assert_allclose(still, 0.0, atol=1e-9)


def test_stiffness_is_the_load_of_a_turned_tower_top(rotor) -> None:
    """About the vertical, turning the rotor by ψ is yawing the wind by −ψ and turning the load by ψ."""
    small = 2e-3
    base = linearise(rotor, 20.0, pitch=FEATHER, azimuth=0.3)
    loads = [
        linearise(rotor, 20.0, pitch=FEATHER, azimuth=0.3, yaw_error=-sign * small).load for sign in (1, -1)
    ]
    slope = (loads[0] - loads[1])[:2] / (2 * small) + [-base.load[1], base.load[0]]
    np.testing.assert_allclose(-base.stiffness[:2, 5], slope, rtol=0.02, atol=1e3)


def test_bad_rotors_are_refused(rotor, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="locked, free"):
        rotor_loads(rotor, np.array([10.0, 0.0, 0.0]), pitch=0.0, shaft="loose")
    with pytest.raises(InputError, match="no such rotor .*did you mean 'iea15'"):
        read_rotor("iea99")
    (tmp_path / "empty.yaml").write_text("name: nothing\n")
    with pytest.raises(InputError, match="components"):
        read_rotor(tmp_path / "empty.yaml")
