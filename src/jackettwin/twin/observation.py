"""What is kept of a record: everything the twin will ever ask of it, in some kilobytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from jackettwin.files import StoredSchema
from jackettwin.findings import Finding
from jackettwin.identification import Identification, ModalEstimate
from jackettwin.response import Sensor
from jackettwin.updating import Counterpart


@dataclass(frozen=True)
class Recognised:
    """Which mode of the model an identified mode is.

    Attributes
    ----------
    mode : int
        Its number on pinned feet, from 1.
    label : str
        ``fore_aft_1`` …
    mac : float
        With the subspace of the model's modes nearby.
    """

    mode: int
    label: str
    mac: float


@dataclass(frozen=True)
class Observation:
    """One record as the twin sees it; the same record, model and version give the same observation.

    Attributes
    ----------
    record_id : str
        Hash of samples, rate, start and channels.
    model_hash, settings_hash, code_version : str
        What it was made with.
    name : str
        Of the record; says nothing of its identity.
    start_utc : datetime or None
    conditions : mapping
        Wind, yaw, state of operation and whatever else the record says or its channels tell.
    quality : mapping
        ``Quality.summary()``.
    identification : Identification
        Without poles and spectrum, which figures need: those are made of the record again.
    recognised : tuple of Recognised or None
        For each identified mode; None if the model has no such mode.
    sensors : tuple of Sensor
        Where the identified channels sit and which way they point; empty if the record does not say.
    findings : tuple of Finding
    held : tuple of Counterpart
        For each identified mode, what it was held against in the model; empty without a structure.
    truth : mapping
        What the record says is true of its structure (simulated ones do): ``true_modes``, ``true_support``.
    """

    record_id: str
    model_hash: str
    settings_hash: str
    code_version: str
    name: str
    start_utc: datetime | None
    conditions: Mapping[str, Any]
    quality: Mapping[str, Any]
    identification: Identification
    recognised: tuple[Recognised | None, ...]
    sensors: tuple[Sensor, ...]
    findings: tuple[Finding, ...] = ()
    held: tuple[Counterpart, ...] = ()
    truth: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        labels = ", ".join(filter(None, self.labels)) or "none"
        found = len(self.identification.modes)
        return f"Observation({self.name!r}, {found} modes, of the model: {labels})"

    @property
    def labels(self) -> tuple[str, ...]:
        """For each identified mode, which of the model's it is; empty if none."""
        return tuple("" if known is None else known.label for known in self.recognised)

    @property
    def duration_s(self) -> float:
        """Length of the record [s]."""
        return self.identification.duration_s

    @property
    def mismatched(self) -> bool:
        """Whether the record shows modes and none of them is the model's: it is of another structure."""
        shown = any(mode.status.is_a_mode for mode in self.identification.modes)
        return shown and any(f.code == "no_mode_of_the_model" for f in self.findings)

    @property
    def modes(self) -> dict[int, tuple[ModalEstimate, Recognised]]:
        """The modes of the model that the record shows, {number: (estimate, which one)}."""
        pairs = zip(self.identification.modes, self.recognised, strict=True)
        return {known.mode: (mode, known) for mode, known in pairs if known is not None}

    @property
    def named_modes(self) -> dict[str, ModalEstimate]:
        """The modes of the model that the record shows and that are modes, by label."""
        return {known.label: mode for mode, known in self.modes.values() if mode.status.is_a_mode}

    @property
    def wind_m_s(self) -> float | None:
        """Mean wind speed [m/s], if the record says it."""
        value = self.conditions.get("mean_wind_speed_m_s")
        return None if value is None else float(value)


_QUIET = ("drift", "file", "gaps", "held", "spikes", "stuck")
"""Faults of version 1 that limit no conclusion."""


def _findings_have_codes(document: dict[str, Any]) -> dict[str, Any]:
    """Return version 2: what the quality of a record says has ``code`` and ``subject``.

    Sentences of version 1 were made when a fault was found; they stay as they are.
    """
    quality = document["quality"]
    said = [
        {"code": f["fault"], "subject": f["channel"], "text": f["text"], "repaired": f["repaired"]}
        for f in quality.get("findings", ())
    ]
    kept = [
        f if "text" not in f["params"] else {**f, "code": "file" if f["code"] in _QUIET else "identification"}
        for f in document["findings"]
    ]
    quality = {**quality, "findings": said} if quality else quality
    return {**document, "quality": quality, "findings": kept}


OBSERVATION = StoredSchema("observation", Observation, (_findings_have_codes,))
"""How observations are kept."""
