"""Drawings of a stored record beside its samples: motion of the structure, and places of faults.

What reads samples is loaded by workers only: the server asks ``stretches_of`` itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError


def motion(folder: str, waveform: str, duration_s: float) -> dict[str, Any]:
    """Return the liveliest part of a record as a motion of its twin's structure.

    Raises
    ------
    InputError
        If the twin has no structure, or no accelerometer of the record has a place.
    """
    from jackettwin.report import record_motion
    from jackettwin.response import playback
    from jackettwin.service.workers.engine import load_twin
    from jackettwin.store import read_waveform

    model = load_twin(Path(folder)).model
    if model.assembly is None or model.numbered is None:
        raise InputError("the twin has no structure", field="structure", remedy="name one in its file")
    record = read_waveform(Path(waveform))
    found = playback(model.assembly, model.numbered, record, duration_s=duration_s)
    return record_motion(model.assembly, record.name, found).document()


def stretches(folder: str, waveform: str) -> list[dict[str, Any]]:
    """Return :func:`stretches_of` a record that no observation tells of."""
    from jackettwin.records import assess
    from jackettwin.store import read_waveform

    return stretches_of(assess(read_waveform(Path(waveform))).summary())


def stretches_of(quality: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return where in a record samples are missing or not used, and the moments that findings name.

    Parameters
    ----------
    quality : mapping
        ``Quality.summary()``, as an observation holds it.
    """
    said: dict[str | None, list[str]] = {}
    found = []
    for finding in quality["findings"]:
        text, subject, at = finding["text"], finding.get("subject"), finding["params"].get("time_s")
        said.setdefault(subject, []).append(text)
        if isinstance(at, float):
            found.append(
                {"channel": subject, "code": finding["code"], "text": text, "from_s": at, "to_s": at}
            )
    for of in quality["unused"]:
        channel, code = of["channel"], of["code"]
        text = "no samples" if code == "gap" else "; ".join(said.get(channel, []))
        for first, last in of["spans_ms"]:
            place = {"from_s": first / 1e3, "to_s": last / 1e3}
            found.append({"channel": channel, "code": code, "text": text, **place})
    return found
