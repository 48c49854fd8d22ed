"""The damped cosines of a decay: poles of a subspace fit, as long as they explain more than noise does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.decays.damped_cosines import DampedCosines, damped_cosines
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.preparation.spectra import densities
from jackettwin.identification.subspace.ssi_cov import frequency_and_damping, order_poles, ssi_cov

ORDERS = tuple(range(2, 26, 2))
"""Model orders whose poles are tried."""
ROWS_CYCLES = 1.5
"""Number of block rows, in cycles of the strongest frequency …"""
MOST_ROWS = 60
"""… and at most so many."""
MOST_MODES = 6
MOST_REFUSED = 3
"""The search ends when so many poles have turned out to be no modes."""
APART = 0.02
"""Two modes of a decay are farther apart than this share of their frequency."""
NEAR = 0.25
"""Logarithm of the ratio of two frequencies within which two modes …"""
SAME_SHAPE = 0.9
"""… of at least this MAC are one."""
WITHIN_REACH = 0.5
"""Share of a decay that the cosines of all poles explain, below which no fit is tried: of a structure that
was let go it is 0.7 and more, of random forces that fade 0.2 to 0.9."""
SAME_COSINES = 1e-9
"""Of the largest eigenvalue of the cosines' products: smaller ones are differences of poles of one mode."""
LEAST_RATIO = 12.0
"""Least power of a mode over the power that noise has in the same cosines."""
LIGHTEST, HEAVIEST = 2e-4, 0.12
"""Range of the damping ratios of poles that are tried, and of modes that are accepted."""


@dataclass(frozen=True)
class DecayFit:
    """Modes of a decay, and how clear each is.

    Attributes
    ----------
    fit : DampedCosines
    ratio : (n_modes,)
        Power of each mode over what noise gives the same cosines.
    """

    fit: DampedCosines
    ratio: FloatArray


def modes_of_decay(
    y: FloatArray, sample_rate_hz: float, strongest_hz: float, noise: FloatArray | None
) -> DecayFit | None:
    """Return the modes of a decay, the one that explains most first taken; None if there is none.

    Parameters
    ----------
    y : (n_channels, n_samples)
        The decay, nothing missing.
    noise : (n_channels, n_more) or None
        The same channels after it.
    """
    f, zeta = _poles(y, sample_rate_hz, strongest_hz)
    about = y - y.mean(axis=1, keepdims=True)
    if not len(f) or _explained(about, sample_rate_hz, f, zeta) < WITHIN_REACH:
        return None
    open_to = list(range(len(f)))
    best: DecayFit | None = None
    left, refused = y, 0
    while open_to and (best is None or len(best.ratio) < MOST_MODES) and refused < MOST_REFUSED:
        gains = [_explained(left, sample_rate_hz, f[[i]], zeta[[i]]) for i in open_to]
        k = open_to[int(np.argmax(gains))]
        open_to = [i for i in open_to if abs(np.log(f[i] / f[k])) > APART]
        start = np.array([[f[k]], [zeta[k]]])
        if best is not None:
            start = np.hstack([[best.fit.frequency_hz, best.fit.damping_ratio], start])
        fit = damped_cosines(y, sample_rate_hz, *start, noise=noise)
        found = DecayFit(fit, _ratios(fit, sample_rate_hz, y.shape[1], noise))
        if found.ratio.min() > LEAST_RATIO and fit.damping_ratio.max() < HEAVIEST and _distinct(fit):
            best, left = found, fit.residual
        else:
            refused += 1
    return best


@dataclass(frozen=True)
class _Quiet:
    """The spectrum of what is no decay."""

    frequency_hz: FloatArray
    density: FloatArray
    sample_rate_hz: float

    @classmethod
    def of(cls, left: FloatArray, sample_rate_hz: float, noise: FloatArray | None) -> _Quiet:
        """Return that of the noise if there is enough of it, else that of what is left of the decay."""
        background = left if noise is None or noise.shape[1] < left.shape[1] // 2 else noise
        length = max(background.shape[1] // 4, 16)
        seen = densities(background, sample_rate_hz, length)
        return cls(seen.frequencies_hz, seen.density, sample_rate_hz)

    def power(self, f: float) -> FloatArray:
        """Return the power noise has along two cosines of unit power near a frequency, (n_channels,)."""
        level = [np.interp(f, self.frequency_hz, row) for row in self.density]
        return np.array(level) * self.sample_rate_hz + 1e-300


def _poles(y: FloatArray, sample_rate_hz: float, strongest_hz: float) -> tuple[FloatArray, FloatArray]:
    """Return the poles of all orders of the decay, taken as a row of covariances."""
    rows = min(max(round(ROWS_CYCLES * sample_rate_hz / strongest_hz), 6), MOST_ROWS, (y.shape[1] - 2) // 2)
    lags = y.T[:, :, None] / (y.std(axis=1)[:, None] + 1e-300)
    shifts = _sums(lags, rows)
    subspace = ssi_cov(shifts, block_rows=rows, max_order=ORDERS[-1], factors=False)
    table = [
        frequency_and_damping(p.eigenvalues, sample_rate_hz)
        for p in order_poles(subspace, subspace.orders(ORDERS))
    ]
    f, zeta = (np.concatenate([row[i] for row in table]) for i in (0, 1))
    good = (zeta > LIGHTEST) & (zeta < HEAVIEST) & (f < 0.45 * sample_rate_hz)
    return f[good], zeta[good]


def _sums(lags: FloatArray, rows: int) -> FloatArray:
    """Return the products of the decay with what comes later, which are sums of its own decays."""
    y = lags[:, :, 0].T
    n = y.shape[1]
    size = 2 * rows + 1
    head = y[:, : n - size]
    return np.stack([y[:, k : k + head.shape[1]] @ head.T / head.shape[1] for k in range(size)])


def _explained(y: FloatArray, sample_rate_hz: float, f: FloatArray, zeta: FloatArray) -> float:
    """Return the power along damped cosines, one or many, every channel over its own."""
    t = np.arange(y.shape[1]) / sample_rate_hz
    decays = np.exp(np.outer(2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2)), t))
    basis = np.concatenate([decays.real, decays.imag])
    values, vectors = np.linalg.eigh(basis @ basis.T)
    kept = values > SAME_COSINES * values[-1]
    power = np.sum((vectors[:, kept].T @ (basis @ y.T)) ** 2 / values[kept, None], axis=0)
    return float(np.mean(power / (np.sum(y**2, axis=1) + 1e-300)))


def _ratios(
    fit: DampedCosines, sample_rate_hz: float, n_samples: int, noise: FloatArray | None
) -> FloatArray:
    """Return the power of each mode over that of noise in its two cosines, (n_modes,)."""
    quiet = _Quiet.of(fit.residual, sample_rate_hz, noise)
    t = np.arange(n_samples) / sample_rate_hz
    out = []
    for f, zeta, a in zip(fit.frequency_hz, fit.damping_ratio, fit.amplitudes, strict=True):
        energy = 0.5 * np.abs(a) ** 2 * np.sum(np.exp(-4.0 * np.pi * f * zeta * t))
        out.append(float(np.mean(energy / quiet.power(float(f)))))
    return np.array(out)


def _distinct(fit: DampedCosines) -> bool:
    """Return whether all modes are apart: two near each other of one shape are one whose damping changes."""
    apart = np.abs(np.log(fit.frequency_hz[:, None] / fit.frequency_hz))
    alike = mac(fit.amplitudes, fit.amplitudes)
    same = (apart < 0.5 * APART) | ((apart < NEAR) & (alike > SAME_SHAPE))
    return int(same.sum()) == len(same)
