"""A record examined: judged, repaired, turned to the rotor's axes and identified. Stateless."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from jackettwin.errors import located
from jackettwin.files import NOT_KEPT, Keep, StoredSchema, digest, kept
from jackettwin.findings import Finding
from jackettwin.identification.automatic import identify
from jackettwin.identification.comparison import Comparison, compare_methods
from jackettwin.identification.estimate import Identification, ModalEstimate
from jackettwin.identification.many_records.pairs import along_axes
from jackettwin.identification.picks import Pick
from jackettwin.identification.record_steps import (
    Findings,
    Step,
    cut_to_common_time,
    in_rotor_axes,
    moving_channels,
    placed,
    prepared,
    repaired,
    set_aside,
    unclear,
    unplaced,
    without_rotor_orders,
)
from jackettwin.identification.selection.candidates import beside_orders
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.status import ModeStatus
from jackettwin.records import (
    Channel,
    Record,
    Unsaid,
    assess,
    knows_yaw,
    read_record,
    record_content,
    with_conditions,
)
from jackettwin.records.quality.length import CYCLES, too_short
from jackettwin.records.quality.record_quality import Quality
from jackettwin.records.quality.repeats import each_sample_once
from jackettwin.records.quality.zero_steps import zeros_in_line
from jackettwin.version import __version__

UNFIT = ("another_time", "stored_backwards", "clocks_wander", "coarse_quantiser")
"""What is found of a record that makes every mode of it doubtful, unless it was repaired."""
ORDERS_FOUND = ("rotor_order_removed", "rotor_order_weak", "rotor_order_seen", "rotor_order_stated")
"""Findings that say where a multiple of the rotor's speed was."""


@dataclass(frozen=True)
class Examination:
    """One record, judged, repaired and identified.

    Attributes
    ----------
    record : Record
        As it was identified.
    quality : Quality
        Of the record as it was read.
    findings : tuple of Finding
        What the steps of the preparation found.
    comparison : Comparison or None
        The same modes by every method, if it was asked for.
    """

    record: Record
    quality: Quality
    identification: Identification
    findings: Findings = ()
    comparison: Comparison | None = None


def examine_file(
    path: Path,
    settings: IdentificationSettings,
    *,
    places: Sequence[Channel] = (),
    picks: tuple[Pick, ...] = (),
    unsaid: Unsaid | None = None,
    compare: bool = False,
    keep: Keep = NOT_KEPT,
) -> Examination:
    """Read and examine one record; ``unsaid`` holds rate and unit for a file that does not say them.

    Raises
    ------
    InputError
        If the record cannot be read, no channel carries a signal, or the record cannot be identified.
    """
    record = read_record(path, unsaid)
    with located(file=path):
        return examine(record, settings, places=places, picks=picks, compare=compare, keep=keep)


def examine(
    record: Record,
    settings: IdentificationSettings,
    *,
    places: Sequence[Channel] = (),
    picks: tuple[Pick, ...] = (),
    compare: bool = False,
    keep: Keep = NOT_KEPT,
) -> Examination:
    """Judge, repair, turn to the rotor's axes and identify one record.

    Parameters
    ----------
    places : sequence of Channel
        Only the channels of these names, at the node, height and direction stated here; default: all that
        measure motion, where the record says.
    picks : tuple of Pick
        Poles to take instead of the automatic selection, for the records they name.
    compare : bool
        Identify by every method as well.
    keep : Keep
        Keeps what was identified for the next time.

    Raises
    ------
    InputError
        If no channel carries a signal, or the record cannot be identified.
    """
    source = with_conditions(record)
    chosen, absent = placed(source, places) if places else (moving_channels(source), ())
    chosen, repeated = each_sample_once(chosen)
    chosen, stepped = zeros_in_line(chosen)
    quality = assess(chosen)
    alarms = (f for f in (*repeated, *stepped, *too_short(chosen)) if f.severity == "alarm")
    doubts = (*alarms, *(f for f in quality.findings if f.code in UNFIT and not f.repaired))
    steps: tuple[Step, ...] = (
        partial(repaired, quality=quality),
        partial(in_rotor_axes, source=source),
        partial(without_rotor_orders, source=source),
        partial(cut_to_common_time, quality=quality),
    )
    ready, findings = prepared(chosen, steps)
    findings = (
        *absent,
        *doubts,
        *(f for f in stepped if f.severity != "alarm"),
        *findings,
        *unplaced(chosen),
        *(() if places else (*unclear(source), *set_aside(source, chosen))),
    )
    in_axes = knows_yaw(source) or source.metadata.get("axes") == "rotor"

    def compute() -> Identified:
        found = _beside_orders(identify(ready, settings, picks=picks), findings)
        found = doubted(found, doubts)
        found = along_axes(found) if in_axes else found
        warnings = (str(f) for f in findings if f.severity != "info")
        notes = (str(f) for f in findings if f.severity == "info")
        found = replace(found, warnings=(*warnings, *found.warnings), notes=(*found.notes, *notes))
        compared = compare_methods(ready, found, settings) if compare and found.modes else None
        return Identified.of(found, compared)

    key = identified_key(ready, settings, picks, findings, compare=compare, in_rotor_axes=in_axes)
    made = kept(keep, IDENTIFIED, key, compute)
    return Examination(ready, quality, made.found, findings, made.comparison)


@dataclass(frozen=True)
class Identified:
    """The costly part of an examination.

    Attributes
    ----------
    found : Identification
    methods : mapping or None
        The same modes by every method, if that was asked for.
    refused : mapping
        Methods that could not take the record, and why.
    """

    found: Identification
    methods: Mapping[str, tuple[ModalEstimate | None, ...]] | None = None
    refused: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, found: Identification, compared: Comparison | None) -> Identified:
        """Return an identification with what other methods made of the record."""
        return cls(found) if compared is None else cls(found, compared.modes, compared.refused)

    @property
    def comparison(self) -> Comparison | None:
        """The same modes by every method, None if that was not asked for."""
        return None if self.methods is None else Comparison(self.found, self.methods, self.refused)


IDENTIFIED = StoredSchema("identified", Identified)
"""How identifications are kept."""


IDENTIFIED = StoredSchema("identified", Identified)
"""How identifications are kept."""


def identified_key(
    ready: Record,
    settings: IdentificationSettings,
    picks: tuple[Pick, ...],
    findings: tuple[Finding, ...],
    *,
    compare: bool,
    in_rotor_axes: bool,
) -> str:
    """Return the identity of an identification: the same key, the same result to the last digit.

    The record's name counts: it stands in the result, and picks go by it.
    """
    own = [pick for pick in picks if pick.record in (None, ready.name)]
    return digest(
        [
            *record_content(ready),
            dict(settings),
            own,
            list(findings),
            compare,
            in_rotor_axes,
            __version__,
        ]
    )


def _beside_orders(found: Identification, findings: Findings) -> Identification:
    """Flag the modes that a multiple of the rotor's speed passed."""
    orders = [
        (int(f.params["order"] or 0), float(f.params["low_hz"] or 0.0), float(f.params["high_hz"] or 0.0))
        for f in findings
        if f.code in ORDERS_FOUND
    ]
    return replace(found, modes=tuple(beside_orders(mode, orders) for mode in found.modes))


def doubted(found: Identification, reasons: Findings) -> Identification:
    """Doubt every mode of a record for reasons that concern all of it."""
    modes = []
    for mode in found.modes:
        cycles, decays = mode.frequency_hz * found.duration_s, mode.method == "decay"
        # a decay is told by its e-folds
        own = [f for f in reasons if not (decays and f.code == "too_short")][:1]
        if cycles < CYCLES and not decays:
            own.append(Finding("few_cycles", params={"cycles": cycles}))
        for reason in own:
            mode = mode.flagged(ModeStatus.DOUBTFUL, reason)
        modes.append(mode)
    return replace(found, modes=tuple(modes))
