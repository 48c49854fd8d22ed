"""Report of peaks above the band of an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.findings import Finding
from jackettwin.identification.preparation.spectra import densities
from jackettwin.identification.selection.peaks import clear_peaks_hz
from jackettwin.quantities import VIBRATIONS
from jackettwin.records import detrend

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ResolvedSettings, Spectrum
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.records import Record

LINES_BELOW = 200
"""Spectral lines up to the upper edge of the band: a peak of one per cent damping has a width of two
lines."""
MOST_SHARE = 1.0 / 16.0
"""Longest segment as a share of the record: the average of thirty segments has no peaks of noise."""
PASSED = 0.8
"""Share of the Nyquist frequency up to which a logger's filter passes signals."""
APART = 1.05
"""Smallest ratio of the frequencies of two reported peaks."""
NAMED = 6
"""Largest number of reported peaks."""


def peaks_above(
    record: Record, settings: IdentificationSettings, resolved: ResolvedSettings
) -> tuple[Finding, ...]:
    """Return the finding on clear peaks above the band; none if the user set the band."""
    if settings.highest_frequency_hz is not None:
        return ()
    spectrum = spectrum_above(record, resolved.highest_frequency_hz)
    return () if spectrum is None else peaks_in(spectrum, resolved)


def spectrum_above(record: Record, edge_hz: float) -> Spectrum | None:
    """Return the densities of the vibrating channels; None if the record hardly reaches above the edge."""
    rate = record.sample_rate_hz
    length = min(int(LINES_BELOW * rate / edge_hz), int(MOST_SHARE * record.data.shape[1]))
    if edge_hz >= 0.5 * PASSED * rate or length < LINES_BELOW // 4:
        return None
    names = [
        c.name
        for c, y in zip(record.channels, record.data, strict=True)
        if c.quantity in VIBRATIONS and np.isfinite(y).any() and np.nanstd(y) > 0.0
    ]
    return densities(detrend(record.select(names)).data, rate, length) if names else None


def peaks_in(spectrum: Spectrum, resolved: ResolvedSettings) -> tuple[Finding, ...]:
    """Return the finding on clear peaks of densities above a band."""
    edge, top_hz = resolved.highest_frequency_hz, PASSED * float(spectrum.frequencies_hz[-1])
    inside = spectrum.frequencies_hz < top_hz
    found = clear_peaks_hz(spectrum.frequencies_hz[inside], spectrum.density[:, inside])
    above = [f for f in found if f > edge]
    apart = [f for f, below in zip(above, [0.0, *above], strict=False) if f > APART * below]
    if not apart:
        return ()
    listed = ", ".join(f"{f:.3g}" for f in apart[:NAMED]) + (" …" if len(apart) > NAMED else "")
    low, top = resolved.lowest_frequency_hz, min(1.2 * apart[-1], top_hz)
    params: dict[str, float | int | str | bool | None]
    count = "a clear peak" if len(apart) == 1 else f"{len(apart)} clear peaks"
    params = {"peaks": listed, "count": count, "edge": edge, "widen": f"{low:.2g},{top:.3g}"}
    return (Finding("peaks_above_band", params=params),)
