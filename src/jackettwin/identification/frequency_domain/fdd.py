r"""Enhanced frequency domain decomposition, for comparison with SSI.

Modes are peaks of the first singular value of the spectral matrix (FDD: Brincker, Zhang & Andersen 2001).
Around each peak, the lines whose singular vector resembles that of the peak form the bell of one mode.
The inverse transform of the bell is the covariance of that mode, a free decay whose envelope and phase give ζ
and f (EFDD).

The finite resolution of the spectrum adds damping to every mode, relatively more to lightly damped ones:
ζ of EFDD is unreliable with fewer than about ten lines in the half-power band.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.identification.estimate import Identification, ModalEstimate, Stabilisation
from jackettwin.identification.mode_shapes import aligned, mac, mpc, mpd_rad, normalised
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.preparation.spectra import CLEAR_PEAK, welch
from jackettwin.identification.preparation.whitening import as_measured
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.records import spectral_matrix
from jackettwin.signals import local_peaks, running_median

if TYPE_CHECKING:
    from jackettwin.records import Record


SEGMENT_CYCLES = 20.0
"""Length of a Welch segment, in cycles of the lower edge of the band."""
BELL_MAC = 0.8
"""Lines whose singular vector has at least this MAC with that of the peak belong to its bell."""
DECAY_FROM, DECAY_TO = 0.9, 0.3
"""Part of the envelope of the covariance that is fitted."""


def fdd(record: Record, settings: IdentificationSettings | None = None) -> Identification:
    """Identify the modes of a record by enhanced frequency domain decomposition.

    The result has the type of ``identify``, without stabilisation and uncertainty.

    Raises
    ------
    InputError
        As ``identify``.
    """
    settings = settings or IdentificationSettings()
    ready = prepare(record, settings)
    y, scale, resolved = ready.y, ready.scale, ready.settings
    rate = resolved.sample_rate_hz
    length = int(min(SEGMENT_CYCLES * rate / resolved.lowest_frequency_hz, y.shape[1] / 2))
    f, matrix = spectral_matrix(y, rate, length)
    values, vectors = principal(matrix)
    inside = (f > resolved.lowest_frequency_hz) & (f < resolved.highest_frequency_hz)
    modes = [_mode(f, values, vectors, k, scale) for k in peaks(values, inside)]
    return Identification(
        records=(record.name,),
        channels=ready.channels,
        modes=tuple(mode for mode in modes if mode is not None),
        rejected=(),
        stabilisation=Stabilisation.none(len(scale)),
        spectrum=as_measured(welch(y * scale[:, None], rate), ready.differentiated),
        settings=resolved,
        duration_s=record.duration_s,
        findings=ready.findings,
    ).unchecked("efdd")


def principal(matrix: ComplexArray) -> tuple[FloatArray, ComplexArray]:
    """Return the largest singular value and its vector at every frequency."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(values[:, -1]), np.asarray(vectors[:, :, -1])


def peaks(values: FloatArray, inside: BoolArray) -> list[int]:
    """Return the clear peaks of the largest singular value within the band."""
    level = running_median(values, max(len(values) // 10, 5), ends="reflect")
    found = local_peaks(np.log(values), prominence=np.log(2.0))
    return [int(k) for k in found if inside[k] and values[k] > CLEAR_PEAK * level[k]]


def _mode(
    f: FloatArray, values: FloatArray, vectors: ComplexArray, peak: int, scale: FloatArray
) -> ModalEstimate | None:
    """Return the mode of one bell, or None if its covariance does not decay within the segment."""
    alike = mac(vectors, vectors[peak]) > BELL_MAC
    low, high = peak, peak
    while low > 0 and alike[low - 1]:
        low -= 1
    while high < len(f) - 1 and alike[high + 1]:
        high += 1
    bell = np.zeros_like(values)
    bell[low : high + 1] = values[low : high + 1]
    step = 1.0 / (2.0 * f[-1])
    analytic = np.fft.ifft(np.concatenate([bell, np.zeros(len(bell) - 2)]))
    envelope = np.abs(analytic[: len(f)]) / np.abs(analytic[0])
    last = int(np.argmax(envelope < DECAY_TO))
    first = int(np.argmax(envelope < DECAY_FROM))
    if last - first < 3:
        return None
    t = step * np.arange(first, last)
    decay = -np.polyfit(t, np.log(envelope[first:last]), 1)[0]
    omega_d = np.polyfit(t, np.unwrap(np.angle(analytic[first:last])), 1)[0]
    size = float(np.hypot(decay, omega_d))
    shape = normalised(aligned(np.asarray(vectors[peak] * scale)))
    return ModalEstimate(
        frequency_hz=size / (2.0 * np.pi),
        damping_ratio=float(decay / size),
        mode_shape=shape,
        mpc=float(mpc(shape)),
        mpd_rad=float(mpd_rad(shape)),
        order_share=1.0,
        method="efdd",
    )
