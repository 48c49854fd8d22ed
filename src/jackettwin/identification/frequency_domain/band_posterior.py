r"""Most probable modes of one band under Gaussian lines, and their posterior deviations (BAYOMA).

In a band around one or a few modes the scaled transforms of the channels are independent complex Gaussian
vectors of covariance

.. math:: E_k = \Phi H_k S H_k^* \Phi^T + S_e I, \qquad
          h_{ik} = \frac{1}{1 - \beta_{ik}^{-2} - 2 i \zeta_i \beta_{ik}^{-1}}, \quad \beta_{ik} = f_k/f_i

(accelerations under forces of constant density S in the band). With flat priors the posterior is the
likelihood; its maximum is the most probable value, and the inverse of its curvature there the covariance. For
one mode the most probable shape is an eigenvector (Au 2011, J. Eng. Mech. 137(3)), which leaves four
unknowns; for several modes the likelihood is computed in the dominant subspace (Au 2012, Mech. Syst. Signal
Process. 26). The number of modes in a band maximises the evidence by Schwarz's criterion.

Au, S.K. 2017, Operational Modal Analysis, Springer, chapters 12 and 13.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.mode_shapes import aligned

if TYPE_CHECKING:
    from collections.abc import Callable

    Cost = Callable[[FloatArray], tuple[float, FloatArray]]

MOST_MODES = 3
"""Largest number of modes in a band."""
SMOOTH = 5
"""Number of lines over which the power in another direction is averaged."""
MIN_PEAK = 4.0
"""Smallest ratio of its peak to its median for which a further mode is tried."""
START_DAMPING = 0.01
"""Damping ratio from which the search starts."""
MAX_DAMPING = 0.2
"""Damping ratio above which a mode of a band is its background and is dropped."""
MAX_LOG_STD = 1.0
"""Standard deviation of ln ζ above which a band does not determine a mode."""
LEAST_NOISE = 1e-12
"""Least noise as a share of the power, without which the matrix of one strong mode is singular."""
WIDE = 7.0
"""Half range of the search about its start, in logarithms and in units of the shapes."""
STEP = 1e-4
"""Step of the differences of the slope for the curvature, in logarithms and in units of the shapes."""
MOST_STEPS = 10
"""Largest number of Newton steps after the search."""
MIN_GAIN = 1e-3
"""Least predicted gain of a step, in twice the log-posterior."""
MOST_MOVE = 0.5
"""Largest change of a parameter in one step."""
HALVINGS = 10
"""Largest number of halvings of a step without gain."""
FLAT = 1e-9
"""Share of the largest curvature below which a direction counts as flat, as those of the shapes' lengths."""


@dataclass(frozen=True)
class BandPosterior:
    """Most probable modes of one band.

    Attributes
    ----------
    frequency_hz, damping_ratio : (n_modes,)
    shapes : (n_channels, n_modes)
        Of unit length.
    log_covariance : (n_modes, 2, 2)
        Posterior covariance of (ln f, ln ζ).
    shape_std : (n_channels, n_modes)
        Posterior standard deviation of the entries of the shapes of unit length, due to the noise only.
    evidence : float
        Logarithm of the likelihood less Schwarz's penalty.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    shapes: FloatArray
    log_covariance: FloatArray
    shape_std: FloatArray
    evidence: float


def band_posterior(lines: ComplexArray, f: FloatArray, starts_hz: list[float]) -> BandPosterior | None:
    """Return the most probable modes of a band; None if it determines none.

    As many modes as peaks are tried, and one more if it has a peak or the others are not plausible without
    it.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transform of the samples in the band, in any constant scale.
    f : (n_lines,)
        Frequencies [Hz].
    starts_hz : list of float
        Frequencies of the peaks.
    """
    scaled = lines / np.sqrt(np.mean(np.abs(lines) ** 2))
    starts_hz = starts_hz[: len(lines)]
    trials, beside = [starts_hz], _peak_beside(scaled, f, starts_hz)
    if beside is not None:
        trials.append([*starts_hz, beside])
    found = [one for starts in trials if (one := _told(scaled, f, starts)) is not None]
    if not found and len(starts_hz) < min(MOST_MODES, len(lines)):
        # a broad mode below a narrow one has no own peak, but without it the narrow one's width is
        # not determined
        return _told(scaled, f, [*starts_hz, starts_hz[0]])
    return max(found, key=lambda one: one.evidence, default=None)


def _told(lines: ComplexArray, f: FloatArray, starts_hz: list[float]) -> BandPosterior | None:
    return _one_mode(lines, f, starts_hz[0]) if len(starts_hz) == 1 else _modes(lines, f, starts_hz)


def _peak_beside(lines: ComplexArray, f: FloatArray, starts_hz: list[float]) -> float | None:
    """Return the frequency of a clear peak in the next direction of motion; None if there is none."""
    n_modes = len(starts_hz)
    if n_modes >= min(MOST_MODES, len(lines)):
        return None
    _, vectors = np.linalg.eigh(np.real(lines @ lines.conj().T))
    power = np.abs(vectors[:, -1 - n_modes] @ lines) ** 2
    smooth = np.convolve(power, np.full(SMOOTH, 1.0 / SMOOTH), mode="same")
    peak = int(np.argmax(smooth))  # possibly at the same frequency, as the pairs of a tower
    return float(f[peak]) if smooth[peak] > MIN_PEAK * np.median(smooth) else None


def transfer(f: FloatArray, f_n: FloatArray, zeta: FloatArray) -> ComplexArray:
    """Return the acceleration of modes per unit force and modal mass, (n_lines, n_modes)."""
    beta = np.divide.outer(f, f_n)
    return np.asarray(beta**2 / (beta**2 - 1.0 - 2j * zeta * beta))


def _log_slopes(
    h: ComplexArray, f: FloatArray, f_n: FloatArray, zeta: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the derivatives of ln h, of ``transfer``, by ln f_n and by ln ζ, (n_lines, n_modes) each."""
    beta = np.divide.outer(f, f_n)
    damped = np.asarray(2j * zeta * h / beta)
    return np.asarray(2.0 * h / beta**2 + damped), damped


def _one_mode(lines: ComplexArray, f: FloatArray, start_hz: float) -> BandPosterior | None:
    """Return the most probable single mode: an eigenvector, and (ln f, ln ζ, ln S, ln Se)."""
    outer = np.real(np.einsum("ak,bk->kab", lines, lines.conj()))
    cost = partial(one_mode_cost, outer=outer, f=f)
    powers = np.linalg.eigvalsh(outer.mean(axis=0))
    noise = max(float(powers[:-1].mean()), 1e-6)  # all directions other than the shape contain only noise
    peak = float(np.einsum("kaa->k", outer).max())
    start = np.log([start_hz, START_DAMPING, peak * 4.0 * START_DAMPING**2, noise])
    theta = _most_probable(cost, start, f, 1)
    curvature = _curvature(cost, theta)
    covariance = _covariance(curvature)
    if covariance is None or not _credible(theta[:1], theta[1:2], f, covariance[1:2, 1:2]):
        return None
    _, _, values, vectors = _weighted(theta, outer, f)
    apart = 2.0 * (values[-1] - values[:-1]) / np.exp(theta[3])
    spread = vectors[:, :-1] ** 2 @ (1.0 / np.maximum(apart, 1e-12))
    n = len(lines)
    return BandPosterior(
        np.exp(theta[:1]),
        np.exp(theta[1:2]),
        vectors[:, -1:],
        covariance[None, :2, :2],
        np.sqrt(spread)[:, None],
        -cost(theta)[0] - 0.5 * (4 + n - 1) * np.log(len(f)),
    )


def one_mode_cost(theta: FloatArray, outer: FloatArray, f: FloatArray) -> tuple[float, FloatArray]:
    """Return minus the log-posterior of (ln f, ln ζ, ln S, ln Se), maximised over the shape, and its slope.

    Parameters
    ----------
    theta : (4,)
    outer : (n_lines, n_channels, n_channels)
        Real parts of the products of the lines.
    f : (n_lines,)
    """
    h, signal, values, vectors = _weighted(theta, outer, f)
    noise = np.exp(theta[3])
    power = signal + noise
    along = np.einsum("a,kab,b->k", vectors[:, -1], outer, vectors[:, -1])
    left = float(np.einsum("kaa->", outer)) - float(values[-1])
    others = (outer.shape[1] - 1) * len(f)
    # the shape is the best at every theta, so that its change has no effect on the cost
    by_signal = (power - along) / power**2
    by_f, by_zeta = (
        2.0 * float((by_signal * signal) @ slope[:, 0].real)
        for slope in _log_slopes(h, f, np.exp(theta[:1]), np.exp(theta[1:2]))
    )
    by_noise = others - left / noise + noise * np.sum(1.0 / power) + np.sum(along * signal / power**2)
    value = others * np.log(noise) + np.sum(np.log(power)) + left / noise
    return float(value), np.array([by_f, by_zeta, by_signal @ signal, by_noise])


def _weighted(
    theta: FloatArray, outer: FloatArray, f: FloatArray
) -> tuple[ComplexArray, FloatArray, FloatArray, FloatArray]:
    """Return what a mode's shape is an eigenvector of: products weighted by the mode's share of the power.

    Returns
    -------
    h, signal : (n_lines, 1), (n_lines,) the mode's transfer function and power
    values, vectors : (n_channels,), (n_channels, n_channels) of the sum of the weighted products
    """
    h = transfer(f, np.exp(theta[:1]), np.exp(theta[1:2]))
    signal = np.exp(theta[2]) * np.abs(h[:, 0]) ** 2
    share = signal / (signal + np.exp(theta[3]))
    return h, np.asarray(signal), *np.linalg.eigh(np.tensordot(share, outer, axes=1))


def _modes(lines: ComplexArray, f: FloatArray, starts_hz: list[float]) -> BandPosterior | None:
    """Return the most probable modes of a band with several."""
    m, (n, count) = len(starts_hz), lines.shape
    values, vectors = np.linalg.eigh(np.real(lines @ lines.conj().T))
    basis = vectors[:, ::-1][:, :m]
    inner = basis.T @ lines
    left = float(np.sum(np.abs(lines) ** 2) - np.sum(np.abs(inner) ** 2))
    noise = max(left / max((n - m) * count, 1), 1e-6 * float(values[-1]) / count)
    cost = partial(several_modes_cost, inner=inner, f=f, left=left, n_channels=n)
    nearest = [int(np.argmin(np.abs(f - start))) for start in starts_hz]
    at_peaks = np.array([np.real(aligned(inner[:, k] / np.linalg.norm(inner[:, k]))) for k in nearest]).T
    force = np.log([4.0 * START_DAMPING**2 * float(np.sum(np.abs(inner[:, k]) ** 2)) for k in nearest])
    before = [np.log(starts_hz), np.full(m, np.log(START_DAMPING)), 0.5 * force, np.zeros(m * (m - 1))]
    starts = [np.concatenate([*before, [np.log(noise)], v.T.ravel()]) for v in (at_peaks, np.eye(m))]
    theta = min((_most_probable(cost, start, f, m) for start in starts), key=lambda one: cost(one)[0])
    alpha = theta[-m * m :].reshape(m, m).T
    alpha = alpha / np.linalg.norm(alpha, axis=0)
    # a search may shorten shapes, whose lengths have no effect, below the step of the differences
    theta[-m * m :] = alpha.T.ravel()
    curvature = _curvature(cost, theta)
    rows = np.r_[:m, m : 2 * m]
    covariance = _covariance(curvature, singular=m)
    if covariance is None or not _credible(theta[:m], theta[m : 2 * m], f, covariance[m : 2 * m, m : 2 * m]):
        return None
    free = len(theta) - m + m * (n - m)
    inside = covariance[-m * m :, -m * m :].reshape(m, m, m, m)
    shape_var = [np.einsum("ai,ij,aj->a", basis, inside[i, :, i, :], basis) for i in range(m)]
    return BandPosterior(
        np.exp(theta[:m]),
        np.exp(theta[m : 2 * m]),
        basis @ alpha,
        np.array([covariance[np.ix_(rows[[i, m + i]], rows[[i, m + i]])] for i in range(m)]),
        np.sqrt(np.maximum(np.array(shape_var).T, 0.0)),
        -cost(theta)[0] - 0.5 * free * np.log(count),
    )


def several_modes_cost(
    theta: FloatArray, inner: ComplexArray, f: FloatArray, left: float, n_channels: int
) -> tuple[float, FloatArray]:
    r"""Return minus the log-posterior of several modes in their subspace, and its slope.

    With :math:`M = \Phi H F` and :math:`G = E^{-1} - E^{-1} x x^H E^{-1}` of every line, the cost changes by
    :math:`2 \Re \mathrm{tr}(M^H G\, dM) + \mathrm{tr}(G)\, dS_e`.

    Parameters
    ----------
    theta : (2 m + m² + 1 + m²,)
        ln f, ln ζ, the factor of the forces (logarithms of its diagonal, then real and imaginary parts
        below), ln Se, and the shapes in the subspace one after another; their lengths have no effect.
    inner : (m, n_lines)
        Lines in the subspace.
    left : float
        Power outside the subspace.
    """
    m = len(inner)
    f_n, zeta, noise = np.exp(theta[:m]), np.exp(theta[m : 2 * m]), float(np.exp(theta[2 * m + m * m]))
    factor = np.diag(np.exp(theta[2 * m : 3 * m])).astype(complex)
    below = np.tril_indices(m, -1)
    real, imag = np.split(theta[3 * m : 2 * m + m * m], 2)
    factor[below] = real + 1j * imag
    alpha = theta[-m * m :].reshape(m, m).T
    length = np.maximum(np.linalg.norm(alpha, axis=0), 1e-12)
    alpha = alpha / length
    h = transfer(f, f_n, zeta)
    forced = h[:, :, None] * factor
    moved = alpha @ forced
    matrix = moved @ moved.conj().transpose(0, 2, 1)
    rounding = LEAST_NOISE * np.einsum("kaa->k", matrix).real
    inverse = np.linalg.inv(matrix + (noise + rounding)[:, None, None] * np.eye(m))
    solved = (inverse @ inner.T[:, :, None])[:, :, 0]
    misfit = inverse - solved[:, :, None] * solved[:, None, :].conj()
    trace = np.einsum("kaa->k", misfit).real
    by_moved = misfit @ moved + LEAST_NOISE * trace[:, None, None] * moved
    by_alpha = 2.0 * np.real(np.einsum("kaj,kbj->ab", by_moved.conj(), forced))
    by_alpha = (by_alpha - alpha * np.sum(alpha * by_alpha, axis=0)) / length
    in_modes = alpha.T @ by_moved
    by_factor = 2.0 * np.einsum("ki,kij->ij", h.conj(), in_modes)
    by_h = 2.0 * np.einsum("kij,ij->ki", in_modes.conj(), factor)
    by_f, by_zeta = (np.real(np.sum(by_h * h * slope, axis=0)) for slope in _log_slopes(h, f, f_n, zeta))
    others = (n_channels - m) * len(f)
    quadratic = float(np.sum(np.real(inner.T.conj() * solved)))
    log_det = -float(np.sum(np.linalg.slogdet(inverse)[1]))
    slope = [
        by_f,
        by_zeta,
        np.diag(by_factor).real * np.exp(theta[2 * m : 3 * m]),
        by_factor[below].real,
        by_factor[below].imag,
        [others - left / noise + noise * np.sum(trace)],
        by_alpha.T.ravel(),
    ]
    return others * float(np.log(noise)) + left / noise + log_det + quadratic, np.concatenate(slope)


def _most_probable(cost: Cost, start: FloatArray, f: FloatArray, n_modes: int) -> FloatArray:
    """Return the parameters of least cost."""
    low, high = start - WIDE, start + WIDE
    low[: 2 * n_modes] = np.repeat(np.log([f[0], 1e-5]), n_modes)
    high[: 2 * n_modes] = np.repeat(np.log([f[-1], 0.5]), n_modes)

    def within(theta: FloatArray) -> tuple[float, FloatArray]:
        inside = np.clip(theta, low, high)
        value, slope = cost(inside)
        beyond = theta - inside
        rise = 2.0 * len(f) * beyond
        return value + len(f) * float(beyond @ beyond), np.where(beyond == 0.0, slope, rise)

    with np.errstate(all="ignore"):
        found = scipy.optimize.minimize(within, start, jac=True, method="BFGS", options={"gtol": 1e-2})
    best = np.clip(found.x, low, high)
    return np.asarray(best) if found.success else _polished(within, best)


def _polished(cost: Cost, theta: FloatArray) -> FloatArray:
    """Return the minimum near a point by Newton steps along the eigenvectors of the curvature.

    The preceding search may stop on the slope of a valley, since a large cost is rounded.
    """
    value, gradient = cost(theta)
    for _ in range(MOST_STEPS):
        curvature = _curvature(cost, theta)
        if not (np.isfinite(curvature).all() and np.isfinite(gradient).all()):
            break
        size, along = np.linalg.eigh(curvature)
        known = np.abs(size) > FLAT * np.abs(size).max()
        move = -along[:, known] @ (along[:, known].T @ gradient / np.abs(size[known]))
        if -gradient @ move < MIN_GAIN:
            break
        move *= min(1.0, MOST_MOVE / float(np.abs(move).max()))
        tries = [theta + 0.5**k * move for k in range(HALVINGS)]
        better = next((one for one in tries if cost(one)[0] < value), None)
        if better is None:
            break
        theta, (value, gradient) = better, cost(better)
    return np.asarray(theta)


def _curvature(cost: Cost, theta: FloatArray) -> FloatArray:
    """Return the second derivatives of a cost by central differences of its slope."""
    steps = STEP * np.eye(len(theta))
    out = np.array([cost(theta + e)[1] - cost(theta - e)[1] for e in steps]) / (2.0 * STEP)
    return np.asarray(0.5 * (out + out.T))


def _covariance(curvature: FloatArray, singular: int = 0) -> FloatArray | None:
    """Return the inverse of a curvature without its ``singular`` flat directions; None if not a minimum."""
    if not np.isfinite(curvature).all():
        return None
    values, vectors = np.linalg.eigh(curvature)
    order = np.argsort(np.abs(values))[singular:]
    if np.any(values[order] <= 0.0):
        return None
    return np.asarray(vectors[:, order] / values[order] @ vectors[:, order].T)


def _credible(log_f: FloatArray, log_zeta: FloatArray, f: FloatArray, covariance: FloatArray) -> bool:
    """Return whether all modes are in the band, lightly damped, and determined."""
    inside = np.all((np.exp(log_f) > f[0]) & (np.exp(log_f) < f[-1]))
    return bool(
        inside and np.all(np.exp(log_zeta) < MAX_DAMPING) and np.all(np.diag(covariance) < MAX_LOG_STD**2)
    )
