"""First-order propagation against finite differences, against pyOMA2, and independent of the order step."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from calibration import are_standard
from tests.support.stacked_hankel import stacked_hankel

from jackettwin.identification import identify, mac
from jackettwin.identification.mode_shapes import normalised
from jackettwin.identification.subspace.covariances import block_covariances, covariances
from jackettwin.identification.subspace.ssi_cov import (
    balanced_subspace,
    frequency_and_damping,
    order_poles,
    ssi_cov,
)
from jackettwin.identification.subspace.ssi_uncertainty import (
    block_deviations,
    order_poles_with_uncertainty,
    propagation,
)
from jackettwin.identification.subspace.stabilisation import log_deviations
from jackettwin.identification.synthetic import ModalSystem, simulate

RATE = 5.0


@pytest.fixture
def y(tower, rng):
    return simulate(tower, rng, sample_rate_hz=RATE).data[[0, 1, 4]]


def test_deviations_equal_finite_differences(y):
    h, deviations = stacked_hankel(y, 10, 4)
    delta = next(iter(deviations()))
    order = 8
    shared = propagation(balanced_subspace(h, 3, order), [delta])
    (poles,) = order_poles_with_uncertainty(shared, [order])
    step = 1e-6
    ahead, behind = (
        order_poles(balanced_subspace(h + sign * step * delta, 3, order), [order])[0] for sign in (1, -1)
    )
    for k, mu in enumerate(poles.eigenvalues):
        a, b = (np.argmin(np.abs(p.eigenvalues - mu)) for p in (ahead, behind))
        slope = (ahead.eigenvalues[a] - behind.eigenvalues[b]) / (2 * step)
        # central difference: error of the order of step² plus round-off over step
        assert poles.eigenvalue_deviations[0, k] == pytest.approx(slope, rel=1e-4, abs=1e-6)
        slope = (normalised(ahead.shapes[a]) - normalised(behind.shapes[b])) / (2 * step)
        np.testing.assert_allclose(poles.shape_deviations[0, k], slope, rtol=1e-3, atol=1e-4)


def test_equals_pyoma2_with_its_stacked_estimator(y):
    """pyOMA2 1.4.3, ``cov`` with step 1, the one step at which its uncertainty is right."""
    with warnings.catch_warnings(), np.errstate():  # pyOMA2 changes NumPy's error state on import
        warnings.simplefilter("ignore")
        pyoma = pytest.importorskip("pyoma2.functions.ssi")
        top = 12
        hankel, root = pyoma.build_hank(y, y, 10, "cov", calc_unc=True, nb=20)
        observability, a, c, _ = pyoma.SSI_fast(hankel, 10, top, step=1)
        f_theirs, zeta_theirs, *_, f_std, zeta_std, _ = pyoma.SSI_poles(
            observability, a, c, top, 1 / RATE, calc_unc=True, H=hankel, T=root
        )
    h, deviations = stacked_hankel(y, 10, 20)
    shared = propagation(balanced_subspace(h, 3, top), deviations())
    compared = 0
    for poles in order_poles_with_uncertainty(shared, range(2, top + 1)):
        f, zeta = frequency_and_damping(poles.eigenvalues, RATE)
        d_f, d_zeta = log_deviations(poles.eigenvalues, poles.eigenvalue_deviations, RATE)
        for k in np.flatnonzero((zeta > 0.0) & (zeta < 0.1)):
            j = np.nanargmin(np.abs(f_theirs[:, poles.order] - f[k]))
            theirs = [x[j, poles.order] for x in (f_theirs, zeta_theirs, f_std, zeta_std)]
            ours = [f[k], zeta[k], f[k] * np.linalg.norm(d_f[:, k]), zeta[k] * np.linalg.norm(d_zeta[:, k])]
            # the same first-order formula in another order of operations
            np.testing.assert_allclose(ours, theirs, rtol=1e-6)
            compared += 1
    assert compared > 10


def test_uncertainty_does_not_depend_on_the_order_step(y):
    lagged, blocks = covariances(y, 20), block_covariances(y, 20, 20)
    shared = propagation(ssi_cov(lagged, block_rows=10, max_order=12), block_deviations(blocks, 10))
    every = {p.order: p for p in order_poles_with_uncertainty(shared, range(2, 13))}
    for poles in order_poles_with_uncertainty(shared, range(2, 13, 5)):
        same = every[poles.order].eigenvalue_deviations
        # the same sums over other parts
        np.testing.assert_allclose(poles.eigenvalue_deviations, same, rtol=1e-9, atol=1e-12)


def test_claimed_deviations_are_those_that_records_scatter_by():
    """Three hundred records of two modes: claimed variances beside those found."""
    shapes = np.array([[1.0, 0.6, 0.2], [-0.5, 0.7, 1.0]])
    system = ModalSystem(np.array([0.4, 0.9]), np.array([0.02, 0.03]), shapes, np.eye(2), 0.05)
    found, claimed = np.empty((300, 2, 2)), np.empty((300, 2, 2))
    for seed in range(300):
        rng = np.random.default_rng([23, seed])
        y = simulate(system, rng, duration_s=1200.0, sample_rate_hz=RATE).data
        lagged, blocks = covariances(y, 30), block_covariances(y, 30, 30)
        shared = propagation(ssi_cov(lagged, block_rows=15, max_order=4), block_deviations(blocks, 15))
        (poles,) = order_poles_with_uncertainty(shared, [4])
        modes = np.argsort(np.abs(poles.eigenvalues - 1.0))
        found[seed] = np.log(frequency_and_damping(poles.eigenvalues[modes], RATE))
        deviations = log_deviations(poles.eigenvalues, poles.eigenvalue_deviations, RATE)
        claimed[seed] = [np.sum(d[:, modes] ** 2, axis=0) for d in deviations]
    ratio = np.sqrt(np.mean(claimed.mean(axis=0) / found.var(axis=0, ddof=1)))
    # four variances of 300 values: their mean has a standard error of 4 %, its root of 2 %; three of these
    assert 0.94 < ratio < 1.06


def test_damping_errs_by_its_deviation(tower):
    """Twelve records, four modes: 48 errors in units of their deviations, judged from both sides."""
    scores = []
    for seed in range(12):
        result = identify(simulate(tower, np.random.default_rng(seed), sample_rate_hz=5.0))
        shapes = np.array([m.mode_shape for m in result.modes])
        f = np.array([m.frequency_hz for m in result.modes])
        for k, zeta in enumerate(tower.damping_ratio):
            similarity = mac(tower.mode_shapes[k], shapes)
            mode = result.modes[
                np.argmin(np.abs(np.log(f / tower.frequency_hz[k])) + 0.2 * (1.0 - similarity))
            ]
            scores.append(np.log(mode.damping_ratio / zeta) / np.sqrt(mode.log_covariance[1, 1]))
    assert are_standard(np.array(scores))
