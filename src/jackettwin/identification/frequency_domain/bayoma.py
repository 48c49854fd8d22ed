"""Bayesian operational modal analysis by the fast Fourier transform (BAYOMA), with posterior deviations.

Bands around the peaks of the spectrum are evaluated one by one by ``band_posterior.py``.
Au, S.K. 2017, Operational Modal Analysis, Springer, chapters 12 and 13.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.estimate import Identification, ModalEstimate, Stabilisation
from jackettwin.identification.frequency_domain.band_posterior import (
    MOST_MODES,
    BandPosterior,
    band_posterior,
)
from jackettwin.identification.frequency_domain.fdd import peaks, principal
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.mode_shapes import aligned, mpc, mpd_rad, normalised
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.preparation.whitening import as_measured
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.records import spectral_matrix

if TYPE_CHECKING:
    from jackettwin.records import Record


SEGMENT_CYCLES = 40.0
"""Length of Welch segments for finding peaks, in cycles of the lower edge of the band."""
BAND_SHARE = 0.08
"""Half width of a mode's band as a share of its frequency: eight half bandwidths at one per cent damping."""
MIN_HALF_LINES = 12
"""Fewest spectral lines on either side of a mode."""


def bayoma(record: Record, settings: IdentificationSettings | None = None) -> Identification:
    """Identify the modes of a record by BAYOMA.

    The result has the type of ``identify``, with posterior deviations and without stabilisation.

    Raises
    ------
    InputError
        As ``identify``.
    """
    settings = settings or IdentificationSettings()
    ready = prepare(record, settings)
    resolved, rate = ready.settings, ready.settings.sample_rate_hz
    y = np.where(np.isfinite(ready.y), ready.y, 0.0)
    duration_s = y.shape[1] / rate
    lines = np.fft.rfft(y, axis=1)
    f = np.arange(lines.shape[1]) / duration_s
    length = int(min(SEGMENT_CYCLES * rate / resolved.lowest_frequency_hz, y.shape[1] / 4))
    g, matrix = spectral_matrix(y, rate, length)
    values, _ = principal(matrix)
    inside = (g > resolved.lowest_frequency_hz) & (g < resolved.highest_frequency_hz)
    modes: list[ModalEstimate] = []
    for low, high, starts in _bands([float(g[k]) for k in peaks(values, inside)], duration_s):
        at = (f >= low) & (f <= high) & (f > 0.0)
        best = band_posterior(lines[:, at], f[at], starts)
        if best is not None:
            modes += _estimates(best, ready.scale, duration_s)
    return Identification(
        records=(record.name,),
        channels=ready.channels,
        modes=tuple(sorted(modes, key=lambda mode: mode.frequency_hz)),
        rejected=(),
        stabilisation=Stabilisation.none(len(ready.scale)),
        spectrum=as_measured(welch(ready.y * ready.scale[:, None], rate), ready.differentiated),
        settings=resolved,
        duration_s=record.duration_s,
        findings=ready.findings,
    ).unchecked("bayoma")


def _bands(peaks_hz: list[float], duration_s: float) -> list[tuple[float, float, list[float]]]:
    """Return lower and upper edge of every band and its peaks; overlapping bands are merged.

    Neighbouring bands end half way between their peaks unless these are closer than one half width.

    >>> [(round(a, 2), round(b, 2), n) for a, b, n in _bands([1.0, 1.05, 2.0], 600.0)]
    [(0.92, 1.13, [1.0, 1.05]), (1.84, 2.16, [2.0])]
    """
    groups: list[list[float]] = []
    for peak in sorted(peaks_hz):
        joins = groups and len(groups[-1]) < MOST_MODES and peak - groups[-1][-1] < _half(peak, duration_s)
        groups = [*groups[:-1], [*groups[-1], peak]] if joins else [*groups, [peak]]
    edges = [(g[0] - _half(g[0], duration_s), g[-1] + _half(g[-1], duration_s)) for g in groups]
    out = []
    for k, group in enumerate(groups):
        low, high = edges[k]
        if k:
            low = max(low, 0.5 * (groups[k - 1][-1] + group[0]))
        if k + 1 < len(groups):
            high = min(high, 0.5 * (group[-1] + groups[k + 1][0]))
        out.append((max(low, 0.0), high, group))
    return out


def _half(peak_hz: float, duration_s: float) -> float:
    return max(BAND_SHARE * peak_hz, MIN_HALF_LINES / duration_s)


def _estimates(found: BandPosterior, scale: FloatArray, duration_s: float) -> list[ModalEstimate]:
    out = []
    for i, (f, zeta) in enumerate(zip(found.frequency_hz, found.damping_ratio, strict=True)):
        measured = found.shapes[:, i] * scale
        shape = normalised(aligned(measured.astype(complex)))
        mode = ModalEstimate(
            frequency_hz=float(f),
            damping_ratio=float(zeta),
            mode_shape=shape,
            mpc=float(mpc(shape)),
            mpd_rad=float(mpd_rad(shape)),
            order_share=1.0,
            method="bayoma",
            mode_shape_std=found.shape_std[:, i] * scale / np.abs(measured).max(),
            damping_ratio_cov_limit=float(long_data_limits(f, zeta, duration_s)[1]),
        )
        out.append(mode.with_covariance(found.log_covariance[i]))
    return out
