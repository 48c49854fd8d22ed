"""Modes of a decay: poles of a subspace fit, accepted as long as they explain more power than noise would."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.identification.decays.damped_cosines import DampedCosines, damped_cosines
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.preparation.spectra import densities
from jackettwin.identification.subspace.ssi_cov import frequency_and_damping, order_poles, ssi_cov

ORDERS = tuple(range(2, 26, 2))
"""Model orders whose poles are tried."""
BLOCK_ROW_CYCLES = 1.5
"""Number of block rows, in cycles of the strongest frequency."""
MAX_ROWS = 60
"""Most block rows."""
MAX_MODES = 6
MAX_REFUSED = 3
"""Number of refused poles that ends the search."""
MIN_SEPARATION = 0.02
"""Smallest distance between two modes of a decay, relative to their frequency."""
CLOSE = 0.1
"""Largest logarithmic ratio of two frequencies that may be one pole of a lower model order."""
HALVED = 0.5
"""Two poles replace one where they leave less than this share of what it leaves unexplained."""
SAME_POLE = 1e-3
"""Largest logarithmic ratio of two frequencies that are one, whatever their shapes."""
SAME_MODE_DISTANCE = 0.25
"""Largest logarithmic ratio of two frequencies of similar shapes that count as one mode."""
SAME_SHAPE = 0.9
"""Smallest MAC of shapes that count as one mode."""
MIN_EXPLAINED_BY_POLES = 0.5
"""Share of a decay explained by the cosines of all poles below which no fit is tried:
for a released structure it is 0.7 or more, for random forces that fade 0.2 to 0.9."""
MIN_EIGENVALUE = 1e-9
"""Smallest eigenvalue of the cosines' Gram matrix that is used, relative to the largest; smaller ones belong
to differences between nearly equal poles."""
MIN_RATIO = 12.0
"""Smallest ratio of the power of a mode to the power of noise in the same cosines."""
MIN_DAMPING_RATIO, MAX_DAMPING_RATIO = 2e-4, 0.12
"""Range of the damping ratios of poles that are tried, and of modes that are accepted."""


@dataclass(frozen=True)
class DecayFit:
    """Modes of a decay and their signal-to-noise ratios.

    Attributes
    ----------
    fit : DampedCosines
    ratio : (n_modes,)
        Power of each mode over the power of noise in the same cosines.
    """

    fit: DampedCosines
    ratio: FloatArray


def modes_of_decay(
    y: FloatArray, sample_rate_hz: float, strongest_hz: float, noise: FloatArray | None
) -> DecayFit | None:
    """Return the modes of a decay, added in the order of the power they explain; None if there is none.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples of the decay, none missing.
    noise : (n_channels, n_more) or None
        The same channels after the decay.
    """
    f, zeta, order = _poles(y, sample_rate_hz, strongest_hz)
    about = y - y.mean(axis=1, keepdims=True)
    if not len(f) or _explained(about, sample_rate_hz, f, zeta) < MIN_EXPLAINED_BY_POLES:
        return None
    open_to = list(range(len(f)))
    best: DecayFit | None = None
    left, refused = y, 0
    while open_to and (best is None or len(best.ratio) < MAX_MODES) and refused < MAX_REFUSED:
        gains = [_explained(left, sample_rate_hz, f[[i]], zeta[[i]]) for i in open_to]
        k = open_to[int(np.argmax(gains))]
        open_to = [i for i in open_to if abs(np.log(f[i] / f[k])) > MIN_SEPARATION]
        for new in (*_pair_in_place_of(left, sample_rate_hz, f, zeta, order, k), [k]):
            start = np.stack([f[new], zeta[new]])
            if best is not None:
                start = np.hstack([[best.fit.frequency_hz, best.fit.damping_ratio], start])
            fit = damped_cosines(y, sample_rate_hz, *start, noise=noise)
            found = DecayFit(fit, _ratios(fit, sample_rate_hz, y.shape[1], noise))
            clear = found.ratio.min() > MIN_RATIO and fit.damping_ratio.max() < MAX_DAMPING_RATIO
            if clear and _distinct(fit):
                best, left = found, fit.residual
                open_to = [i for i in open_to if np.abs(np.log(f[i] / f[new])).min() > MIN_SEPARATION]
                break
        else:
            refused += 1
    return best


@dataclass(frozen=True)
class _Background:
    """Spectrum of the background of a decay."""

    frequency_hz: FloatArray
    density: FloatArray
    sample_rate_hz: float

    @classmethod
    def of(cls, left: FloatArray, sample_rate_hz: float, noise: FloatArray | None) -> _Background:
        """Return the spectrum of the noise after the decay if that is long enough, else of the residual."""
        background = left if noise is None or noise.shape[1] < left.shape[1] // 2 else noise
        length = max(background.shape[1] // 4, 16)
        seen = densities(background, sample_rate_hz, length)
        return cls(seen.frequencies_hz, seen.density, sample_rate_hz)

    def power(self, f: float) -> FloatArray:
        """Return the noise power along two cosines of unit power near a frequency, (n_channels,)."""
        level = [np.interp(f, self.frequency_hz, row) for row in self.density]
        return np.array(level) * self.sample_rate_hz + 1e-300


def _pair_in_place_of(
    y: FloatArray, sample_rate_hz: float, f: FloatArray, zeta: FloatArray, order: IntArray, k: int
) -> list[list[int]]:
    """Return two poles of one model order beside a pole that explain what it alone leaves, or nothing.

    A low order has one pole for both modes of a close pair, between them, and alone it explains the most.
    What other modes explain is left out: their poles of the same order stand beside the pair, and the one.
    """
    close = np.abs(np.log(f / f[k])) < CLOSE
    pairs = [[int(i), int(j)] for i, j in combinations(np.flatnonzero(close), 2) if order[i] == order[j]]
    shares = []
    for pair in pairs:
        others = np.flatnonzero((order == order[pair[0]]) & ~close).tolist()
        two, one = (_explained(y, sample_rate_hz, f[own + others], zeta[own + others]) for own in (pair, [k]))
        shares.append((1.0 - two) / max(1.0 - one, 1e-300))
    return [pairs[int(np.argmin(shares))]] if min(shares, default=1.0) < HALVED else []


def _poles(
    y: FloatArray, sample_rate_hz: float, strongest_hz: float
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the poles of the decay for all orders, and which order each is of.

    They are those of subspace identification from its lagged products.
    """
    rows = min(
        max(round(BLOCK_ROW_CYCLES * sample_rate_hz / strongest_hz), 6), MAX_ROWS, (y.shape[1] - 2) // 2
    )
    lags = y.T[:, :, None] / (y.std(axis=1)[:, None] + 1e-300)
    shifts = _lagged_products(lags, rows)
    subspace = ssi_cov(shifts, block_rows=rows, max_order=ORDERS[-1], factors=False)
    table = [
        frequency_and_damping(p.eigenvalues, sample_rate_hz)
        for p in order_poles(subspace, subspace.orders(ORDERS))
    ]
    f, zeta = (np.concatenate([row[i] for row in table]) for i in (0, 1))
    order = np.repeat(np.arange(len(table)), [len(row[0]) for row in table])
    good = (zeta > MIN_DAMPING_RATIO) & (zeta < MAX_DAMPING_RATIO) & (f < 0.45 * sample_rate_hz)
    return f[good], zeta[good], order[good]


def _lagged_products(lags: FloatArray, rows: int) -> FloatArray:
    """Return products of the decay with its later samples, which are sums of decays with the same poles."""
    y = lags[:, :, 0].T
    n = y.shape[1]
    size = 2 * rows + 1
    head = y[:, : n - size]
    return np.stack([y[:, k : k + head.shape[1]] @ head.T / head.shape[1] for k in range(size)])


def _explained(y: FloatArray, sample_rate_hz: float, f: FloatArray, zeta: FloatArray) -> float:
    """Return the share of power explained by one or more damped cosines, averaged over channels."""
    t = np.arange(y.shape[1]) / sample_rate_hz
    decays = np.exp(np.outer(2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2)), t))
    basis = np.concatenate([decays.real, decays.imag])
    values, vectors = np.linalg.eigh(basis @ basis.T)
    kept = values > MIN_EIGENVALUE * values[-1]
    power = np.sum((vectors[:, kept].T @ (basis @ y.T)) ** 2 / values[kept, None], axis=0)
    return float(np.mean(power / (np.sum(y**2, axis=1) + 1e-300)))


def _ratios(
    fit: DampedCosines, sample_rate_hz: float, n_samples: int, noise: FloatArray | None
) -> FloatArray:
    """Return the ratio of the power of each mode to that of noise in its two cosines, (n_modes,)."""
    quiet = _Background.of(fit.residual, sample_rate_hz, noise)
    t = np.arange(n_samples) / sample_rate_hz
    out = []
    for f, zeta, a in zip(fit.frequency_hz, fit.damping_ratio, fit.amplitudes, strict=True):
        energy = 0.5 * np.abs(a) ** 2 * np.sum(np.exp(-4.0 * np.pi * f * zeta * t))
        out.append(float(np.mean(energy / quiet.power(float(f)))))
    return np.array(out)


def _distinct(fit: DampedCosines) -> bool:
    """Tell whether all modes differ; two close ones of one shape are one mode whose damping varies."""
    apart = np.abs(np.log(fit.frequency_hz[:, None] / fit.frequency_hz))
    alike = mac(fit.amplitudes, fit.amplitudes)
    same = (apart < SAME_POLE) | ((apart < SAME_MODE_DISTANCE) & (alike > SAME_SHAPE))
    return int(same.sum()) == len(same)
