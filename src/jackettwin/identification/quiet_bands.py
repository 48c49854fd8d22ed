"""Further search for poles around peaks without a mode, for weak modes hidden by strong ones.

The amplitude of a tower's first modes may be a thousand times that of its fifth.
Errors of their covariances then exceed the contribution of the fifth,
although its peak is clear in the spectrum of a channel. For each clear peak that no candidate explains,
the samples are high-passed and poles are sought in the octave that begins there, at the rate that it needs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.estimate import Stabilisation
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.pole_methods import poles_of
from jackettwin.identification.preparation.resolve import EDGE_BELOW_PEAK, GUARD, SAMPLES_PER_CYCLE
from jackettwin.identification.preparation.spectra import densities
from jackettwin.identification.selection.candidates import Tones, candidates, find_tones
from jackettwin.identification.selection.clustering import clusters
from jackettwin.identification.selection.peaks import clear_peaks_hz
from jackettwin.identification.selection.second_look import SecondLook, second_look
from jackettwin.identification.tones.steady_tones import without_tones
from jackettwin.records import less_phase
from jackettwin.records.processing.filters import lowpass_taps, resample

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.selection.candidates import Candidate
    from jackettwin.identification.selection.clustering import Cluster
    from jackettwin.identification.settings import IdentificationSettings

EXPLAINS = 3.0
"""Distance from a mode, in half bandwidths or spectral lines, within which it explains a peak."""
TRANSITION = 0.8
"""Stop edge of the high-pass filter as a share of its pass edge, the lower edge of the band."""
WINDOW_CYCLES = 2.5
"""Block rows in cycles of the lower edge; weak modes need their full decay."""
OCTAVE = 2.0
"""Upper limit of a band's modes over the peak for which it was made."""
MOST_BANDS = 2
SAME_SHAPE = 0.8
"""MAC above which two candidates of one frequency are the same."""


@dataclass(frozen=True)
class PoleSearch:
    """Poles of one or several bands, their candidates, the tones, and the second looks at further bands."""

    poles: Stabilisation
    judged: list[Candidate]
    tones: Tones
    looks: tuple[SecondLook, ...] = ()


def searched(ready: PreparedRecord, settings: IdentificationSettings) -> PoleSearch:
    """Return poles and candidates of the prepared samples."""
    poles = poles_of(ready, settings)
    resolved = ready.settings
    found = clusters(
        poles,
        distance=settings.cluster_distance,
        orders=resolved.orders,
        scale=ready.scale,
        share=settings.min_order_share,
    )
    rate = resolved.sample_rate_hz
    if settings.quick:
        tones = Tones(frozenset(), (), tuple(ready.drifting), ready.y)
    else:
        tones = find_tones(poles, found, ready.y, ready.scale, rate, settings, ready.drifting)
    return PoleSearch(poles, candidates_of(poles, found, tones, ready, settings), tones)


def candidates_of(
    poles: Stabilisation,
    found: Sequence[Cluster],
    tones: Tones,
    ready: PreparedRecord,
    settings: IdentificationSettings,
) -> list[Candidate]:
    """Apply the hard criteria to clusters of poles of the prepared samples."""
    return candidates(
        poles,
        list(found),
        tones.representatives,
        settings,
        duration_s=ready.duration_s,
        n_orders=len(ready.settings.orders),
    )


def with_quiet_bands(
    first: PoleSearch, ready: PreparedRecord, settings: IdentificationSettings
) -> PoleSearch:
    """Return the search extended by further bands."""
    spectrum = densities(first.tones.clean, ready.settings.sample_rate_hz)
    out, above = first, 0.0
    for _ in range(MOST_BANDS):
        peaks = [f for f in clear_peaks_hz(spectrum.frequencies_hz, spectrum.density) if f > above]
        left = [f for f in peaks if not _explained(f, float(spectrum.frequencies_hz[1]), out, ready)]
        if not left:
            break
        above = OCTAVE * left[0]
        loud = replace(ready, y=out.tones.clean, drifting=out.tones.drifting)
        octave = _octave(loud, EDGE_BELOW_PEAK * left[0], above)
        out = _joined(out, octave, settings, ready.settings.sample_rate_hz)
    return out


def _explained(peak_hz: float, line_hz: float, search: PoleSearch, ready: PreparedRecord) -> bool:
    """Return whether a peak is outside the band or explained by a mode or tone."""
    resolved, tones = ready.settings, search.tones
    if not resolved.lowest_frequency_hz < peak_hz < resolved.highest_frequency_hz:
        return True
    modes = [c.mode for c in search.judged if c.objection is None and c.doubt is None]
    own = [(m.frequency_hz, max(m.damping_ratio * m.frequency_hz, line_hz)) for m in modes]
    ranges = [(f - EXPLAINS * half, f + EXPLAINS * half) for f, half in own]
    lines = [(f, f) for f in (*tones.steady_hz, *ready.tones_hz)]
    lines += [tone.disturbed_hz for tone in tones.drifting]
    ranges += [(low - EXPLAINS * line_hz, high + EXPLAINS * line_hz) for low, high in lines]
    return any(low < peak_hz < high for low, high in ranges)


def _octave(ready: PreparedRecord, low_hz: float, high_hz: float) -> PreparedRecord:
    """Return the samples of a band alone, scaled to unit variance, at the rate that it needs."""
    rate, high_hz = ready.settings.sample_rate_hz, min(high_hz, ready.settings.highest_frequency_hz)
    fast = ready.y - resample(ready.y, lowpass_taps(TRANSITION * low_hz / rate, low_hz / rate))
    down = max(int(rate / (SAMPLES_PER_CYCLE * GUARD * high_hz)), 1)
    if down > 1:
        fast = resample(fast, lowpass_taps(1.0 / (SAMPLES_PER_CYCLE * down), 0.5 / down), down=down)
        rate /= down
    scale = np.sqrt(np.nanmean(fast**2, axis=1))
    rows = min(int(np.ceil(WINDOW_CYCLES * rate / low_hz)), -(-ready.settings.block_rows // down))
    orders = tuple(n for n in ready.settings.orders if n <= (rows - 1) * len(fast))
    settings = replace(
        ready.settings,
        lowest_frequency_hz=low_hz,
        highest_frequency_hz=high_hz,
        sample_rate_hz=rate,
        block_rows=rows,
        orders=orders,
        lag_window_s=2.0 * rows / rate,
    )
    return replace(ready, y=fast / scale[:, None], scale=ready.scale * scale, settings=settings)


def _joined(
    out: PoleSearch, ready: PreparedRecord, settings: IdentificationSettings, rate_hz: float
) -> PoleSearch:
    """Return the search with those of another band; of two for one mode, the less doubtful is used."""
    more, offset = searched(ready, settings), len(out.poles.order)
    if not len(more.poles.order):
        return out
    low_hz, high_hz = ready.settings.lowest_frequency_hz, ready.settings.highest_frequency_hz
    kept = list(out.judged)
    for c in more.judged:
        if c.objection is not None or not low_hz < c.mode.frequency_hz < high_hz:
            continue
        same = [o for o in kept if _same(o, c, ready.scale)]
        if any(o.objection is None and (o.doubt is None or c.doubt is not None) for o in same):
            continue
        kept = [o for o in kept if not any(o is s for s in same)]
        kept.append(replace(c, cluster=_moved(c.cluster, offset)))
    return PoleSearch(
        _together(out.poles, more.poles),
        sorted(kept, key=lambda c: c.mode.frequency_hz),
        _tones(out.tones, more.tones, rate_hz, offset),
        (*out.looks, second_look(ready.y, ready, (low_hz, high_hz))),
    )


def _tones(known: Tones, more: Tones, rate_hz: float, offset: int) -> Tones:
    """Return the tones of both searches, and all samples without the new ones."""
    clean, new = known.clean, [t for t in more.drifting if not any(t is k for k in known.drifting)]
    for tone in new:
        clean = less_phase(clean, tone.phase(clean.shape[1]))
    if more.steady_hz:
        clean = without_tones(clean, rate_hz, list(more.steady_hz))
    return Tones(
        known.representatives | {k + offset for k in more.representatives},
        (*known.steady_hz, *more.steady_hz),
        (*known.drifting, *new),
        clean,
    )


def _same(one: Candidate, other: Candidate, scale: FloatArray) -> bool:
    a, b = one.mode, other.mode
    reach = EXPLAINS * max(a.damping_ratio, b.damping_ratio)
    alike = float(mac(a.mode_shape / scale, b.mode_shape / scale)) > SAME_SHAPE
    return abs(a.frequency_hz / b.frequency_hz - 1.0) < reach and alike


def _moved(cluster: Cluster, offset: int) -> Cluster:
    return replace(
        cluster,
        poles=cluster.poles + offset,
        core=cluster.core + offset,
        representative=cluster.representative + offset,
    )


def _together(one: Stabilisation, other: Stabilisation) -> Stabilisation:
    """Return the poles of both searches; orders of different bands may coincide."""
    if not len(one.order):
        return other
    both: dict[str, Any] = {
        name: None if ours is None else np.concatenate([ours, getattr(other, name)])
        for name, ours in vars(one).items()
    }
    return Stabilisation(**both)
