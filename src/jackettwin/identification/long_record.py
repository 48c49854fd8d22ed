"""A long file identified as one record: read in pieces, of which only one at a time has its full rate.

A day at 100 Hz has eight million samples a channel; its modes need a few samples a second. Each piece is
freed of what damages single samples, which a filter would smear, then decimated. The band follows from the
peaks of the first hour.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification.estimate import Spectrum
from jackettwin.identification.peaks_above import peaks_in, spectrum_above
from jackettwin.identification.preparation.prepared_record import band_top_hz
from jackettwin.identification.preparation.resolve import EDGE_BELOW_PEAK, GUARD, SAMPLES_PER_CYCLE
from jackettwin.identification.record_steps import Findings, moving_channels
from jackettwin.processes import give_back
from jackettwin.records import Record, assess
from jackettwin.records.processing.thinning import thinned
from jackettwin.records.readers.pieces import placed_pieces

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ResolvedSettings
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.records import FileDefaults


PIECE_S = 600.0
"""Length of a piece [s]."""
MARGIN = 1.05
"""Rate of the record over that of the band seen in its first hour, whose peaks are a little uncertain."""
FEWEST_PIECES = 7
"""Fewest pieces of a record that is read like this; shorter ones take little memory."""
SHARES = ("spikes", "outliers", "clipped", "stuck")
"""Faults of single samples whose parameter is their share."""
OF_CHANNELS = ("held", "coarse_quantiser")
"""Faults that a channel has throughout; those in fewer than half of the pieces are not reported."""


@dataclass(frozen=True)
class LongRecord:
    """A record at a lower rate, and what only its full rate shows.

    Attributes
    ----------
    record : Record
    findings : tuple of Finding
        Faults of single samples, declared missing before the rate was lowered.
    spectrum : Spectrum or None
        Mean densities of the vibrating channels at the full rate.
    """

    record: Record
    findings: Findings
    spectrum: Spectrum | None

    def peaks_above(self, settings: IdentificationSettings, resolved: ResolvedSettings) -> Findings:
        """Return the finding on clear peaks above the band; none if the user set the band."""
        if self.spectrum is None or settings.highest_frequency_hz is not None:
            return ()
        return peaks_in(self.spectrum, resolved)


@dataclass
class _Seen:
    """What the pieces showed at their full rate."""

    edge_hz: float
    pieces: int = 0
    faults: list[Finding] = field(default_factory=list)
    spectra: int = 0
    frequencies_hz: FloatArray | None = None
    density: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def cleaned(self, pieces: Iterable[tuple[float, Record]]) -> Iterator[tuple[int, FloatArray]]:
        """Yield the number of the first sample of each piece, and its samples without damaged ones."""
        for begin_s, piece in pieces:
            quality = assess(piece, thorough=False)
            self.pieces += 1
            self.faults += [f for f in quality.findings if f.code in (*SHARES, *OF_CHANNELS, "unreadable")]
            seen = spectrum_above(piece, self.edge_hz)
            if seen is not None and self.frequencies_hz is None:
                self.spectra, self.frequencies_hz, self.density = 1, seen.frequencies_hz, seen.density
            elif seen is not None and seen.density.shape == self.density.shape:
                self.spectra, self.density = self.spectra + 1, self.density + seen.density
            yield round(begin_s * piece.sample_rate_hz), np.where(quality.suspect, np.nan, piece.data)

    @property
    def spectrum(self) -> Spectrum | None:
        """Mean of the pieces' densities."""
        if self.frequencies_hz is None:
            return None
        f = self.frequencies_hz
        return Spectrum(f, self.density / self.spectra, np.empty((0, f.size)))


def read_whole(
    path: Path, settings: IdentificationSettings, defaults: FileDefaults | None = None
) -> LongRecord | None:
    """Return a record longer than an hour at the rate that its modes need, None for any other.

    None also if no piece of the first hour has a clear peak, or if its rate is needed as it is.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    pieces = placed_pieces(path, PIECE_S, defaults)
    first = deque(islice(pieces, FEWEST_PIECES))
    if len(first) < FEWEST_PIECES:
        return None
    head = first[0][1]
    edge_hz = max((_edge_hz(piece, settings) for _, piece in first), default=0.0)
    needed_hz = max(SAMPLES_PER_CYCLE * MARGIN * edge_hz, settings.sample_rate_hz or 0.0)
    factor = int(head.sample_rate_hz / needed_hz) if edge_hz > 0.0 else 1
    if factor < 2:
        return None
    seen = _Seen(edge_hz)
    # pieces of the first hour leave memory as they are used
    each = chain((first.popleft() for _ in range(len(first))), pieces)
    data = np.hstack(list(thinned(seen.cleaned(each), factor)))
    done = {"step": "decimate", "from_hz": head.sample_rate_hz, "to_hz": head.sample_rate_hz / factor}
    metadata = {**head.metadata, "preparation": [*head.metadata.get("preparation", []), done]}
    give_back()
    record = replace(
        head, data=data, sample_rate_hz=head.sample_rate_hz / factor, name=path.stem, metadata=metadata
    )
    return LongRecord(record, _merged(seen.faults, seen.pieces), seen.spectrum)


def _edge_hz(piece: Record, settings: IdentificationSettings) -> float:
    """Return the upper edge of the band, 0 if the piece shows none."""
    try:
        top = band_top_hz(moving_channels(piece), settings)
    except InputError:
        return 0.0
    chosen = settings.highest_frequency_hz is not None or settings.lowest_frequency_hz is not None
    return 0.0 if top is None else top / GUARD * (1.0 if chosen else EDGE_BELOW_PEAK)


def _merged(faults: list[Finding], n_pieces: int) -> Findings:
    """Return one finding for each fault and channel."""
    alike: dict[tuple[str, str | None], list[Finding]] = {}
    for fault in faults:
        alike.setdefault((fault.code, fault.subject), []).append(fault)
    out = []
    for (code, _), found in alike.items():
        params = dict(found[len(found) // 2].params)
        if code in SHARES:
            params["share"] = sum(float(f.params["share"] or 0.0) for f in found) / n_pieces
        elif code == "unreadable":
            params["samples"] = sum(int(f.params["samples"] or 0) for f in found)
        elif len(found) < 0.5 * n_pieces:
            continue
        out.append(replace(found[0], params=params))
    return tuple(out)
