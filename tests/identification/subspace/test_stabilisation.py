"""Poles of modes that grow by chance within a record."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.subspace.ssi_cov import OrderPoles
from jackettwin.identification.subspace.stabilisation import stabilisation

RATE_HZ, DURATION_S = 4.0, 600.0


def test_a_pole_that_hardly_grows_is_that_of_a_light_mode_as_well_known_in_its_decay() -> None:
    growth = np.array([-2.0, 0.3, 1.2])  # e-folds within the record
    pole = growth / DURATION_S + 2j * np.pi * np.array([0.3, 0.5, 0.8])
    mu = np.exp(pole / RATE_HZ)
    change = 0.1 / DURATION_S  # of the real part [1/s], in one block
    poles = OrderPoles(
        2, mu, np.ones((3, 2), complex), mu * change / RATE_HZ + 0j * mu[None], np.zeros((1, 3, 2), complex)
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
