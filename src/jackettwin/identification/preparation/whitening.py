r"""Whitening: velocities and displacements are differentiated before identification.

Above the first mode the spectrum of a displacement falls as :math:`f^{-4}`, whereas that of the acceleration
is level. Such a slope hides peaks, needs model orders of its own and causes leakage, so that the result would
depend on the measured quantity. All channels are converted to acceleration by

.. math:: \frac{d^n y}{dt^n} \;\leftrightarrow\; (i\omega)^n\, Y(\omega), \qquad
          n = 0, 1, 2 \text{ for acceleration, velocity, displacement}.

A derivative is a linear filter: it multiplies a mode by :math:`\lambda^n` and preserves its pole and,
if all channels are treated alike, its shape. One derivative fewer is taken if sensor noise, which
differentiation amplifies, would dominate the spectrum. One more is taken if the spectrum still falls steeply,
as that of an undeclared integral does.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.interpolate is loaded where it is used

from jackettwin.arrays import FloatArray, Int64Array
from jackettwin.identification.preparation.spectra import densities, lowest_peak_hz, of_one_channel

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.estimate import Spectrum
    from jackettwin.records import Channel, Record


DERIVATIVES = {"acceleration": 0, "velocity": 1, "displacement": 2, "strain": 2, "inclination": 2}
"""Number of time derivatives from a quantity to acceleration."""
MAX_DERIVATIVES = 2
"""From displacement to acceleration."""
MAX_EXPONENT = 1.5
"""Exponent of the spectrum over frequency above which one derivative is left out: accelerations under white
forces have 0 to 0.7, white sensor noise has 2 per derivative."""
MIN_EXPONENT = -3.0
"""Exponent below which one derivative is added: accelerations under turbulence have −1 to −2, displacements
under white forces −4."""
OCTAVES = 4.0
"""Octaves above the lowest peak over which the exponent is taken."""
MAX_RATE_SHARE = 0.4
"""Upper limit of that range, as a share of the sample rate."""
MIN_LINES = 16
"""Fewest spectral lines for an exponent."""
HALF_LENGTH = 32
"""Half length of the differentiating filter in samples."""
KAISER_BETA = 8.0
"""Parameter of its Kaiser window: accurate to 5e-4 up to 0.8 of Nyquist, the passband of decimation."""


def accelerated(record: Record, *, as_declared: bool = False) -> tuple[Record, Int64Array]:
    """Return the record differentiated towards acceleration, and the derivatives per channel, (n_channels,).

    Parameters
    ----------
    record : Record
        Vibration channels without trend; NaN marks a missing sample.
    as_declared : bool
        Use the declared quantities alone, because the spectrum of a decay does not show them.

    Examples
    --------
    >>> from jackettwin.records import Channel, Record
    >>> t = np.arange(4000) / 20.0
    >>> y = np.array([np.sin(2 * np.pi * t)]) + 1e-3 * np.random.default_rng(1).standard_normal(4000)
    >>> fast, times = accelerated(Record(y, 20.0, (Channel("v", "velocity", "m/s"),)))
    >>> bool(abs(fast.data[0].std() / (2 * np.pi * y.std()) - 1.0) < 1e-2), int(times[0])
    (True, 1)
    """
    declared = np.array([DERIVATIVES[c.quantity] for c in record.channels], dtype=np.int64)
    more = 0 if as_declared else _more(record, declared)
    times = np.clip(declared + more, 0, MAX_DERIVATIVES)
    if not times.any():
        return record, times
    rate = record.sample_rate_hz
    data = np.stack([differentiated(y, rate, int(n)) for y, n in zip(record.data, times, strict=True)])
    return replace(record, data=data), times


def differentiated(y: FloatArray, sample_rate_hz: float, times: int) -> FloatArray:
    """Return the derivative of samples (n_samples,) with respect to time; gaps stay gaps.

    The filter needs samples on either side. Gaps are bridged by a cubic spline;
    the ends are extended by point reflection, which preserves the slope.
    """
    there = np.isfinite(y)
    if not times or there.sum() < 2 * HALF_LENGTH:
        return y
    out = y
    if not there.all():
        t = np.arange(len(y))
        out = np.where(there, y, scipy.interpolate.CubicSpline(t[there], y[there], bc_type="natural")(t))
        first, last = np.flatnonzero(there)[[0, -1]]
        out[:first], out[last + 1 :] = y[first], y[last]
    for _ in range(times):
        padded = np.pad(out, HALF_LENGTH, mode="reflect", reflect_type="odd")
        out = np.convolve(padded, _taps(), mode="valid") * sample_rate_hz
    return np.where(there, out, np.nan)


def left_to_differentiate(channels: Iterable[Channel], times: Int64Array) -> list[int]:
    """Return the derivatives still needed for acceleration; negative values mean integration."""
    return [DERIVATIVES[c.quantity] - int(n) for c, n in zip(channels, times, strict=True)]


def as_measured(spectrum: Spectrum, times: Int64Array) -> Spectrum:
    """Return a spectrum with the densities of the channels before differentiation."""
    if not times.any():
        return spectrum
    omega = 2.0 * np.pi * spectrum.frequencies_hz
    if omega[0] == 0.0:
        omega[0] = omega[1]
    return replace(spectrum, density=spectrum.density / omega ** (2 * times[:, None]))


def _taps() -> FloatArray:
    """Return the ideal differentiator (−1)ᵐ/m under a Kaiser window, per sample."""
    m = np.arange(-HALF_LENGTH, HALF_LENGTH + 1)
    ideal = np.where(m == 0, 0.0, (-1.0) ** m / np.where(m == 0, 1, m))
    return np.asarray(ideal * np.kaiser(len(m), KAISER_BETA))


def _more(record: Record, declared: Int64Array) -> int:
    """Return the number of derivatives, beyond the declared ones, that make the spectrum most level."""
    if record.data.shape[1] < 2 * HALF_LENGTH:  # too short to be identified, which ``resolve`` reports
        return 0
    spectrum = densities(record.data, record.sample_rate_hz)
    for more in range(MAX_DERIVATIVES - int(declared.min()), -int(declared.max()) - 1, -1):
        if more <= 0 and _exponent(spectrum, declared + more) <= MAX_EXPONENT:
            break
    while (declared + more).min() < MAX_DERIVATIVES and (
        _exponent(spectrum, declared + more) < MIN_EXPONENT or _hides_a_peak(spectrum, declared + more)
    ):
        more += 1
    return more


def _hides_a_peak(spectrum: Spectrum, times: Int64Array) -> bool:
    """Tell whether the mean spectrum of the channels has a peak only after one more derivative."""
    return _peak_hz(spectrum, times) is None and _peak_hz(spectrum, times + 1) is not None


def _peak_hz(spectrum: Spectrum, times: Int64Array) -> float | None:
    level = np.append(0.0, _level(spectrum, times))[None, :]
    density = spectrum.density * spectrum.frequencies_hz ** (2 * times[:, None])
    seen = replace(spectrum, density=density, singular_values=level)
    return of_one_channel(seen, lowest_peak_hz(seen))


def _level(spectrum: Spectrum, times: Int64Array) -> FloatArray:
    """Return the mean of the channels' spectra, each of unit power, from the first line on."""
    density = spectrum.density[:, 1:] * spectrum.frequencies_hz[1:] ** (2 * times[:, None])
    power = np.maximum(density.mean(axis=1, keepdims=True), 1e-300)
    return np.asarray(np.mean(density / power, axis=0))


def _exponent(spectrum: Spectrum, times: Int64Array) -> float:
    """Return the exponent of the channels' mean spectrum over frequency above its lowest peak.

    If there is no peak, the highest octaves are used.
    """
    f, level = spectrum.frequencies_hz[1:], _level(spectrum, times)
    highest = MAX_RATE_SHARE * 2.0 * f[-1]
    peak = _peak_hz(spectrum, times)
    lowest = highest / 2.0**OCTAVES if peak is None else peak
    inside = (f >= lowest) & (f <= min(lowest * 2.0**OCTAVES, highest)) & (level > 0.0)
    if inside.sum() < MIN_LINES:
        return 0.0
    log_f, log_s = np.log(f[inside]), np.log(level[inside])
    return float(np.polyfit(log_f, log_s, 1, w=1.0 / np.sqrt(f[inside]))[0])
