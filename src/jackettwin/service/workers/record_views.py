"""Drawings of a stored record beside its samples: motion of the structure, and places of faults."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.arrays import BoolArray
from jackettwin.errors import InputError
from jackettwin.service.workers.engine import load_twin
from jackettwin.store import read_waveform

_APART_S = 1.0
"""Faults nearer than this are drawn as one."""
_MOST = 100
"""Largest number of stretches of a channel; of more, the longest are drawn."""


def motion(folder: str, waveform: str, duration_s: float) -> dict[str, Any]:
    """Return the liveliest part of a record as a motion of its twin's structure.

    Raises
    ------
    InputError
        If the twin has no structure, or no accelerometer of the record has a place.
    """
    from jackettwin.report import record_motion
    from jackettwin.response import playback

    model = load_twin(Path(folder)).model
    if model.assembly is None or model.numbered is None:
        raise InputError("the twin has no structure", field="structure", remedy="name one in its file")
    record = read_waveform(Path(waveform))
    found = playback(model.assembly, model.numbered, record, duration_s=duration_s)
    return record_motion(model.assembly, record.name, found).document()


def stretches(folder: str, waveform: str) -> list[dict[str, Any]]:
    """Return where in a record samples are missing or not used, and the moments that findings name."""
    from jackettwin.records import assess

    record = read_waveform(Path(waveform))
    quality, rate = assess(record), record.sample_rate_hz
    said: dict[str | None, list[str]] = {}
    for finding in quality.findings:
        said.setdefault(finding.subject, []).append(finding.text)
    found = []
    for channel, row, suspect in zip(record.channels, record.data, quality.suspect, strict=True):
        gaps = ~np.isfinite(row)
        for code, mask in (("gap", gaps), ("left_out", suspect & ~gaps)):
            text = "; ".join(said.get(channel.name, [])) if code == "left_out" else "no samples"
            for first, last in _runs(mask, round(_APART_S * rate)):
                place = {"from_s": first / rate, "to_s": last / rate}
                found.append({"channel": channel.name, "code": code, "text": text, **place})
    for finding in quality.findings:
        at = finding.params.get("time_s")
        if isinstance(at, float):
            place = {"from_s": at, "to_s": at}
            found.append({"channel": finding.subject, "code": finding.code, "text": finding.text, **place})
    return found


def _runs(mask: BoolArray, apart: int) -> Iterator[tuple[int, int]]:
    """Yield first and last sample of each run, joined over short pauses."""
    places = np.flatnonzero(mask)
    if not places.size:
        return
    cuts = np.flatnonzero(np.diff(places) > max(apart, 1))
    firsts, lasts = places[np.r_[0, cuts + 1]], places[np.r_[cuts, places.size - 1]]
    longest = np.argsort(firsts - lasts, kind="stable")[:_MOST]
    yield from ((int(firsts[k]), int(lasts[k])) for k in np.sort(longest))
