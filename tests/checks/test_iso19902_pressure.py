"""ISO 19902 13.2.6 and 13.4: hand calculations, limits, and continuity where the standard's branches meet."""

import numpy as np
import pytest

from jackettwin.checks.iso19902 import Stress, Tube, strength
from jackettwin.checks.iso19902_pressure import column_strength, hoop_strength, pressure_use

MPA = 1e6


def tube(D: float, t: float, KL: float, f_y: float = 355.0) -> Tube:
    return Tube(*(np.array(v) for v in (D, t, 210e9, f_y * MPA, KL)))


def stress(axial: float, bending: float = 0.0) -> Stress:
    return Stress(*(np.array(v * MPA) for v in (axial, bending, 0.0, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("D", "t", "L", "f_he", "f_h"),
    [
        # D/t 50, μ 200 ≥ 80: C_h 0.44/50 = 0.0088; f_he = 2·0.0088·210e3/50; below 0.55 f_y: f_h = f_he
        (1.0, 0.02, 20.0, 73.92, 73.92),
        # D/t 40, μ 5·√80 = 44.72, between 33 and 64: C_h 0.011 + 0.21·64000/44.72⁴ = 0.0143600
        (1.0, 0.025, 5.0, 150.78, 150.78),
        # D/t 40, μ 2·√80 = 17.889 < 33: C_h 0.737/17.310 = 0.042577; ratio 1.2593: 0.7·1.2593^0.4 = 0.76763
        (1.0, 0.025, 2.0, 447.05, 272.51),
        # D/t 20, μ 0.1·√40 = 0.632: C_h 0.8; 16800 MPa: yields
        (1.0, 0.05, 0.1, 16800.0, 355.0),
    ],
)
def test_hoop_buckling_by_hand(D: float, t: float, L: float, f_he: float, f_h: float) -> None:
    found = hoop_strength(tube(D, t, 20.0), np.array(L))
    assert float(found.f_he) / MPA == pytest.approx(f_he, rel=2e-4)
    assert float(found.f_h) / MPA == pytest.approx(f_h, rel=2e-4)


def test_a_long_tube_buckles_as_a_ring_does() -> None:
    """Long tubes: 0.88 E (t/D)² is 0.8 of Bresse's ring in plane strain, E (t/D)²/(1 − ν²)."""
    one = tube(1.0, 0.01, 20.0)
    ring = float(one.E) * 0.01**2 / (1.0 - 0.3**2)
    assert float(hoop_strength(one, np.array(50.0)).f_he) / ring == pytest.approx(0.8, rel=2e-3)


def test_the_branches_meet() -> None:
    """C_h at μ = 1.5 and 0.825 D/t, f_h at 2.44 and 0.55 f_y; a step of 7 % at 1.6 D/t is the standard's."""
    slender, root = 60.0, np.sqrt(120.0)
    for mu, rel in ((1.5, 1e-3), (0.825 * slender, 0.015)):
        low, high = (
            hoop_strength(tube(1.0, 1.0 / slender, 9.0), np.array(mu * s / root)) for s in (0.9999, 1.0001)
        )
        assert float(low.f_he / high.f_he) == pytest.approx(1.0, rel=rel)
    for ratio in (2.44, 0.55):
        f_he = float(hoop_strength(tube(1.0, 0.02, 9.0), np.array(3.0)).f_he) / MPA
        low, high = (
            hoop_strength(tube(1.0, 0.02, 9.0, f_he / ratio * s), np.array(3.0)) for s in (0.9999, 1.0001)
        )
        # rounding of the standard's own constants: 0.7·0.55^0.4 = 0.5511
        assert float(low.f_h / high.f_h) == pytest.approx(1.0, rel=3e-3)


def test_columns_under_pressure_meet_euler() -> None:
    """(13.4-15) and (13.4-16) meet at λ = 1.34/√(1 − 2q); without pressure it is 13.2.3.

    The standard's constants of two and three digits leave steps of up to 0.3 % of f_yc.
    """
    D, t = 1.0, 0.02
    base = tube(D, t, 20.0)
    s = strength(base)
    assert float(column_strength(base, s, np.array(0.0))) == pytest.approx(float(s.f_c), rel=1e-12)
    r = 0.25 * np.sqrt(D**2 + (D - 2 * t) ** 2)
    for q in (0.05, 0.2, 0.35):
        edge = 1.34 / np.sqrt(1.0 - 2.0 * q) * np.pi * r / np.sqrt(355e6 / 210e9)
        low, high = (float(column_strength(tube(D, t, edge * k), s, q * s.f_yc)) for k in (0.9999, 1.0001))
        assert low == pytest.approx(high, abs=0.003 * float(s.f_yc))


def test_interaction_by_hand() -> None:
    """1 MPa on D/t 40, L_r 2 m: σ_h 20, σ_q 10 MPa; B = 25/272.51 = 0.091740, η = 1.92946.

    r = √(1 + 0.09 B² − B^3.8589) − 0.3 B = 0.97281; f_b and f_yc = f_y from 13.2.
    """
    one = tube(1.0, 0.025, 10.0)
    s, h = strength(one), hoop_strength(one, np.array(2.0))
    r = 0.97281
    u = pressure_use(one, s, h, stress(100.0, 50.0), np.array(1e6))
    assert float(u.hoop) == pytest.approx(0.091740, rel=2e-4)
    bent = 1.05 * 50.0 / (float(s.f_b) / MPA * r)
    assert float(u.section) == pytest.approx(1.05 * 90.0 / (355.0 * r) + bent, rel=2e-4)
    assert float(u.stability) == 0.0
    # tension less than the capped end's compression is compression
    u = pressure_use(one, s, h, stress(4.0, 50.0), np.array(1e6))
    assert float(u.section) == pytest.approx(1.18 * 6.0 / 355.0 + bent, rel=2e-4)
    u = pressure_use(one, s, h, stress(-100.0, 50.0), np.array(1e6))
    assert float(u.section) == pytest.approx(1.18 * 110.0 / 355.0 + bent, rel=2e-4)
    f_ch = float(column_strength(one, s, np.array(10e6))) / MPA
    amplified = bent / (1.0 - 100.0 / (float(s.f_e) / MPA))
    assert float(u.stability) == pytest.approx(1.18 * 100.0 / f_ch + amplified, rel=2e-4)


def test_local_buckling_by_hand() -> None:
    """(13.4-21), D/t 100, long: f_he 18.48, f_xe 1260 MPa; σ_h 5, σ_q 2.5; σ_x = 20 + 10 + 2.5 MPa."""
    one = tube(1.0, 0.01, 5.0)
    s, h = strength(one), hoop_strength(one, np.array(50.0))
    u = pressure_use(one, s, h, stress(-10.0, 20.0), np.array(0.1e6))
    half = 0.5 * 18.48 / 1.25
    wanted = (32.5 - half) / (1260.0 / 1.18 - half) + (1.25 * 5.0 / 18.48) ** 2
    assert float(u.local) == pytest.approx(wanted, rel=1e-4)
    # below half the hoop strength it does not matter
    assert float(pressure_use(one, s, h, stress(-1.0, 1.0), np.array(0.1e6)).local) == 0.0


def test_without_pressure_nothing_is_checked_and_with_it_nothing_gets_better() -> None:
    one = tube(1.0, 0.02, 20.0)
    s, h = strength(one), hoop_strength(one, np.array(20.0))
    calm = pressure_use(one, s, h, stress(-50.0, 20.0), np.array(0.0))
    assert all(float(v) == 0.0 for v in calm)
    rising = [pressure_use(one, s, h, stress(-50.0, 20.0), np.array(p)) for p in (1e4, 5e5, 1e6, 2e6)]
    for name in ("hoop", "section", "stability"):
        values = [float(getattr(u, name)) for u in rising]
        assert values == sorted(values)
