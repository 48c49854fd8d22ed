"""Stress concentration: hand values, limits, and the eight points."""

import json
from math import atan, exp, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.fatigue import BraceTube, ConcentrationFactors, TubularJoint, concentration, hot_spot_matrix
from jackettwin.fatigue.efthymiou import JointClass, read_joint


def joint(*angles_deg: float, d: float = 0.6, t: float = 0.02, L: float = 9.0, **kw: float) -> TubularJoint:
    """Return braces on a chord of 1.2 m × 40 mm: β 0.5, γ 15, τ 0.5, α 15."""
    return TubularJoint(1.2, 0.04, L, tuple(BraceTube(d, t, radians(a)) for a in angles_deg), **kw)


def test_a_y_joint_by_hand() -> None:
    """β = 0.5, γ = 15, τ = 0.5, α = 15, θ = 45°, C = 0.7: C1 0.4, C2 0.35, C3 0.14."""
    (f,), warnings = concentration(joint(45.0), "y")
    assert warnings == ()
    s = sin(radians(45.0))
    hand = ConcentrationFactors(
        15 * 0.5**1.1 * (1.11 - 3 * 0.02**2) * s**1.6 + 0.4 * (0.8 * 15 - 6) * 0.5 * 0.25 * sqrt(0.75),
        15**0.2 * 0.5 * (2.65 + 5 * 0.15**2) + 0.5 * 0.5 * (0.35 * 15 - 3) * s,
        1.3 + 15 * 0.5**0.52 * 15**0.1 * (0.187 - 1.25 * 0.5**1.1 * (0.5 - 0.96)) * s**2.55,
        3 + 15**1.2 * (0.12 * exp(-2) + 0.011 * 0.25 - 0.045) + 0.5 * 0.5 * (0.14 * 15 - 1.2),
        1.45 * 0.5 * 0.5**0.85 * 15 ** (1 - 0.34) * s**0.7,
        1 + 0.65 * 0.5 * 0.5**0.4 * 15 ** (1.09 - 0.385) * s ** (0.9 - 1.16),
        15 * 0.5 * 0.5 * (1.7 - 1.05 * 0.125) * s**1.6,
        0.5**-0.54 * 15**-0.05 * (0.99 - 0.235 + 0.005) * 15 * 0.25 * (1.7 - 1.05 * 0.125) * s**1.6,
    )
    np.testing.assert_allclose(f, hand, rtol=1e-12)


def test_an_x_joint_by_hand() -> None:
    (f,), _ = concentration(joint(90.0), "x")
    out = 15 * 0.25 * (1.56 - 1.34 * 0.0625)
    hand = (
        3.87 * 15 * 0.25 * (1.10 - 0.5**1.8),
        15**0.2 * 0.5 * (2.65 + 5 * 0.15**2) - 3 * 0.25,
        1 + 1.9 * 15 * sqrt(0.5) * 0.5**0.9 * (1.09 - 0.5**1.7),
        3 + 15**1.2 * (0.12 * exp(-2) + 0.011 * 0.25 - 0.045),
        out,
        0.5**-0.54 * 15**-0.05 * (0.99 - 0.235 + 0.005) * out,
    )
    np.testing.assert_allclose([*f[:4], *f[6:]], hand, rtol=1e-12)


def test_a_kt_joint_by_hand() -> None:
    """Three braces of 0.6, 0.48 and 0.6 m at 45°, 90° and 45°, gaps of 0.12 and 0.06 m: ζ 0.1 and 0.05."""
    braces = tuple(BraceTube(d, 0.02, radians(a)) for d, a in ((0.6, 45.0), (0.48, 90.0), (0.6, 45.0)))
    found, warnings = concentration(TubularJoint(1.2, 0.04, 9.0, braces, gaps_m=(0.12, 0.06)), "kt")
    assert warnings == ()
    s, A, B = sin(radians(45.0)), 0.5, 0.4
    ratio = (1.0 / s) ** 0.3 * 1.25**0.3
    outer = 0.5**0.9 * sqrt(15) * (0.67 - A**2 + 1.16 * A) * s * ratio
    outer *= 1.64 + 0.29 * A**-0.38 * atan(8.0 * (0.1 + 0.05 + B))
    inner = 0.5**0.9 * sqrt(15) * (0.67 - B**2 + 1.16 * B) * ratio * (1.64 + 0.29 * B**-0.38 * atan(0.8))
    assert found[0].axial_chord_crown == found[2].axial_chord_saddle == pytest.approx(outer, rel=1e-12)
    assert found[1].axial_chord_crown == pytest.approx(inner, rel=1e-12)
    assert found[1].axial_brace_crown == pytest.approx(1 + inner * (1.97 - 1.57 * B**0.25) * 0.5**-0.14)
    T_A = 15 * 0.5 * A * (1.7 - 1.05 * A**3) * s**1.6
    T_B = 15 * 0.5 * B * (1.7 - 1.05 * B**3)

    def less(beta: float, x: float) -> float:
        return 1.0 - 0.08 * sqrt(beta * 15) * exp(-0.8 * x)

    def carried(beta: float, x: float) -> float:
        return less(beta, x) * 2.05 * sqrt(0.5) * exp(-1.3 * x)

    x_AB, x_AC = 1 + 0.1 * s / A, 1 + 0.55 * s / A
    first = T_A * less(B, x_AB) * less(A, x_AC) + T_B * carried(A, x_AB) + T_A * carried(A, x_AC)
    assert found[0].out_of_plane_chord == pytest.approx(first, rel=1e-12)
    x_1, x_2, power = 1 + 0.1 / B, 1 + 0.05 / B, (A / B) ** 2
    middle = T_B * less(A, x_1) ** power * less(A, x_2) ** power
    middle += T_A * (carried(B, x_1) + carried(B, x_2))
    assert found[1].out_of_plane_chord == pytest.approx(middle, rel=1e-12)
    with pytest.raises(InputError, match="three braces and two gaps"):
        concentration(TubularJoint(1.2, 0.04, 9.0, braces, gap_m=0.1), "kt")


def test_a_k_joint_by_hand() -> None:
    """Braces of 0.6 and 0.48 m at 45° and 60°, gap 0.12 m: ζ = 0.1."""
    braces = (BraceTube(0.6, 0.02, radians(45.0)), BraceTube(0.48, 0.02, radians(60.0)))
    (a, b), warnings = concentration(TubularJoint(1.2, 0.04, 9.0, braces, gap_m=0.12), "k")
    assert warnings == ()
    s, r = sin(radians(45.0)), sin(radians(60.0))
    K1 = 0.5**0.9 * sqrt(15) * (0.67 - 0.25 + 0.58) * s * (r / s) ** 0.3 * 1.25**0.3
    K1 *= 1.64 + 0.29 * 0.5**-0.38 * atan(0.8)
    assert a.axial_chord_crown == a.axial_chord_saddle == pytest.approx(K1, rel=1e-12)
    brace = 1 + K1 * (1.97 - 1.57 * 0.5**0.25) * 0.5**-0.14 * s**0.7
    assert a.axial_brace_saddle == pytest.approx(brace, rel=1e-12)
    T_a, T_b = (15 * 0.5 * w * (1.7 - 1.05 * w**3) * q**1.6 for w, q in ((0.5, s), (0.4, r)))
    x = 1 + 0.1 * s / 0.5
    out = T_a * (1 - 0.08 * sqrt(0.4 * 15) * exp(-0.8 * x))
    out += T_b * (1 - 0.08 * sqrt(0.5 * 15) * exp(-0.8 * x)) * 2.05 * sqrt(0.5) * exp(-1.3 * x)
    assert a.out_of_plane_chord == pytest.approx(out, rel=1e-12)
    assert b.axial_chord_crown != pytest.approx(a.axial_chord_crown, rel=1e-3)


def test_a_k_joint_of_equal_braces_is_the_same_from_both() -> None:
    (a, b), _ = concentration(joint(45.0, 45.0, gap_m=0.1), "k")
    np.testing.assert_allclose(a, b, rtol=1e-12)


def test_angles_above_90_are_mirrored() -> None:
    (obtuse,), (acute,) = (concentration(joint(angle), "y")[0] for angle in (120.0, 60.0))
    np.testing.assert_allclose(obtuse, acute, rtol=1e-12)


def test_short_chords_have_smaller_saddles_only() -> None:
    """α = 10: F2 of general fixity on axial saddles, F3 on bending out of plane; crowns have no factor."""
    (short,), _ = concentration(joint(90.0, L=6.0), "x")
    (long,), _ = concentration(joint(90.0, L=7.2), "x")  # α = 12: no correction; X has no α of its own
    F2 = 1 - (1.43 * 0.5 - 0.97 * 0.25 - 0.03) * 15**0.04 * exp(-0.71 * 15**-1.38 * 10**2.5)
    F3 = 1 - 0.55 * 0.5**1.8 * 15**0.16 * exp(-0.49 * 15**-0.89 * 10**1.8)
    assert short.axial_chord_saddle / long.axial_chord_saddle == pytest.approx(F2, rel=1e-12)
    assert short.out_of_plane_chord / long.out_of_plane_chord == pytest.approx(F3, rel=1e-12)
    assert short.axial_chord_crown == pytest.approx(long.axial_chord_crown, rel=1e-12)
    assert F2 < 1.0 and F3 < 1.0


def test_beyond_the_ranges_the_larger_factor_is_taken_and_said() -> None:
    """γ = 40: the recommended practice asks for the larger of γ = 40 and γ = 32."""
    thin = TubularJoint(1.2, 0.015, 9.0, (BraceTube(0.6, 0.0075, radians(60.0)),))
    at_limit = TubularJoint(1.2, 1.2 / 64.0, 9.0, (BraceTube(0.6, 0.6 / 64.0, radians(60.0)),))
    (beyond,), warnings = concentration(thin, "y")
    (limit,), none = concentration(at_limit, "y")
    assert none == () and len(warnings) == 1 and "γ = 40 is not 8 to 32" in warnings[0].text
    assert all(a >= b * (1 - 1e-12) for a, b in zip(beyond, limit, strict=True))


@pytest.mark.parametrize("kind", ["y", "x"])
def test_a_longer_chord_than_any_tested_is_on_the_safe_side_a_shorter_one_is_not(kind: JointClass) -> None:
    """α = 50 beyond 40: no factor is below that at α = 40; at α = 3 the ends stiffen more than was tested."""
    (longer,), (long,) = concentration(joint(45.0, L=30.0), kind)
    (limit,), none = concentration(joint(45.0, L=24.0), kind)
    assert long.safe and "α = 50" in long.text and none == ()
    assert all(a >= b for a, b in zip(longer, limit, strict=True))
    _, (short,) = concentration(joint(45.0, L=1.8), kind)
    assert not short.safe and "α = 3 is not 4 to 40" in short.text


def test_the_eight_points_are_the_sums_of_the_practice() -> None:
    """Figure 3-6 of DNV-RP-C203: with axial, in-plane and out-of-plane factors 2 (crown 3), 5 and 7."""
    f = ConcentrationFactors(2.0, 3.0, 12.0, 13.0, 5.0, 15.0, 7.0, 17.0)
    x, my, mz = 1.1, 0.7, -0.4
    chord = hot_spot_matrix(f)[0] @ [x, my, mz]
    h = 0.5 * sqrt(2.0)
    hand = [
        3 * x + 5 * my,
        0.5 * 5 * x + h * 5 * my - h * 7 * mz,
        2 * x - 7 * mz,
        0.5 * 5 * x - h * 5 * my - h * 7 * mz,
        3 * x - 5 * my,
        0.5 * 5 * x - h * 5 * my + h * 7 * mz,
        2 * x + 7 * mz,
        0.5 * 5 * x + h * 5 * my + h * 7 * mz,
    ]
    np.testing.assert_allclose(chord, hand, rtol=1e-12)
    brace = hot_spot_matrix(f)[1] @ [x, my, mz]
    assert brace[0] == pytest.approx(13 * x + 15 * my) and brace[2] == pytest.approx(12 * x - 17 * mz)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"class": "z"}, "class"),
        ({"chord_thickness_m": -0.04}, "chord_thickness_m"),
        ({"chord_thickness_m": 40.0}, "chord_thickness_m"),
        ({"braces": [{"diameter_m": 0.6, "thickness_m": 0.02, "angle_deg": 200.0}]}, "angle_deg"),
        ({"braces": []}, "braces"),
        ({"class": "k"}, "gap_m"),
        ({"walls": 1}, "walls"),
    ],
)
def test_what_no_joint_is_is_refused_by_field(change: dict, match: str, tmp_path: Path) -> None:
    brace = {"diameter_m": 0.6, "thickness_m": 0.02, "angle_deg": 45.0}
    said = {"class": "y", "chord_diameter_m": 1.2, "chord_thickness_m": 0.04, "chord_length_m": 9.0}
    path = tmp_path / "joint.json"
    path.write_text(json.dumps(said | {"braces": [brace]} | change))
    with pytest.raises(InputError, match=match):
        kind, read = read_joint(path)
        concentration(read, kind)


def test_every_factor_of_a_common_joint_is_positive(rng: np.random.Generator) -> None:
    for _ in range(200):
        D = 1.0
        T = D / (2.0 * rng.uniform(8.0, 32.0))
        brace = BraceTube(
            rng.uniform(0.2, 1.0) * D, rng.uniform(0.2, 1.0) * T, rng.uniform(radians(20.0), pi / 2)
        )
        shape = TubularJoint(D, T, rng.uniform(2.0, 20.0), (brace, brace), gap_m=rng.uniform(0.0, 1.0))
        for kind in ("y", "x", "k"):
            factors, warnings = concentration(shape, kind)
            assert warnings == () and min(min(one[4:]) for one in factors) > 0.0
