"""Rayleigh and modal damping: thesis (4.1)–(4.2), corrected."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.structure.damping import Rayleigh, RayleighSchema


def test_minimum_is_at_the_frequency_asked_for() -> None:
    """ζ(ω) = ζ1/2·(ω1/ω + ω/ω1): equal shares of mass and stiffness at ω1, more everywhere else."""
    r = Rayleigh.minimum(0.01, 0.183)
    omega = 2 * np.pi * 0.183
    assert (r.alpha, r.beta) == pytest.approx((0.01 * omega, 0.01 / omega))
    f = np.array([0.05, 0.1, 0.183, 0.5, 0.75])
    np.testing.assert_allclose(r.ratio(f), 0.005 * (0.183 / f + f / 0.183), rtol=1e-12)
    assert r.ratio(0.183) == pytest.approx(0.01, rel=1e-12)


def test_two_points() -> None:
    r = Rayleigh.two_points((0.01, 0.02), (0.18, 0.75))
    np.testing.assert_allclose(r.ratio(np.array([0.18, 0.75])), [0.01, 0.02], rtol=1e-12)


def test_none_is_none() -> None:
    assert Rayleigh().ratio(0.2) == 0.0
    assert Rayleigh.minimum(0.0, 0.2) == Rayleigh()


@pytest.mark.parametrize(
    ("ratio", "f", "message"),
    [
        (-0.01, 0.2, "ratio: damping ratio out of range .got -0.01."),
        (1.0, 0.2, "0 ≤ ratio < 1"),
        (np.nan, 0.2, "damping ratio out of range"),
        (0.01, 0.0, "frequency_hz: frequency must be positive"),
        (0.01, np.nan, "frequency_hz: frequency must be positive"),
        (0.01, np.inf, "frequency_hz: frequency must be positive"),
    ],
)
def test_bad_damping_is_refused(ratio: float, f: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Rayleigh.minimum(ratio, f)


@pytest.mark.parametrize(
    ("zeta", "f", "message"),
    [
        ((0.001, 0.1), (0.18, 0.75), "feed energy in .*0.24 to 4.17"),
        ((0.1, 0.001), (0.18, 0.75), "feed energy in"),
        ((0.01, 0.01), (0.2, 0.2), "two points"),
        ((0.01, float("nan")), (0.2, 0.7), "two points"),
        ((0.01, 0.02), (0.0, 0.7), "two points"),
        ((-0.01, 0.02), (0.2, 0.7), "two points"),
    ],
)
def test_two_points_that_are_no_damping(
    zeta: tuple[float, float], f: tuple[float, float], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Rayleigh.two_points(zeta, f)


def test_two_points_on_the_edge_are_mass_or_stiffness_alone() -> None:
    """ζ ∝ f is stiffness damping alone, ζ ∝ 1/f mass damping alone."""
    assert Rayleigh.two_points((0.01, 0.03), (0.2, 0.6)).alpha == pytest.approx(0.0, abs=1e-15)
    assert Rayleigh.two_points((0.03, 0.01), (0.2, 0.6)).beta == pytest.approx(0.0, abs=1e-15)


def test_a_file_takes_one_point_or_two() -> None:
    two = RayleighSchema(ratio=(0.01, 0.02), frequency_hz=(0.18, 0.75))
    assert two.build() == Rayleigh.two_points((0.01, 0.02), (0.18, 0.75))
    assert two.least == pytest.approx(min(two.build().ratio(np.linspace(0.02, 1.0, 20001))), rel=1e-6)
    assert RayleighSchema(ratio=0.01, frequency_hz=0.2).least == pytest.approx(0.01)
    with pytest.raises(InputError, match="one ratio at one frequency, or two at two"):
        RayleighSchema(ratio=(0.01, 0.02), frequency_hz=0.2).build()
