"""Tubes against closed forms."""

import numpy as np
import pytest

from jackettwin.structure.sections import tube_properties


def test_solid_circle() -> None:
    s = tube_properties(np.array(2.0), np.array(1.0))
    assert (float(s.A), float(s.I), float(s.J)) == pytest.approx((np.pi, np.pi / 4, np.pi / 2))


def test_thin_tube_tends_to_the_ring() -> None:
    """A → πDt, I → πD³t/8 as t/D → 0."""
    D, t = 6.0, 6e-4
    s = tube_properties(np.array(D), np.array(t))
    assert float(s.A) == pytest.approx(np.pi * D * t, rel=2e-4)
    assert float(s.I) == pytest.approx(np.pi * D**3 * t / 8, rel=4e-4)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_shear_coefficient_limits(nu: float) -> None:
    """Solid circle 6(1+ν)²/(7+14ν+8ν²); a thin tube carries shear with half its area, whatever ν."""
    solid = float(tube_properties(np.array(2.0), np.array(1.0), nu).kappa)
    thin = float(tube_properties(np.array(2.0), np.array(1e-7), nu).kappa)
    assert thin == pytest.approx(0.5, rel=1e-6)
    assert solid == pytest.approx(6 * (1 + nu) ** 2 / (7 + 14 * nu + 8 * nu**2), rel=1e-12)
