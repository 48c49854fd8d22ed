"""The directions of a narrow band hold what moves there, and lead back to all channels."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.maximum_likelihood.directions import directions, project
from jackettwin.identification.synthetic import simulate


def test_directions_hold_the_modes_of_their_band(tower, rng):
    """What the neighbours do in the band of the first pair lies in the span as well."""
    record = simulate(tower, rng, sample_rate_hz=10.0)
    basis = directions(record.data, 10.0, (0.2, 0.5), tower.mode_shapes[:1])
    np.testing.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-12)
    for shape in tower.mode_shapes[:2]:
        inside = np.linalg.norm(basis.T @ shape) / np.linalg.norm(shape)
        # 2 % noise of the whole band leaves this share of the direction of the second mode
        assert inside > 0.99


def test_a_direction_outside_the_band_counts_less(tower, rng):
    """What the span leaves out is a real choice: it holds the modes of the band better than the others."""
    record = simulate(tower, rng, sample_rate_hz=10.0)
    basis = directions(record.data, 10.0, (0.2, 0.5), tower.mode_shapes[:1])
    kept = [np.linalg.norm(basis.T @ s) / np.linalg.norm(s) for s in tower.mode_shapes]
    assert max(kept[2:]) < min(kept[:2])


@pytest.mark.parametrize("n_channels", [1, 2, 5])
def test_few_channels_stay_as_they_are(rng, n_channels):
    assert (
        directions(rng.standard_normal((n_channels, 500)), 10.0, (1.0, 2.0), np.ones((1, n_channels))) is None
    )


def test_a_gap_of_one_channel_is_one_of_all_directions():
    y = np.ones((3, 4))
    y[1, 2] = np.nan
    z = project(y, np.eye(3)[:, :2])
    assert np.isnan(z).all(axis=0).tolist() == [False, False, True, False]


def test_a_band_of_few_lines_keeps_all_channels(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=10.0)
    assert directions(record.data, 10.0, (0.25, 0.35), tower.mode_shapes[:1]) is None
