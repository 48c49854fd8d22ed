"""Covariances against the plain double sum, with and without gaps."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.identification.subspace.covariances import block_covariances, covariances


def plain(y, n_lags):
    out = np.zeros((n_lags + 1, len(y), len(y)))
    for i in range(n_lags + 1):
        for a in range(len(y)):
            for b in range(len(y)):
                products = y[a, i:] * y[b, : y.shape[1] - i]
                out[i, a, b] = np.nanmean(products)
    return out


@pytest.mark.parametrize("share_missing", [0.0, 0.2])
def test_equals_the_plain_sum(rng, share_missing):
    y = rng.standard_normal((3, 200))
    y[rng.random(y.shape) < share_missing] = np.nan
    # FFT round-off only
    np.testing.assert_allclose(covariances(y, 12), plain(y, 12), rtol=0, atol=1e-12)


def test_lag_is_that_of_the_first_index():
    """R_i = E[y_{t+i} y_tᵀ]: channel 0 repeats channel 1 two samples later."""
    y = np.zeros((2, 50))
    y[1, 10], y[0, 12] = 1.0, 1.0
    lagged = covariances(y, 3)
    assert lagged[2, 0, 1] > 0.0
    assert lagged[2, 1, 0] == pytest.approx(0.0, abs=1e-15)


def test_blocks_average_to_the_whole(rng):
    y = rng.standard_normal((2, 5 * 40 + 7))
    blocks = block_covariances(y, 7, 5)
    direct = sum(np.outer(y[:, t + 7], y[:, t]) for t in range(200)) / 200
    np.testing.assert_allclose(blocks.mean(axis=0)[7], direct, rtol=0, atol=1e-12)


def test_gaps_that_leave_nothing_are_refused(rng):
    y = rng.standard_normal((2, 100))
    y[0, :50], y[1, 50:] = np.nan, np.nan
    with pytest.raises(InputError, match="too few pairs"):
        covariances(y, 5)
