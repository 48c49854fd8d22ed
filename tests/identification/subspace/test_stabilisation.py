"""Poles of modes that grow by chance within a record."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.subspace.ssi_cov import OrderPoles
from jackettwin.identification.subspace.stabilisation import few_block_widening, stabilisation

RATE_HZ, DURATION_S = 4.0, 600.0
BLOCKS = 30


def test_a_pole_that_hardly_grows_is_that_of_a_light_mode_as_well_known_in_its_decay() -> None:
    growth = np.array([-2.0, 0.3, 1.2])  # e-folds within the record
    pole = growth / DURATION_S + 2j * np.pi * np.array([0.3, 0.5, 0.8])
    mu = np.exp(pole / RATE_HZ)
    change = 0.1 / DURATION_S  # of the real part [1/s]
    one = mu * change / RATE_HZ / np.sqrt(BLOCKS)
    poles = OrderPoles(
        2, mu, np.ones((3, 2), complex), np.tile(one, (BLOCKS, 1)), np.zeros((BLOCKS, 3, 2), complex)
    )
    found = stabilisation(
        [poles],
        IdentificationSettings(),
        sample_rate_hz=RATE_HZ,
        duration_s=DURATION_S,
        band_hz=(0.1, 1.5),
        scale=np.ones(2),
    )
    # −Re λ T is 2 as found, and 1, the least that the record shows; the third grows by more than one e-fold
    np.testing.assert_allclose(found.frequency_hz, [0.3, 0.5], rtol=1e-5)
    decay = 2.0 * np.pi * found.damping_ratio * found.frequency_hz * DURATION_S
    np.testing.assert_allclose(decay, [2.0, 1.0], rtol=1e-6)
    # ζ = −Re λ/|λ|: an equal change of the real part counts twice as much where it is half as large
    assert found.log_covariance is not None
    np.testing.assert_allclose(np.sqrt(found.log_covariance[:, 1, 1]), [0.05, 0.1], rtol=1e-3)
    assert found.damping_ratio_std == pytest.approx(change / (2.0 * np.pi * np.array([0.3, 0.5])), rel=1e-3)
    # the 95 % quantiles of Student's t of 29 degrees of freedom and of the normal distribution
    np.testing.assert_allclose(found.few_blocks, 1.699 / 1.645, rtol=1e-3)


def test_gusts_leave_few_blocks_to_judge_by(rng):
    """Power in the ratio 1 to 0.001 in 5 of 30 blocks: about 5 degrees of freedom, t/z = 1.22 (tables)."""
    size = np.where(np.arange(30) % 6 == 0, 1.0, np.sqrt(0.001))
    widening = few_block_widening(size[:, None] * rng.standard_normal((30, 4000)))
    assert np.median(widening) == pytest.approx(1.22, abs=0.06)
    steady = few_block_widening(rng.standard_normal((30, 4000)))
    assert np.median(steady) == pytest.approx(1.03, abs=0.01)
