"""Pairing: close modes mix in measured shapes, and still each gets its own name."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate
from jackettwin.identification.status import ModeStatus
from jackettwin.updating.data.pairing import counterparts, pair, pairing_score

FREQUENCY = np.array([0.177, 0.180, 0.65, 0.775, 0.800])
SHAPES = np.array(
    [
        [0.0, 1.0, 0.0, 0.0, 0.3],
        [1.0, 0.0, 0.9, 0.3, 0.0],
        [0.0, 0.6, 0.0, 0.0, -1.0],
        [0.6, 0.0, 0.1, -1.0, 0.0],
    ]
)
"""Side-side and fore-aft pairs at a tower's top and middle, x and y; a torsion mode seen sideways."""


def estimate(frequency_hz: float, shape: np.ndarray) -> ModalEstimate:
    return ModalEstimate(
        frequency_hz=frequency_hz,
        damping_ratio=0.02,
        mode_shape=shape.astype(complex),
        mpc=1.0,
        mpd_rad=0.0,
        order_share=1.0,
    )


@pytest.mark.parametrize("mixed", [0.0, 0.5, 0.9])
def test_a_weak_mode_mixed_with_its_strong_neighbour_keeps_its_name(mixed: float) -> None:
    weak = (1.0 - mixed) * SHAPES[:, 4] + mixed * 1j * SHAPES[:, 3]
    measured = (estimate(0.742, SHAPES[:, 3]), estimate(0.761, weak))
    found = pair(measured, FREQUENCY, SHAPES)
    assert {mode: index for mode, (index, _) in found.items()} == {3: 0, 4: 1}


def test_every_mode_of_the_model_finds_itself_in_any_order(rng: np.random.Generator) -> None:
    order = rng.permutation(5)
    measured = tuple(estimate(FREQUENCY[i] * 1.01, SHAPES[:, i] * np.exp(1j * i)) for i in order)
    found = pair(measured, FREQUENCY, SHAPES)
    assert {mode: int(order[index]) for mode, (index, _) in found.items()} == {i: i for i in range(5)}
    assert all(subspace_mac == pytest.approx(1.0) for _, subspace_mac in found.values())


def test_the_right_shape_at_the_wrong_frequency_is_not_paired() -> None:
    assert pair((estimate(1.2, SHAPES[:, 3]),), FREQUENCY, SHAPES) == {}


def test_a_doubtful_shoulder_beside_a_mode_is_not_paired() -> None:
    """One 10 % beside the model's mode, which its record doubted, made a right model "not reliable"."""
    for off, status, paired in (
        (0.9, "doubtful", 0),
        (0.9, "ok", 1),
        (0.97, "doubtful", 1),
        (1.12, "doubtful", 0),
    ):
        seen = (replace(estimate(0.65 * off, SHAPES[:, 2]), status=ModeStatus(status)),)
        assert len(pair(seen, FREQUENCY, SHAPES)) == paired
        verdict = counterparts(seen, FREQUENCY, SHAPES)[0].verdict
        assert verdict == ("paired" if paired else "frequency")


def test_the_right_frequency_with_the_wrong_shape_is_not_paired() -> None:
    assert pair((estimate(0.65, SHAPES[:, 4]),), FREQUENCY, SHAPES).keys() <= {3, 4}


def test_a_shape_that_leans_across_the_modes_direction_is_not_paired() -> None:
    across = 0.8 * SHAPES[:, 3] + 0.6 * np.linalg.norm(SHAPES[:, 3]) * np.array([0.0, 0.0, 1.0, 0.0])
    assert pair((estimate(0.78, across),), FREQUENCY[3:4], SHAPES[:, 3:4]) == {}


def test_a_mode_the_sensors_cannot_see_is_not_paired() -> None:
    blind = SHAPES.copy()
    blind[:, 2] *= 1e-3
    assert 2 not in pair((estimate(0.65, SHAPES[:, 2]),), FREQUENCY, blind)


def test_nothing_measured_pairs_with_nothing() -> None:
    assert pair((), FREQUENCY, SHAPES) == {}


def test_every_measured_mode_is_held_against_a_mode_of_the_model() -> None:
    measured = (
        estimate(0.178, SHAPES[:, 0]),
        estimate(1.2, SHAPES[:, 3]),
        estimate(0.66, np.array([0.0, 1.0, 0.0, -1.0])),
        estimate(0.60, SHAPES[:, 2]),
        estimate(0.65, SHAPES[:, 2]),
    )
    held = counterparts(measured, FREQUENCY, SHAPES)
    assert [h.verdict for h in held] == ["paired", "frequency", "shape", "taken", "paired"]
    assert [h.mode for h in held[3:]] == [2, 2]
    assert held[3].difference == pytest.approx(0.60 / 0.65 - 1.0)
    assert held[3].mac == pytest.approx(1.0)
    assert {h.mode: i for i, h in enumerate(held) if h.verdict == "paired"} == {
        mode: i for mode, (i, _) in pair(measured, FREQUENCY, SHAPES).items()
    }


def test_the_model_in_any_order_with_modes_lost_sight_of() -> None:
    measured = tuple(estimate(f, SHAPES[:, i]) for i, f in enumerate(FREQUENCY))
    order = np.array([3, 0, 4, 2, 1])
    frequency = np.where(order == 2, np.nan, FREQUENCY[order])
    found = pair(measured, frequency, SHAPES[:, order])
    assert {mode: index for mode, (index, _) in found.items()} == {0: 3, 1: 0, 2: 4, 4: 1}


def test_a_model_nearer_to_the_measured_modes_is_more_like_them() -> None:
    measured = tuple(estimate(f, SHAPES[:, i]) for i, f in enumerate(FREQUENCY))
    assert pairing_score(measured, FREQUENCY, SHAPES) == pytest.approx(5.0)
    assert pairing_score(measured, 1.1 * FREQUENCY, SHAPES) < 4.9
    assert pairing_score((), FREQUENCY, SHAPES) == 0.0
