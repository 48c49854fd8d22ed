"""Numbered poles: gradients against differences, warm starts against cold ones."""

import numpy as np
import pytest
from tests.support.law_rows import law_rows

from jackettwin.response.condensation.condensed import Condensed, condense
from jackettwin.response.condensation.numbered_modes import NumberedModes, Points, Status, numbered_poles
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Law, Prony, Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.soil.support import Spring, on_translations
from jackettwin.structure import Rayleigh

RAYLEIGH = Rayleigh.minimum(0.01, 0.1832)
MODES = (1, 2, 4)
LAWS: dict[str, Law] = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
    "springpot": Springpot(3e9, 0.06, 1.15),
}


@pytest.fixture(scope="module")
def condensed(jacket15) -> Condensed:
    """Feet and a nacelle dashpot: two groups."""
    nacelle = Spring("tower_top", np.diag([0.0, 1.0, 0, 0, 0, 0]), Prony(c=1e4))
    support = on_translations(jacket15.structure, kelvin_voigt(1e9, 1e8))
    system = build_system(jacket15, support, rayleigh=RAYLEIGH, dashpots=(nacelle,))
    return condense(system, below_hz=0.95)


def every_number(law: Law) -> Points:
    """Return one set with the logarithm of every number F depends on as a parameter of its own."""
    rows = law_rows([law, Prony(c=1e4)])[None]
    flat = np.concatenate([rows.ravel(), [RAYLEIGH.alpha, RAYLEIGH.beta]])
    jacobian = np.diag(flat)[:, flat != 0.0]
    n_rows = rows.size
    return Points(
        rows,
        np.array([[RAYLEIGH.alpha, RAYLEIGH.beta]]),
        jacobian[:n_rows].reshape(*rows.shape, -1),
        jacobian[n_rows:][None],
    )


def moved(points: Points, z: int, step: float) -> Points:
    return Points(
        points.rows + step * points.jacobian[..., z],
        points.rayleigh + step * points.rayleigh_jacobian[..., z],
        points.jacobian[..., :0],
        points.rayleigh_jacobian[..., :0],
    )


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_slopes_of_poles_and_shapes_are_differences(condensed: Condensed, law: Law) -> None:
    points = every_number(law)
    here = numbered_poles(condensed, points, MODES, shape_slopes=True)
    h = 1e-3
    for z in range(points.jacobian.shape[-1]):
        around = [
            numbered_poles(condensed, moved(points, z, n * h), MODES, near=here) for n in (1, -1, 2, -2)
        ]
        up, down, up2, down2 = (found.poles[0] for found in around)
        difference = (8.0 * (up - down) - (up2 - down2)) / (12.0 * h)
        # fourth order: h⁴ against the curvature, and rounding 1e-13/h
        np.testing.assert_allclose(here.slopes[0, :, z], difference, rtol=1e-6, atol=1e-9)
        dx = [unit(found, here) for found in around]
        difference_x = (8.0 * (dx[0] - dx[1]) - (dx[2] - dx[3])) / (12.0 * h)
        np.testing.assert_allclose(here.shape_slopes[0, :, z], difference_x, atol=1e-7)


def unit(found: NumberedModes, here: NumberedModes) -> np.ndarray:
    """Scale shapes so that they differ from those of ``here`` by nothing along them."""
    x, x0 = found.shapes[0], here.shapes[0]
    return x / np.einsum("mi,mi->m", x0.conj(), x)[:, None]


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_warm_start_ends_where_a_cold_one_does(condensed: Condensed, law: Law) -> None:
    points = every_number(law)
    start = numbered_poles(condensed, points, MODES)
    assert (start.status == Status.CERTIFIED).all()
    beside = moved(points, 0, 0.2)
    warm = numbered_poles(condensed, beside, MODES, near=start)
    cold = numbered_poles(condensed, beside, MODES)
    assert (warm.status == Status.NEIGHBOUR).all() and (cold.status == Status.CERTIFIED).all()
    np.testing.assert_allclose(warm.poles, cold.poles, rtol=1e-11)


def test_a_far_neighbour_does_not_mislead(condensed: Condensed) -> None:
    start = numbered_poles(condensed, every_number(kelvin_voigt(1e13, 1e4)), MODES)
    for k in (1e7, 1e8, 1e9):
        far = every_number(kelvin_voigt(k, 1e4))
        warm = numbered_poles(condensed, far, MODES, near=start)
        np.testing.assert_allclose(warm.poles, numbered_poles(condensed, far, MODES).poles, rtol=1e-11)


def test_many_sets_at_once_are_the_sets_one_by_one(condensed: Condensed) -> None:
    laws = [kelvin_voigt(k, 1e8) for k in (1e9, 2e9, 5e9)]
    rows = np.array([law_rows([law, Prony(c=1e4)]) for law in laws])
    many = numbered_poles(condensed, Points.fixed(rows, RAYLEIGH), MODES)
    for k in range(3):
        one = numbered_poles(condensed, Points.fixed(rows[k : k + 1], RAYLEIGH), MODES)
        np.testing.assert_array_equal(many.poles[k], one.poles[0])


def test_undamped_points_have_imaginary_poles(condensed: Condensed) -> None:
    found = numbered_poles(condensed, every_number(LAWS["zener"]).undamped(), MODES)
    assert np.abs(found.poles.real).max() < 1e-9
    assert (found.status == Status.CERTIFIED).all()


def test_a_mode_outside_the_band_is_not_known(condensed: Condensed) -> None:
    found = numbered_poles(condensed, every_number(LAWS["zener"]), (1, 30))
    assert np.isnan(found.poles[0, 1]) and not np.isnan(found.poles[0, 0])
