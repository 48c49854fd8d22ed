"""What one run of the twin produced: everything the report shows, nothing it would have to compute."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from jackettwin.caveats import Assumption
from jackettwin.findings import Finding
from jackettwin.identification import Examination, Identification, ModalEstimate
from jackettwin.records import Record
from jackettwin.response import Sensor, UndampedModes
from jackettwin.structure import Assembly
from jackettwin.study.measurements import MeasuredMode, MeasuredRelaxation
from jackettwin.study.scrutiny import Scrutiny
from jackettwin.twin import Observation
from jackettwin.updating import LEAST_MAC, Counterpart, Update


@dataclass(frozen=True)
class DampingExcess:
    """Measured damping of a mode beside what the steel and the updated support give it.

    Attributes
    ----------
    support : float
        The steel's, the soil's and the water's part of the model's ratio.
    rotor : float
        The part of the nacelle's dashpots; 0 without them.
    """

    label: str
    measured: float
    measured_std: float | None
    support: float
    rotor: float = 0.0

    @property
    def excess(self) -> float:
        """What no support explains; negative if the steel's damping is too high."""
        return self.measured - self.support

    @property
    def explained(self) -> bool:
        """Whether the support explains the measured ratio: within two standard deviations, or 5 %."""
        return abs(self.excess) <= self._allowance

    @property
    def carried(self) -> bool:
        """Whether the rotor's dashpots carry what the support does not explain."""
        return not self.explained and abs(self.excess - self.rotor) <= self._allowance

    @property
    def _allowance(self) -> float:
        return 0.05 * self.measured if self.measured_std is None else 2.0 * self.measured_std


@dataclass(frozen=True, repr=False)
class TwinResult:
    """Everything one run produced.

    Attributes
    ----------
    numbered, labels
        Undamped modes on pinned supports and what to call them.
    observations : tuple of Observation
        One a record.
    shown : Examination or None
        Of the first record, for figures: its quality, the repaired record, poles and spectra.
    measured : tuple of MeasuredMode
        In the order of mode numbers.
    updates : tuple of Update
        One a law; each covers the modes of ``measured``.
    excess : tuple of tuple of DampingExcess
        For each update, every mode with measured damping.
    assumptions : tuple of Assumption
    warnings : tuple of str
        Sentences for the report.
    relaxations : tuple of MeasuredRelaxation
        Real poles that the supports were updated to, too, by rate.
    rotor_speed_hz : (lowest, highest) or None
        Of the rotor in operation, where the twin says it or its rotor does.
    blades : int
    in_all : (number, seconds), optional
        Of all records that were measured and of their durations, if ``observations`` are some of them.
    scrutiny : tuple of Scrutiny
        What stands behind each of ``updates``.
    """

    name: str
    assembly: Assembly
    sensors: tuple[Sensor, ...]
    numbered: UndampedModes
    labels: tuple[str, ...]
    observations: tuple[Observation, ...]
    shown: Examination | None
    measured: tuple[MeasuredMode, ...]
    updates: tuple[Update, ...]
    excess: tuple[tuple[DampingExcess, ...], ...]
    assumptions: tuple[Assumption, ...]
    warnings: tuple[str, ...]
    relaxations: tuple[MeasuredRelaxation, ...] = ()
    rotor_speed_hz: tuple[float, float] | None = None
    blades: int = 3
    in_all: tuple[int, float] | None = None
    scrutiny: tuple[Scrutiny, ...] = ()

    def __repr__(self) -> str:
        modes = ", ".join(f"{m.label} {m.frequency_hz or float('nan'):.4g} Hz" for m in self.measured)
        laws = ", ".join(u.law for u in self.updates)
        return (
            f"TwinResult({self.name!r}, {len(self.observations)} records, measured: {modes or 'nothing'}; "
            f"updated under {laws or 'no law'})"
        )

    @property
    def extent(self) -> tuple[int, float]:
        """How many records were measured, and how long they are together [s]."""
        return self.in_all or (len(self.observations), sum(seen.duration_s for seen in self.observations))

    @property
    def record(self) -> Record | None:
        """The first record, repaired."""
        return None if self.shown is None else self.shown.record

    @property
    def names(self) -> tuple[tuple[str, ...], ...]:
        """For each record, the label of each identified mode; empty without a counterpart in the model."""
        return tuple(seen.labels for seen in self.observations)

    @property
    def identifications(self) -> tuple[Identification, ...]:
        """What was identified, one a record; only that of the first has poles and spectra."""
        found = tuple(seen.identification for seen in self.observations)
        if self.shown is None or not found:
            return found[1:]
        # with what the model says of its modes
        return (replace(self.shown.identification, modes=found[0].modes), *found[1:])

    @property
    def unpaired(self) -> tuple[tuple[ModalEstimate, Counterpart], ...]:
        """Identified modes the model has no counterpart for, and what they were held against."""
        return tuple(
            (mode, against)
            for seen in self.observations
            for mode, against in zip(seen.identification.modes, seen.held, strict=False)
            if against.verdict != "paired"
        )


def unpaired_finding(mode: ModalEstimate, held: Counterpart, labels: tuple[str, ...]) -> Finding | None:
    """Return why an identified mode has no counterpart in the model; None if it has one."""
    if held.verdict == "paired":
        return None
    params: dict[str, Any] = {
        "label": _label(held, labels),
        "model_frequency_hz": held.frequency_hz,
        "difference": held.difference,
        "mac": held.mac,
        "least_mac": LEAST_MAC,
    }
    return Finding(f"unpaired_{held.verdict}", f"{mode.frequency_hz:.3f} Hz", params)


def held_document(mode: ModalEstimate, held: Counterpart, labels: tuple[str, ...]) -> dict[str, Any]:
    """Return what an identified mode was held against as plain JSON data."""
    finding = unpaired_finding(mode, held, labels)
    return {
        "label": _label(held, labels),
        "mode": held.mode + 1,
        "model_frequency_hz": held.frequency_hz,
        "frequency_difference": held.difference,
        "mac": held.mac,
        "verdict": held.verdict,
        "reason": None if finding is None else finding.text,
    }


def _label(held: Counterpart, labels: tuple[str, ...]) -> str:
    """Return the label of the model's mode, or its number where the modes have no labels."""
    return labels[held.mode] if held.mode < len(labels) else f"mode_{held.mode + 1}"
