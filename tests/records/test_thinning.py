"""Samples that arrive in pieces are decimated as if all were there, whatever the pieces are."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.records import Channel, Record, decimate
from jackettwin.records.processing.thinning import thinned


@pytest.mark.parametrize("length", [700, 997, 5000])
def test_pieces_are_decimated_as_the_whole(rng: np.random.Generator, length: int) -> None:
    y = rng.standard_normal((2, 5000))
    whole = decimate(Record(y, 20.0, (Channel("a"), Channel("b"))), sample_rate_hz=4.0).data
    pieces = [(k, y[:, k : k + length]) for k in range(0, 5000, length)]
    # FFTs of other lengths round otherwise
    assert_allclose(np.hstack(list(thinned(pieces, 5))), whole, atol=1e-12)


def test_time_between_pieces_is_missing_and_time_told_twice_counts_once(rng: np.random.Generator) -> None:
    y = rng.standard_normal((1, 6000))
    whole = np.hstack(list(thinned([(0, y)], 5)))
    parts = np.hstack(list(thinned([(0, y[:, :2000]), (1990, y[:, 1990:3000]), (4000, y[:, 4000:])], 5)))
    assert parts.shape == whole.shape
    known = np.isfinite(parts)
    assert 0.15 < 1.0 - known.mean() < 0.18  # a sixth is missing
    far = np.abs(np.arange(1200) - 700) > 150  # beside the gap the filter weighs bridged samples
    assert_allclose(parts[:, far], whole[:, far], atol=1e-12)
