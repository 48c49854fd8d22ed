"""Tones of the electrical mains: 50 or 60 Hz, or the frequencies to which sampling aliases them."""

from __future__ import annotations

MAINS_HZ = (50.0, 60.0)
FREQUENCY_TOLERANCE = 1e-3
"""Largest relative deviation of the frequency of the mains: ±0.05 Hz in a healthy grid of 50 Hz."""
LINES = 1.0
"""Uncertainty of the frequency of a tone, in Fourier lines."""


def is_mains(frequency_hz: float, sample_rate_hz: float, duration_s: float) -> bool:
    """Tell whether a steady tone is at a frequency of the mains or an alias of it.

    Examples
    --------
    >>> is_mains(10.01, 30.0, 600.0), is_mains(2.0, 24.0, 600.0), is_mains(50.0, 2000.0, 600.0)
    (True, True, True)
    >>> is_mains(9.8, 30.0, 600.0)
    False
    """
    folded = [abs(mains - sample_rate_hz * round(mains / sample_rate_hz)) for mains in MAINS_HZ]
    reach = [FREQUENCY_TOLERANCE * mains + LINES / duration_s for mains in MAINS_HZ]
    return any(abs(frequency_hz - f) < r for f, r in zip(folded, reach, strict=True))
