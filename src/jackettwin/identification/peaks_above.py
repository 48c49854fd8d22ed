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
    from jackettwin.identification.estimate import ResolvedSettings
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
) -> tuple[str, ...]:
    """Return the sentence on clear peaks above the band; none if the user set the band."""
    edge, rate = resolved.highest_frequency_hz, record.sample_rate_hz
    if settings.highest_frequency_hz is not None or edge >= 0.5 * PASSED * rate:
        return ()
    rows = [i for i, c in enumerate(record.channels) if c.quantity in VIBRATIONS]
    y = record.data[rows]
    rows = [i for i, row in zip(rows, y, strict=True) if np.isfinite(row).any() and np.nanstd(row) > 0.0]
    length = min(int(LINES_BELOW * rate / edge), int(MOST_SHARE * y.shape[1]))
    if not rows or length < LINES_BELOW // 4:
        return ()
    vibrating = record.select([record.channels[i].name for i in rows])
    seen = densities(detrend(vibrating).data, rate, length)
    inside = seen.frequencies_hz < 0.5 * PASSED * rate
    found = [f for f in clear_peaks_hz(seen.frequencies_hz[inside], seen.density[:, inside]) if f > edge]
    apart = [f for f, below in zip(found, [0.0, *found], strict=False) if f > APART * below]
    if not apart:
        return ()
    listed = ", ".join(f"{f:.3g}" for f in apart[:NAMED]) + (" …" if len(apart) > NAMED else "")
    low, top = resolved.lowest_frequency_hz, min(1.2 * apart[-1], 0.5 * PASSED * rate)
    params: dict[str, float | int | str | bool | None]
    count = "a clear peak" if len(apart) == 1 else f"{len(apart)} clear peaks"
    params = {"peaks": listed, "count": count, "edge": edge, "widen": f"{low:.2g},{top:.3g}"}
    return (str(Finding("peaks_above_band", params=params)),)
