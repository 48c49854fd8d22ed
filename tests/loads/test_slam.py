"""Slam and impact: the formulas' own limits, von Kármán's and Wagner's bounds, one by hand."""

from math import pi

import pytest

from jackettwin.errors import InputError
from jackettwin.loads import breaking_impact, slam_coefficient, slam_per_length


def test_first_contact_lies_between_von_karman_and_wagner() -> None:
    """Von Kármán (1929) π, Wagner (1932) 2π: measured slam (Campbell & Weynberg 1980) lies between them."""
    assert pi < slam_coefficient(0.0, 2.0) < 2.0 * pi


def test_a_covered_cylinder_feels_little_more_than_drag() -> None:
    """At s = D: 5.15 (1/20 + 0.107) = 0.8086 by hand."""
    assert slam_coefficient(0.7, 0.7) == pytest.approx(5.15 * 0.157)


def test_the_coefficient_knows_only_the_share_that_is_wet() -> None:
    assert slam_coefficient(0.1, 0.5) == pytest.approx(slam_coefficient(0.4, 2.0))
    assert slam_coefficient(0.01, 1.0) < slam_coefficient(0.0, 1.0)


def test_forces_by_hand() -> None:
    """½·1025·5.15·0.8·3² = 19 003.5 N/m; 2π·0.46·7·1025·3·14² = 12.194 MN."""
    assert slam_per_length(3.0, 0.8, density_kg_m3=1025.0) == pytest.approx(19003.5)
    force = breaking_impact(7.0, 14.0, 6.0, density_kg_m3=1025.0)
    assert force == pytest.approx(12.194e6, rel=1e-4)
    assert breaking_impact(7.0, 28.0, 6.0, density_kg_m3=1025.0) == pytest.approx(4.0 * force)


@pytest.mark.parametrize(("s", "D"), [(-0.1, 1.0), (1.1, 1.0), (0.0, 0.0)])
def test_cylinders_above_and_below_the_surface_are_refused(s: float, D: float) -> None:
    with pytest.raises(InputError, match="out of range"):
        slam_coefficient(s, D)
