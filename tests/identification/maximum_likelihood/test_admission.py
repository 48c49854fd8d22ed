"""A pair has two members: the third that a start brings along goes, and a true third one stays."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.admission import drop_unneeded_modes, possible_doubles
from jackettwin.identification.maximum_likelihood.periodogram import periodogram
from jackettwin.identification.synthetic import ModalSystem, simulate

SHAPES = np.kron(np.array([[1.0, 0.6, 0.2]]), np.eye(2))
ZETA = 0.012


def left_of(rng, frequency_hz, shapes, start_hz, start_shapes, duration_s=900.0) -> np.ndarray:
    """Return the frequencies that are left of a fit that starts with some modes."""
    damping = np.full(len(frequency_hz), ZETA)
    system = ModalSystem(np.array(frequency_hz), damping, shapes, np.eye(len(shapes)))
    record = simulate(system, rng, sample_rate_hz=3.0, duration_s=duration_s)
    y = record.data / record.data.std(axis=1, keepdims=True)
    f, zeta = np.array(start_hz), np.full(len(start_hz), ZETA)
    data = periodogram(y, 3.0, (0.2, 0.45), modes=(f, zeta), derivatives=[0] * len(y))
    unit = start_shapes / np.linalg.norm(start_shapes, axis=1, keepdims=True)
    optimum = likelihood.maximise(data, likelihood.start(data, f, zeta, unit), 30)
    known = accuracy.accuracy_of(data, optimum.parameters)
    optimum, chosen, _ = drop_unneeded_modes(data, optimum, np.arange(len(f)), known)
    assert len(chosen) == len(optimum.parameters.log_f)
    return np.sort(np.exp(optimum.parameters.log_f))


@pytest.mark.parametrize("seed", range(2))
def test_a_double_beside_a_pair_is_dropped_and_the_pair_stays(seed):
    rng = np.random.default_rng([8, seed])
    doubled = SHAPES[[0, 1, 0]]
    left = left_of(rng, [0.300, 0.310], SHAPES, [0.300, 0.310, 0.304], doubled)
    # four standard errors of a mode alone, √(ζ/(2πfT)) = 0.27 %
    np.testing.assert_allclose(left, [0.300, 0.310], rtol=0.011)


def test_two_peaks_of_one_shape_stay_two(rng):
    """A tuned mass damper splits a mode into two of one shape: an hour tells that both are needed."""
    split = SHAPES[[0, 0, 1]]
    left = left_of(rng, [0.290, 0.3035, 0.318], split, [0.290, 0.3035, 0.318], split, 3600.0)
    np.testing.assert_allclose(left, [0.290, 0.3035, 0.318], rtol=0.009)


def test_doubles_are_close_and_alike(rng):
    modes = (np.array([0.3]), np.array([ZETA]))
    noise = rng.standard_normal((6, 2700))
    data = periodogram(noise, 3.0, (0.2, 0.45), modes=modes, derivatives=[0] * 6)
    for f, shapes, expected in (
        ([0.300, 0.304, 0.340], SHAPES[[0, 0, 1]], [True, True, False]),
        ([0.300, 0.304, 0.340], SHAPES[[0, 1, 1]], [False, False, False]),
        ([0.300, 0.304, 0.308], SHAPES[[0, 1, 1]], [True, True, True]),
        ([0.300, 0.340, 0.306], SHAPES[[0, 0, 1]], [False, False, False]),
    ):
        p = likelihood.start(data, np.array(f), np.full(3, ZETA), shapes)
        assert possible_doubles(p, np.arange(3)).tolist() == expected
