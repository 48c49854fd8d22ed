"""Result of one run of the twin, complete for the report, which computes nothing."""

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
    """Measured damping of a mode compared with that of the steel and the updated support.

    Attributes
    ----------
    support : float
        Part of the steel, the soil and the water in the model's damping ratio.
    rotor : float
        Part of the nacelle's dashpots; 0 without them, NaN of one that no datum and no prior constrains.
    """

    label: str
    measured: float
    measured_std: float | None
    support: float
    rotor: float = 0.0

    @property
    def excess(self) -> float:
        """Measured damping ratio beyond the support's; negative if the steel's damping is too high."""
        return self.measured - self.support

    @property
    def explained(self) -> bool:
        """Whether the support explains the measured ratio within two standard deviations or 5 %."""
        return abs(self.excess) <= self._allowance

    @property
    def carried(self) -> bool:
        """Whether the rotor's dashpots explain the excess over the support's damping."""
        return not self.explained and abs(self.excess - self.rotor) <= self._allowance

    @property
    def _allowance(self) -> float:
        return 0.05 * self.measured if self.measured_std is None else 2.0 * self.measured_std


@dataclass(frozen=True, repr=False)
class TwinResult:
    """Result of one run.

    Attributes
    ----------
    numbered, labels
        Undamped modes on pinned supports and their labels.
    observations : tuple of Observation
        One for each record.
    shown : Examination or None
        Examination of the first record, for figures: quality, repaired record, poles and spectra.
    measured : tuple of MeasuredMode
        In order of mode numbers.
    updates : tuple of Update
        One for each law; each covers the modes of ``measured``.
    excess : tuple of tuple of DampingExcess
        For each update, one for every mode with measured damping.
    assumptions : tuple of Assumption
    warnings : tuple of str
        Sentences for the report.
    relaxations : tuple of MeasuredRelaxation
        Real poles that the supports were fitted to, by rate.
    rotor_speed_hz : (lowest, highest) or None
        Of the rotor in operation, if the twin or its rotor states it.
    rotor_state : "parked" or "operating" in these records, if the twin has a rotor
    wind_m_s : mean wind speed of the records, if they state it
    blades : int
    in_all : (number, seconds), optional
        Number and total duration of all records, if ``observations`` are only some of them.
    scrutiny : tuple of Scrutiny
        Scrutiny of each of ``updates``.
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
    rotor_state: str | None = None
    wind_m_s: float | None = None
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
        """Number of records and their total duration [s]."""
        return self.in_all or (len(self.observations), sum(seen.duration_s for seen in self.observations))

    @property
    def record(self) -> Record | None:
        """The first record, repaired."""
        return None if self.shown is None else self.shown.record

    @property
    def names(self) -> tuple[tuple[str, ...], ...]:
        """Label of each identified mode of each record; empty without a counterpart in the model."""
        return tuple(seen.labels for seen in self.observations)

    @property
    def identifications(self) -> tuple[Identification, ...]:
        """Identification of each record; only the first has poles and spectra."""
        found = tuple(seen.identification for seen in self.observations)
        if self.shown is None or not found:
            return found[1:]
        # with the labels of the model's modes
        return (replace(self.shown.identification, modes=found[0].modes), *found[1:])

    @property
    def unpaired(self) -> tuple[tuple[ModalEstimate, Counterpart], ...]:
        """Identified modes without a counterpart in the model, and the model's modes compared with them."""
        return tuple(
            (mode, against)
            for seen in self.observations
            for mode, against in zip(seen.identification.modes, seen.held, strict=False)
            if against.verdict != "paired"
        )


def unpaired_finding(mode: ModalEstimate, held: Counterpart, labels: tuple[str, ...]) -> Finding | None:
    """Return the reason that an identified mode has no counterpart in the model; None if it has one."""
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
    """Return the model's mode that an identified mode was compared with as plain JSON data."""
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
