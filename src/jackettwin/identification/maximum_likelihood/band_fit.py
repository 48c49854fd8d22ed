"""Result of a maximum-likelihood fit of the modes of a band."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.arrays import FloatArray, Int64Array


@dataclass(frozen=True)
class BandFit:
    """Maximum-likelihood estimates of the modes of a band.

    Attributes
    ----------
    candidate : (n_modes,) int
        Index among the candidates.
    frequency_hz, damping_ratio : (n_modes,)
        Corrected for the small sample.
    shapes : (n_modes, n_channels)
        Real parts.
    covariance : (n_modes, 2, 2)
        Of (ln f, ln ζ).
    shape_covariance : (n_modes, n_channels, n_channels)
    cramer_rao : (n_modes, 2)
        Smallest attainable standard deviations of ln f and ln ζ of the fitted model.
    gain : (n_candidates,)
        Log-likelihood that a doubtful candidate would add; infinite for sure ones.
    lack_of_fit : float
        ``accuracy.lack_of_fit``: near 1 where the model describes the record.
    converged : bool
    """

    candidate: Int64Array
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    shapes: FloatArray
    covariance: FloatArray
    shape_covariance: FloatArray
    cramer_rao: FloatArray
    gain: FloatArray
    lack_of_fit: float
    converged: bool
