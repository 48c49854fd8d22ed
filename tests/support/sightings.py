"""One mode seen in many records."""

from collections.abc import Sequence

import numpy as np

from jackettwin.identification import ModalEstimate
from jackettwin.identification.many_records.sightings import Sightings, log_covariance
from jackettwin.identification.maximum_likelihood.line_likelihood import LOG_ZETA, NOISE_WEIGHTS


def sightings(modes: Sequence[ModalEstimate], duration_s: Sequence[float]) -> Sightings:
    """Return one mode seen in records of these lengths, one after the other."""
    n = np.arange(len(modes), dtype=np.int64)
    return Sightings(
        record=n,
        mode=np.zeros_like(n),
        frequency_hz=np.array([mode.frequency_hz for mode in modes]),
        damping_ratio=np.array([mode.damping_ratio for mode in modes]),
        duration_s=np.asarray(duration_s, dtype=float),
        log_covariance=np.array([log_covariance(mode) for mode in modes]).reshape(-1, 2, 2),
        severity=np.array([mode.status.severity for mode in modes], dtype=np.int64),
        damping_log_likelihood=np.full((len(modes), len(NOISE_WEIGHTS), len(LOG_ZETA)), np.nan),
    )
