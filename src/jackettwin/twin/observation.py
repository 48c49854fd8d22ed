"""Observation: all data of a record that the twin uses later, in some kilobytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from jackettwin.files import StoredSchema
from jackettwin.findings import Finding
from jackettwin.identification import Identification, ModalEstimate
from jackettwin.intervals import NORMAL_90, NORMAL_95
from jackettwin.response import Sensor
from jackettwin.twin.life.sensed_damage import SensedDamage
from jackettwin.updating import Counterpart


@dataclass(frozen=True)
class Recognised:
    """Mode of the model that an identified mode is recognised as.

    Attributes
    ----------
    mode : int
        Number of the mode on pinned feet, from 1.
    label : str
        ``fore_aft_1`` …
    mac : float
        MAC with the subspace of neighbouring modes of the model.
    """

    mode: int
    label: str
    mac: float


@dataclass(frozen=True)
class Observation:
    """Observation of one record; equal records, models and versions give equal observations.

    Attributes
    ----------
    record_id : str
        Hash of samples, rate, start and channels.
    model_hash, settings_hash, code_version : str
        Model, settings and version that it was made with.
    name : str
        Name of the record, which does not identify it.
    start_utc : datetime or None
    conditions : mapping
        Wind, yaw, state of operation and other conditions from the record's metadata or channels.
    quality : mapping
        ``Quality.summary()``.
    identification : Identification
        Without the poles and spectrum of figures, which are computed again from the record.
    recognised : tuple of Recognised or None
        For each identified mode; None if the model has no such mode.
    sensors : tuple of Sensor
        Positions and directions of the identified channels; empty if not stated.
    findings : tuple of Finding
    held : tuple of Counterpart
        For each identified mode, the model's mode it was compared with; empty without a structure.
    truth : mapping
        True values that simulated records state: ``true_modes``, ``true_support``.
    damage : SensedDamage or None
        At the most damaged welds; None without ``life`` in the twin file, or without welded tubes.
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
    damage: SensedDamage | None = None

    def __repr__(self) -> str:
        labels = ", ".join(filter(None, self.labels)) or "none"
        found = len(self.identification.modes)
        return f"Observation({self.name!r}, {found} modes, of the model: {labels})"

    @property
    def labels(self) -> tuple[str, ...]:
        """Label of each identified mode; empty if it is not recognised."""
        return tuple("" if known is None else known.label for known in self.recognised)

    @property
    def duration_s(self) -> float:
        """Length of the record [s]."""
        return self.identification.duration_s

    @property
    def mismatched(self) -> bool:
        """Whether the record has modes but none of the model's, so that it is of another structure."""
        shown = any(mode.status.is_a_mode for mode in self.identification.modes)
        return shown and any(f.code == "no_mode_of_the_model" for f in self.findings)

    @property
    def modes(self) -> dict[int, tuple[ModalEstimate, Recognised]]:
        """The recognised modes of the record, {number: (estimate, recognised mode)}."""
        pairs = zip(self.identification.modes, self.recognised, strict=True)
        return {known.mode: (mode, known) for mode, known in pairs if known is not None}

    @property
    def named_modes(self) -> dict[str, ModalEstimate]:
        """The recognised modes of the record that are not doubted, by label."""
        return {known.label: mode for mode, known in self.modes.values() if mode.status.is_a_mode}

    @property
    def wind_m_s(self) -> float | None:
        """Mean wind speed [m/s], if the record states it."""
        value = self.conditions.get("mean_wind_speed_m_s")
        return None if value is None else float(value)


_QUIET = ("drift", "file", "gaps", "held", "spikes", "stuck")
"""Faults of version 1 that have no effect on results."""


def _findings_have_codes(document: dict[str, Any]) -> dict[str, Any]:
    """Return version 2, in which findings on the quality of a record have ``code`` and ``subject``.

    Version 1 stored complete sentences, which are not changed.
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


_INTERVALS = (
    ("frequency_hz", "frequency_interval"),
    ("damping_ratio", "damping_ratio_interval"),
    ("rate_rad_s", "rate_interval"),
)
"""Values of modes and real poles, and their intervals without the level."""


def _intervals_of_90(document: dict[str, Any]) -> dict[str, Any]:
    """Return version 3, whose intervals are of 90 %; those of 95 % are narrowed on the logarithm."""

    def narrowed(one: dict[str, Any]) -> dict[str, Any]:
        new = dict(one)
        for value, interval in _INTERVALS:
            if (ends := new.pop(f"{interval}_95", None)) is not None:
                middle = one[value]
                new[f"{interval}_90"] = [middle * (e / middle) ** (NORMAL_90 / NORMAL_95) for e in ends]
        if new.get("unrefined"):
            new["unrefined"] = narrowed(new["unrefined"])
        return new

    found = dict(document["identification"])
    for kind in ("modes", "real_poles"):
        if kind in found:
            found[kind] = [narrowed(one) for one in found[kind]]
    return {**document, "identification": found}


def _identification_has_findings(document: dict[str, Any]) -> dict[str, Any]:
    """Return version 4, whose identification has findings; sentences of version 3 are kept as they are."""
    found = dict(document["identification"])
    codes = {"warnings": "identification", "notes": "identification_note"}
    said = {
        code: [{"code": code, "params": {"text": t}} for t in found.pop(key, ())]
        for key, code in codes.items()
    }
    found |= {"findings": said["identification"], "notes": said["identification_note"]}
    return {**document, "identification": found}


OBSERVATION = StoredSchema(
    "observation", Observation, (_findings_have_codes, _intervals_of_90, _identification_has_findings)
)
"""Format of stored observations."""
