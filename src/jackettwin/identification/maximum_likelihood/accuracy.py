"""How well a fit knows its parameters: covariance, bound, bias of the small sample, lack of fit.

Data hold a dither that does not scatter, so the covariance of the estimate is the sandwich, not the inverse
of the information.
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
    linear_bend,
)

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram
    from jackettwin.identification.maximum_likelihood.prior import ParameterPrior


KEPT_SHARES = (1e-4, 1e-2, 1.0)
"""Shares of the added power kept in the Cramér-Rao bound: the least that leaves E positive, which the leak of
fully coherent forces need not."""
LEAST_SHARE = 1e-10
"""Information added to every parameter, as a share of its own: shapes of one direction only determine nothing
across, and the inverse must exist."""
BEND_STEP = 0.1
"""Share of the standard deviations over which the curvature of the model is taken."""
FIT_BLOCKS = 40
"""Blocks of lines over which the misfit is summed."""


@dataclass(frozen=True)
class Accuracy:
    """What a fit knows of its parameters.

    Attributes
    ----------
    covariance : (n_parameters, n_parameters)
        The sandwich.
    inverse_information : (n_parameters, n_parameters)
        F⁻¹, the prior counted.
    cramer_rao : (n_parameters,)
        Least standard deviations, of the model without the dither.
    """

    covariance: FloatArray
    inverse_information: FloatArray
    cramer_rao: FloatArray


def accuracy_of(data: Periodogram, p: Parameters) -> Accuracy:
    r"""Return the covariance of the parameters, and what it is made of.

    .. math:: F^{-1} V F^{-1}, \quad V_{pq} = \sum_k n_k \mathrm{tr}(E^{-1}\partial_p E\,E^{-1}E_0\,
              E^{-1}\partial_q E\,E^{-1}E_0)

    with :math:`E_0` the model without the dither, which does not scatter.
    """
    prior = prior_of(data, p)
    model = expected(data, p)
    white = inverse_root(model.matrix)
    share = np.einsum("kab,kb,kcb->kac", white, data.dither, white.conj(), optimize=True)
    # E0 whitened is R Rᴴ, singular but for the noise; V is the inner product of Rᴴ G R
    values, vectors = np.linalg.eigh(np.eye(white.shape[1]) - share)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    middle = _information(data, p, model, np.asarray(root.conj().transpose(0, 2, 1) @ white))
    information = products(data, p, model, white, misfit_of(data, white))[1]
    bread = _inverse(_with_prior(information, p, prior))
    clear = _with_prior(_information(data, p, *_barely_regular(data, p)), p, prior)
    return Accuracy(np.asarray(bread @ middle @ bread), bread, np.sqrt(np.diag(_inverse(clear))))


def curvature_bias(data: Periodogram, p: Parameters, known: Accuracy) -> FloatArray:
    r"""Return the bias of the estimated parameters due to the curvature of the model, (n_parameters,).

    .. math:: b_p = -\tfrac12 \sum_q F^{-1}_{pq} \sum_k n_k\, \mathrm{tr}\,E^{-1}\partial_q E\,E^{-1} T,
              \qquad T = \sum_{rs} C_{rs}\, \partial^2_{rs} E

    The second-order bias of Cox & Snell (1968) for a Gaussian model, whose other terms cancel. T is the sum
    of the second differences of E along the columns of a triangular root of C that move f, ζ and α; what
    the others add is in closed form.
    """
    model, covariance = expected(data, p), known.covariance
    n = 3 * len(p.log_f)
    root = linalg.cholesky(covariance[:n, :n], lower=True)
    columns = np.vstack([root, linalg.solve_triangular(root, covariance[:n, n:], lower=True).T])
    bend = linear_bend(data, p, model, covariance[n:, n:] - columns[n:] @ columns[n:].T)
    for step in BEND_STEP * columns.T:
        ahead, behind = (expected(data, p.moved(way * step)).matrix for way in (1.0, -1.0))
        bend += (ahead + behind - 2.0 * model.matrix) / BEND_STEP**2
    white = inverse_root(model.matrix)
    misfit = np.asarray(-0.5 * white @ bend @ white.conj().transpose(0, 2, 1))
    return np.asarray(known.inverse_information @ products(data, p, model, white, misfit)[0])


def lack_of_fit(data: Periodogram, p: Parameters) -> float:
    r"""Return the mean square of the whitened misfit of blocks of lines over its expectation.

    .. math:: \frac1B\sum_b \frac{\|\sum_{k\in b} n_k(W_k\hat S_kW_k^H - I)\|_F^2}
              {\sum_{k\in b} n_k (\mathrm{tr}\,W_kE_{0k}W_k^H)^2}

    Near 1 (a little below, as parameters were fitted) where the record is what the model says.
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
    """Return the information with that of the prior."""
    out = information + np.diag(prior.precision)
    add_coherence_prior(p, np.zeros(len(out)), out)
    return out


def _inverse(information: FloatArray) -> FloatArray:
    unit = 1.0 / np.sqrt(np.diag(information))
    scaled = information * np.outer(unit, unit) + LEAST_SHARE * np.eye(len(unit))
    return np.asarray(linalg.inv(scaled) * np.outer(unit, unit))


def _barely_regular(data: Periodogram, p: Parameters) -> tuple[Expected, ComplexArray]:
    """Return the model with as little of the dither as leaves E positive, and the inverse root of that."""
    for share in KEPT_SHARES[:-1]:
        bare = expected(data, p, share)
        try:
            return bare, inverse_root(bare.matrix)
        except np.linalg.LinAlgError:
            continue
    bare = expected(data, p, KEPT_SHARES[-1])
    return bare, inverse_root(bare.matrix)


def _information(data: Periodogram, p: Parameters, model: Expected, white: ComplexArray) -> FloatArray:
    """Return Σ_k n_k ⟨G_p, G_q⟩ of the derivatives of E between two factors ``white``."""
    u, w = derivative_factors(data, p, model, white)
    return gram(np.asarray(u * np.sqrt(data.count)), w)[1]
