r"""Recognition of modes whose directions turn within a record, as with the nacelle of a tower.

Two modes of a tower lie close together and move it in two directions. In the plane of their shapes each has
a direction d that the other one does not reach. With :math:`M_0 = \sum_k S_k` and
:math:`M_1 = \sum_k f_k S_k` of the spectral matrices S around the pair, these directions solve

.. math:: M_1 d = \nu M_0 d ,

where ν is the mean frequency of each mode, whatever forces act on either of them. Directions found in a part
of one half of the record tell the modes apart in the rest of that half. In the other half they do so as well,
with the same sign; if the modes have turned by a right angle, the sign is the opposite. Otherwise a turned
pair would have two clear shapes in directions that no mode has, and dampings between those of both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import LinAlgError, eigh

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.findings import Finding
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.tones.sinusoid import transform
from jackettwin.signals import of_fast_length

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import ModalEstimate

CLOSE_RATIO, BAND = 1.15, 0.12
"""Largest ratio of the frequencies of a pair, and the band around it as a share of its frequencies."""
BLOCKS, MIN_CYCLES = 16, 5.0
"""Blocks of the record, half of them on either side, and fewest cycles of each."""
MIN_PLANE = 0.9
"""Least share of the energy of the band that two shapes must explain."""
TOLD_APART, TURNED = 3.0, 4.0
"""Standard deviations by which directions must tell the two modes apart in their own half, and must exchange
them in the other. Pairs that do not turn, 0.4 to 7 % apart, some under forces that exchange their sizes half
way, reach both in at most one of two hundred records of ten minutes; pairs 4 % apart at 0.3 Hz that turn by
90° do in 93 %."""


def turning_doubted(
    modes: Sequence[ModalEstimate], y: FloatArray, sample_rate_hz: float
) -> tuple[ModalEstimate, ...]:
    """Return the modes; all close pairs are doubtful if the directions of one turn within the record.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples without tones, each channel with about the same rms; NaN marks a missing one.
    """
    pairs = [
        (i, i + 1)
        for i in range(len(modes) - 1)
        if modes[i + 1].frequency_hz < CLOSE_RATIO * modes[i].frequency_hz
    ]
    if not pairs or len(y) < 2:
        return tuple(modes)
    used = of_fast_length(y)
    lines = transform(used)
    hz = np.arange(lines.shape[1]) * (sample_rate_hz / used.shape[1])
    for i, j in pairs:
        low, high = modes[i].frequency_hz * (1.0 - BAND), modes[j].frequency_hz * (1.0 + BAND)
        low = max(low, 0.5 * (modes[i - 1].frequency_hz + modes[i].frequency_hz)) if i else low
        if j + 1 < len(modes):
            high = min(high, 0.5 * (modes[j].frequency_hz + modes[j + 1].frequency_hz))
        band = (hz >= low) & (hz <= high)
        if low * used.shape[1] / sample_rate_hz >= BLOCKS * MIN_CYCLES and _turns(lines[:, band], hz[band]):
            doubted = {k for pair in pairs for k in pair}
            reason = Finding("turns")
            return tuple(
                m.flagged(ModeStatus.DOUBTFUL, reason) if k in doubted else m for k, m in enumerate(modes)
            )
    return tuple(modes)


def _turns(lines: ComplexArray, hz: FloatArray) -> bool:
    """Tell whether the directions of the two modes in a band are exchanged between the halves of a record."""
    if lines.shape[1] < 2 * BLOCKS:
        return False
    energy, shapes = np.linalg.eigh(np.real(lines @ lines.conj().T))
    if energy[-2:].sum() < MIN_PLANE * energy.sum():
        return False
    m0, m1 = _moments(shapes[:, -2:].T @ lines, hz - hz.mean())
    first, second = np.arange(BLOCKS // 2), np.arange(BLOCKS // 2, BLOCKS)
    own, other = np.zeros(2), np.zeros(2)
    try:
        for half, opposite in ((first, second), (second, first)):
            for odd in (0, 1):
                learned = half[odd::2]
                directions = eigh(m1[learned].sum(axis=0), m0[learned].sum(axis=0))[1]
                own += _apart(directions, m0, m1, half[1 - odd :: 2])
                other += _apart(directions, m0, m1, opposite)
    except LinAlgError:  # motion in one direction only
        return False
    return bool(own[0] > TOLD_APART * np.sqrt(own[1]) and other[0] < -TURNED * np.sqrt(other[1]))


def _moments(lines: ComplexArray, hz: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return power, and power times frequency, (n_blocks, 2, 2), of the envelope in blocks of the record."""
    room = 2 ** int(np.ceil(np.log2(2 * len(hz))))
    z, moved = (np.fft.ifft(x, n=room, axis=1).reshape(2, BLOCKS, -1) for x in (lines, lines * hz))
    m0 = np.real(np.einsum("ibt,jbt->bij", z, z.conj()))
    m1 = np.real(np.einsum("ibt,jbt->bij", moved, z.conj()))
    return m0, 0.5 * (m1 + m1.transpose(0, 2, 1))


def _apart(directions: FloatArray, m0: FloatArray, m1: FloatArray, blocks: Int64Array) -> FloatArray:
    """Return how much higher the motion along the second direction is [Hz], and the variance of that."""
    power, times_hz = (np.einsum("ij,bik,kj->bj", directions, m[blocks], directions) for m in (m0, m1))
    mean = times_hz.sum(axis=0) / power.sum(axis=0)
    each = (times_hz - mean * power) / power.sum(axis=0)
    n = len(blocks)
    return np.array([mean[1] - mean[0], np.sum((each[:, 1] - each[:, 0]) ** 2) * n / (n - 1)])
