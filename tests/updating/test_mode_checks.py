"""Shapes and order of measured modes beside the model's: closed forms, chance, and what is planted."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.updating import CheckedShape, order_checks, shape_checks

N, STD = 8, 0.02
HZ = np.array([0.20, 0.205, 0.6, 0.8])


def modes(rng: np.random.Generator) -> np.ndarray:
    """Return four shapes at eight sensors, the first two a close pair."""
    return np.linalg.qr(rng.standard_normal((N, 4)))[0] + 0.0j


def test_the_share_outside_a_plane_is_the_sine_squared(rng: np.random.Generator) -> None:
    """A shape at an angle to the plane of the pair, however it lies within it, and turned in phase."""
    shapes = modes(rng)
    for angle, objects in ((0.05, False), (0.4, True)):
        along = np.cos(angle) * (0.3 * shapes[:, 0] + np.sqrt(1.0 - 0.09) * shapes[:, 1])
        seen = 3.0 * np.exp(0.7j) * (along + np.sin(angle) * shapes[:, 2])
        found = shape_checks([CheckedShape(1, seen, np.zeros(N))], [shapes], HZ, [0.2])[0]
        assert found.outside == pytest.approx(np.sin(angle) ** 2, rel=1e-9)
        assert found.objects is objects and found.expected == 0.0


def test_errors_of_sensors_put_as_much_outside_as_is_expected(rng: np.random.Generator) -> None:
    shapes, found = modes(rng), []
    for _ in range(2000):
        noise = STD / np.sqrt(2.0) * (rng.standard_normal(N) + 1j * rng.standard_normal(N))
        seen = CheckedShape(3, shapes[:, 2] + noise, np.full(N, STD))
        found.append(shape_checks([seen], [shapes], HZ, [0.6])[0])
    outside, expected = (np.array([getattr(one, key) for one in found]) for key in ("outside", "expected"))
    # four standard errors of the mean of 2,000 sums of 7 squares
    assert outside.mean() == pytest.approx(expected.mean(), rel=4.0 / np.sqrt(2000.0 * 7.0))
    spread = np.sqrt(np.mean([one.std**2 for one in found]) - 0.01**2)
    # 10 %: of a standard deviation from 2,000 draws, and the spread of the shape's own square
    assert np.std(outside) == pytest.approx(spread, rel=0.1)


def test_no_more_sensors_than_modes_tell_nothing(rng: np.random.Generator) -> None:
    shapes = modes(rng)[:2]
    assert shape_checks([CheckedShape(1, shapes[:, 0], np.full(2, STD))], [shapes], HZ, [0.2]) == ()


@pytest.mark.parametrize(
    ("predicted", "objects"), [(0.03, False), (-0.0005, False), (-0.03, True)], ids=["same", "alike", "other"]
)
def test_an_order_the_model_has_otherwise_objects(predicted: float, objects: bool) -> None:
    """Mode 2 measured 1 % below mode 1, and mode 3 far above both."""
    draws = np.array([[0.0, -predicted, 1.0]]) + 0.001 * np.random.default_rng(1).standard_normal((400, 3))
    found = order_checks([1, 2, 3], np.array([0.0, -0.01, 1.0]), np.full(3, 0.001), draws)
    assert [(one.lower, one.upper) for one in found] == [(2, 1), (1, 3)]
    assert found[0].predicted == pytest.approx(predicted, abs=3e-4)
    assert found[0].std == pytest.approx(0.002, rel=0.1)
    assert [one.objects for one in found] == [objects, False]
