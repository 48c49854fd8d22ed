"""Accuracy of a fit: covariance of its parameters, Cramér-Rao bound, small-sample bias and lack of fit.

The dither, a known power added to model and data, has no sampling scatter. The covariance of the estimate is
therefore the sandwich estimator, not the inverse of the information.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.maximum_likelihood.likelihood import (
    inverse_root,
    misfit_of,
    products,
)
from jackettwin.identification.maximum_likelihood.prior import add_coherence_prior, prior_of
from jackettwin.identification.maximum_likelihood.spectral_model import (
    Expected,
    derivative_factors,
    expected,
    gram,
    linear_curvature,
)

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram
    from jackettwin.identification.maximum_likelihood.prior import ParameterPrior


BOUND_DITHER_SHARES = (1e-4, 1e-2, 1.0)
"""Shares of the dither tried for the Cramér-Rao bound; the first that leaves E positive definite is used.
Without a dither, E can be indefinite at lines that receive leakage of fully coherent forces."""
RELATIVE_RIDGE = 1e-10
"""Share of its own information added to each parameter, so that the inverse exists: if all shapes have one
direction, the data do not determine the components normal to it."""
CURVATURE_STEP = 0.1
"""Step of the differences that give the curvature of the model, in standard deviations."""
FIT_BLOCKS = 40
"""Number of blocks of lines over which the misfit is summed."""


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of the parameters of a fit.

    Attributes
    ----------
    covariance : (n_parameters, n_parameters)
        The sandwich estimate.
    inverse_information : (n_parameters, n_parameters)
        F⁻¹, including the prior.
    cramer_rao : (n_parameters,)
        Smallest attainable standard deviations, of the model without the dither.
    """

    covariance: FloatArray
    inverse_information: FloatArray
    cramer_rao: FloatArray


def accuracy_of(data: Periodogram, p: Parameters) -> Accuracy:
    r"""Return the accuracy of the parameters.

    Their covariance is

    .. math:: F^{-1} V F^{-1}, \quad V_{pq} = \sum_k n_k \mathrm{tr}(E^{-1}\partial_p E\,E^{-1}E_0\,
              E^{-1}\partial_q E\,E^{-1}E_0)

    where :math:`E_0` is the model without the dither.
    """
    prior = prior_of(data, p)
    model = expected(data, p)
    white = inverse_root(model.matrix)
    share = np.einsum("kab,kb,kcb->kac", white, data.dither, white.conj(), optimize=True)
    # the whitened E0 is R Rᴴ, which only the noise keeps regular; V is the inner product of Rᴴ G R
    values, vectors = np.linalg.eigh(np.eye(white.shape[1]) - share)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    middle = _information(data, p, model, np.asarray(root.conj().transpose(0, 2, 1) @ white))
    information = products(data, p, model, white, misfit_of(data, white))[1]
    bread = _inverse(_with_prior(information, p, prior))
    clear = _with_prior(_information(data, p, *_least_dithered(data, p)), p, prior)
    return Accuracy(np.asarray(bread @ middle @ bread), bread, np.sqrt(np.diag(_inverse(clear))))


def curvature_bias(data: Periodogram, p: Parameters, known: Accuracy) -> FloatArray:
    r"""Return the bias of the estimated parameters due to the curvature of the model, (n_parameters,).

    .. math:: b_p = -\tfrac12 \sum_q F^{-1}_{pq} \sum_k n_k\, \mathrm{tr}\,E^{-1}\partial_q E\,E^{-1} T,
              \qquad T = \sum_{rs} C_{rs}\, \partial^2_{rs} E

    This is the second-order bias of Cox & Snell (1968); for a Gaussian model its other terms cancel.
    T sums the second differences of E along those columns of a triangular root of C that change f, ζ and α;
    the contribution of the other columns has a closed form.
    """
    model, covariance = expected(data, p), known.covariance
    n = 3 * len(p.log_f)
    root = linalg.cholesky(covariance[:n, :n], lower=True)
    columns = np.vstack([root, linalg.solve_triangular(root, covariance[:n, n:], lower=True).T])
    curvature = linear_curvature(data, p, model, covariance[n:, n:] - columns[n:] @ columns[n:].T)
    for step in CURVATURE_STEP * columns.T:
        ahead, behind = (expected(data, p.moved(way * step)).matrix for way in (1.0, -1.0))
        curvature += (ahead + behind - 2.0 * model.matrix) / CURVATURE_STEP**2
    white = inverse_root(model.matrix)
    misfit = np.asarray(-0.5 * white @ curvature @ white.conj().transpose(0, 2, 1))
    return np.asarray(known.inverse_information @ products(data, p, model, white, misfit)[0])


def lack_of_fit(data: Periodogram, p: Parameters) -> float:
    r"""Return the mean square of the whitened misfit of blocks of lines over its expectation.

    .. math:: \frac1B\sum_b \frac{\|\sum_{k\in b} n_k(W_k\hat S_kW_k^H - I)\|_F^2}
              {\sum_{k\in b} n_k (\mathrm{tr}\,W_kE_{0k}W_k^H)^2}

    It is near 1 where the model describes the record (a little less than 1, since parameters were fitted).
    """
    white = inverse_root(expected(data, p).matrix)
    misfit = misfit_of(data, white)
    share = np.einsum("kab,kb,kab->k", white, data.dither, white.conj(), optimize=True).real
    variance = data.count * (white.shape[1] - share) ** 2
    passed = np.cumsum(data.count)
    first = np.flatnonzero(np.diff(np.ceil(passed / passed[-1] * FIT_BLOCKS), prepend=0.0))
    total = np.add.reduceat(data.count[:, None, None] * misfit, first, axis=0)
    size = np.sum(np.abs(total) ** 2, axis=(1, 2))
    return float(np.mean(size / np.add.reduceat(variance, first)))


def _with_prior(information: FloatArray, p: Parameters, prior: ParameterPrior) -> FloatArray:
    """Return the information of the data plus that of the prior."""
    out = information + np.diag(prior.precision)
    add_coherence_prior(p, np.zeros(len(out)), out)
    return out


def _inverse(information: FloatArray) -> FloatArray:
    unit = 1.0 / np.sqrt(np.diag(information))
    scaled = information * np.outer(unit, unit) + RELATIVE_RIDGE * np.eye(len(unit))
    return np.asarray(linalg.inv(scaled) * np.outer(unit, unit))


def _least_dithered(data: Periodogram, p: Parameters) -> tuple[Expected, ComplexArray]:
    """Return the model with the least dither that keeps E positive definite, and the inverse root of E."""
    for share in BOUND_DITHER_SHARES[:-1]:
        bare = expected(data, p, share)
        try:
            return bare, inverse_root(bare.matrix)
        except np.linalg.LinAlgError:
            continue
    bare = expected(data, p, BOUND_DITHER_SHARES[-1])
    return bare, inverse_root(bare.matrix)


def _information(data: Periodogram, p: Parameters, model: Expected, white: ComplexArray) -> FloatArray:
    """Return Σ_k n_k ⟨G_p, G_q⟩ of the derivatives of E between two factors ``white``."""
    u, w = derivative_factors(data, p, model, white)
    return gram(np.asarray(u * np.sqrt(data.count)), w)[1]
