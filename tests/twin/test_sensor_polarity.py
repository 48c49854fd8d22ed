"""Signs of sensors against a model's shapes: every turned one is found, no sound one is blamed."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate
from jackettwin.twin.sensor_polarity import sensor_polarity

FREQUENCY = np.array([0.17, 0.18, 0.55, 0.75, 0.79])
HEIGHTS = np.array([1.0, 0.5, 0.25, 0.12])
FIRST, SECOND = HEIGHTS**1.4, np.array([-0.5, 1.0, 0.7, 0.45])
NONE = np.zeros(4)
SHAPES = np.array(
    [
        np.concatenate([NONE, FIRST]),
        np.concatenate([FIRST, NONE]),
        np.concatenate([0.2 * SECOND, 0.4 * FIRST]),
        np.concatenate([NONE, SECOND]),
        np.concatenate([SECOND, NONE]),
    ]
).T
"""Four sensors along x, four along y: two bending pairs and a torsion mode between."""


def measured(shapes: np.ndarray, rng: np.random.Generator) -> tuple[ModalEstimate, ...]:
    """Return the modes with 3 % noise on every shape and frequencies a few percent off."""
    noisy = shapes + 0.03 * np.abs(shapes).max(axis=0) * (rng.normal(size=(*shapes.shape, 2)) @ [1.0, 1j])
    off = 1.0 + 0.03 * rng.normal(size=len(FREQUENCY))
    return tuple(
        ModalEstimate(float(f), 0.02, shape, mpc=1.0, mpd_rad=0.0, order_share=1.0)
        for f, shape in zip(FREQUENCY * off, noisy.T, strict=True)
    )


@pytest.mark.parametrize("i", range(8))
def test_a_turned_sensor_is_found(i: int, rng: np.random.Generator) -> None:
    shapes = SHAPES.copy()
    shapes[i] *= -1.0
    (found,) = sensor_polarity(measured(shapes, rng), FREQUENCY, SHAPES)
    assert found.rows == (i,)
    assert found.after > 0.95 > found.before
    assert f"s{i} points opposite to its direction in the twin" in found.described(
        tuple(f"s{k}" for k in range(8))
    )


def test_two_turned_sensors_are_found(rng: np.random.Generator) -> None:
    shapes = SHAPES.copy()
    shapes[[1, 4]] *= -1.0
    found = sensor_polarity(measured(shapes, rng), FREQUENCY, SHAPES)
    assert {one.rows for one in found} == {(1,), (4,)}


def test_of_two_sensors_in_one_mode_either_may_be_turned() -> None:
    shape = np.array([1.0, -0.6], dtype=complex)
    mode = ModalEstimate(0.2, 0.01, shape, mpc=1.0, mpd_rad=0.0, order_share=1.0)
    (found,) = sensor_polarity((mode,), np.array([0.2]), np.array([[1.0], [0.6]]))
    assert found.rows == (0, 1)


def test_no_sound_sensor_is_blamed_for_a_poor_model() -> None:
    """200 models whose shapes are a fifth off, sensor by sensor and mode by mode."""
    for seed in range(200):
        rng = np.random.default_rng(seed)
        poor = SHAPES * (1.0 + 0.2 * rng.normal(size=SHAPES.shape))
        assert not sensor_polarity(measured(SHAPES, rng), FREQUENCY, poor)


def test_without_modes_nothing_is_said() -> None:
    assert sensor_polarity((), FREQUENCY, SHAPES) == ()
