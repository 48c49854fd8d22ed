"""Examination of a record: quality, repair, rotor axes, identification. Stateless."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from jackettwin.errors import located
from jackettwin.files import NOT_KEPT, Keep, StoredSchema, digest, kept
from jackettwin.findings import Finding
from jackettwin.identification.automatic import identify
from jackettwin.identification.comparison import Comparison, compare_methods
from jackettwin.identification.estimate import Identification, ModalEstimate
from jackettwin.identification.long_record import LongRecord, read_whole
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
from jackettwin.processes import give_back
from jackettwin.records import (
    Channel,
    FileDefaults,
    Record,
    assess,
    knows_yaw,
    read_record,
    record_content,
    with_conditions,
)
from jackettwin.records.quality.crossed_axes import axes_in_line
from jackettwin.records.quality.length import CYCLES, too_short
from jackettwin.records.quality.record_quality import Quality
from jackettwin.records.quality.repeats import each_sample_once
from jackettwin.records.quality.zero_steps import zeros_in_line
from jackettwin.version import __version__

UNFIT = ("another_time", "stored_backwards", "clocks_wander", "coarse_quantiser")
"""Findings that make every mode of a record doubtful, unless the record was repaired."""
ORDERS_FOUND = ("rotor_order_removed", "rotor_order_weak", "rotor_order_seen", "rotor_order_stated")
"""Findings on multiples of the rotor's speed."""


@dataclass(frozen=True)
class Examination:
    """One record with its quality, repairs and modes.

    Attributes
    ----------
    record : Record
        Record as it was identified.
    quality : Quality
        Quality of the record as it was read.
    identification : Identification
        Its findings begin with those of the preparation.
    comparison : Comparison or None
        The same modes by every method, if requested.
    """

    record: Record
    quality: Quality
    identification: Identification
    comparison: Comparison | None = None


def examine_file(
    path: Path,
    settings: IdentificationSettings,
    *,
    places: Sequence[Channel] = (),
    picks: tuple[Pick, ...] = (),
    defaults: FileDefaults | None = None,
    compare: bool = False,
    keep: Keep = NOT_KEPT,
    whole: bool = False,
    refuse: Callable[[Record], None] | None = None,
) -> Examination:
    """Read and examine one record; ``defaults`` gives rate and unit of a file that lacks them.

    Parameters
    ----------
    refuse : callable, optional
        Is given the record before it is examined; may raise an error.
    whole : bool
        Whether a file of hours is read in pieces, each at the rate that its modes need.

    Raises
    ------
    InputError
        If the record cannot be read, no channel carries a signal, or the record cannot be identified.
    """
    long = read_whole(path, settings, defaults) if whole else None
    record = read_record(path, defaults) if long is None else long.record
    if refuse is not None:
        refuse(record)
    with located(file=path):
        return examine(record, settings, places=places, picks=picks, compare=compare, keep=keep, long=long)


def examine(
    record: Record,
    settings: IdentificationSettings,
    *,
    places: Sequence[Channel] = (),
    picks: tuple[Pick, ...] = (),
    compare: bool = False,
    keep: Keep = NOT_KEPT,
    long: LongRecord | None = None,
) -> Examination:
    """Assess, repair and identify one record in the rotor's axes.

    Parameters
    ----------
    places : sequence of Channel
        Channels to use by name, with node, height and direction; by default all that measure motion,
        placed as the record says.
    picks : tuple of Pick
        Poles to use instead of the automatic selection, for the records they name.
    compare : bool
        Whether to identify by every method too.
    keep : Keep
        Store of identifications for later calls.
    long : LongRecord, optional
        What the full rate of a long record showed.

    Raises
    ------
    InputError
        If no channel carries a signal, or the record cannot be identified.
    """
    source = with_conditions(record)
    ready, quality, findings, doubts = made_ready(
        source, places, thorough=not settings.quick, known=() if long is None else long.findings
    )
    if long is not None:
        give_back()
    in_axes = knows_yaw(source) or source.metadata.get("axes") == "rotor"

    def compute() -> Identified:
        found = identify(ready, settings, picks=picks)
        if long is not None:
            found = replace(found, notes=long.peaks_above(settings, found.settings))
        found = _beside_orders(found, findings)
        found = _perhaps_folded(found, quality)
        found = doubted(found, doubts)
        found = along_axes(found) if in_axes else found
        found = replace(found, findings=(*findings, *found.findings))
        compared = compare_methods(ready, found, settings) if compare and found.modes else None
        return Identified.of(found, compared)

    key = identified_key(ready, settings, picks, findings, compare=compare, in_rotor_axes=in_axes)
    made = kept(keep, IDENTIFIED, key, compute)
    return Examination(ready, quality, made.found, made.comparison)


def made_ready(
    source: Record, places: Sequence[Channel] = (), *, thorough: bool = True, known: Findings = ()
) -> tuple[Record, Quality, Findings, Findings]:
    """Choose, assess and repair the channels of a record with its conditions, and turn them into rotor axes.

    Parameters
    ----------
    known : tuple of Finding
        Faults of samples that were declared missing before.

    Returns
    -------
    record, quality, findings, doubts
        Quality is that of the chosen channels before repair; doubts are the findings that make every mode
        of the record doubtful.

    Raises
    ------
    InputError
        If no channel carries a signal.
    """
    chosen, absent = placed(source, places) if places else (moving_channels(source), ())
    chosen, repeated = each_sample_once(chosen)
    chosen, stepped = zeros_in_line(chosen)
    chosen, crossed = axes_in_line(chosen)
    quality = assess(chosen, thorough=thorough)
    quality = replace(quality, findings=(*known, *quality.findings))
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
        *(f for f in (*repeated, *stepped) if f.severity != "alarm"),
        *crossed,
        *findings,
        *unplaced(chosen),
        *(() if places else (*unclear(source), *set_aside(source, chosen))),
    )
    return ready, quality, findings, doubts


@dataclass(frozen=True)
class Identified:
    """The expensive part of an examination.

    Attributes
    ----------
    found : Identification
    methods : mapping or None
        The same modes by every method, if requested.
    refused : mapping
        Methods that refused the record, and their reasons.
    """

    found: Identification
    methods: Mapping[str, tuple[ModalEstimate | None, ...]] | None = None
    refused: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, found: Identification, compared: Comparison | None) -> Identified:
        """Return an identification with its comparison by other methods."""
        return cls(found) if compared is None else cls(found, compared.modes, compared.refused)

    @property
    def comparison(self) -> Comparison | None:
        """The same modes by every method, None if not requested."""
        return None if self.methods is None else Comparison(self.found, self.methods, self.refused)


IDENTIFIED = StoredSchema("identified", Identified)
"""Format of stored identifications."""


def identified_key(
    ready: Record,
    settings: IdentificationSettings,
    picks: tuple[Pick, ...],
    findings: tuple[Finding, ...],
    *,
    compare: bool,
    in_rotor_axes: bool,
) -> str:
    """Return the key of an identification; equal keys imply results equal to the last digit.

    The record's name is included, as the result contains it and picks refer to it.
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
    """Flag modes that a multiple of the rotor's speed crossed."""
    orders = [
        (int(f.params["order"] or 0), float(f.params["low_hz"] or 0.0), float(f.params["high_hz"] or 0.0))
        for f in findings
        if f.code in ORDERS_FOUND
    ]
    return replace(found, modes=tuple(beside_orders(mode, orders) for mode in found.modes))


def _perhaps_folded(found: Identification, quality: Quality) -> Identification:
    """Flag the modes of a record without a filter that may be those above half its sample rate."""
    stated = [f.params for f in quality.findings if f.code == "not_filtered"]
    if not stated:
        return found
    half_hz, from_hz = (float(stated[0][key] or 0.0) for key in ("half_hz", "from_hz"))
    reason = Finding("may_be_folded", params={"rate_hz": 2.0 * half_hz})
    modes = (m.flagged(ModeStatus.DOUBTFUL, reason) if m.frequency_hz > from_hz else m for m in found.modes)
    return replace(found, modes=tuple(modes))


def doubted(found: Identification, reasons: Findings) -> Identification:
    """Mark every mode as doubtful for reasons that concern the whole record."""
    modes = []
    for mode in found.modes:
        cycles, decays = mode.frequency_hz * found.duration_s, mode.method == "decay"
        # a decay is judged by its e-folds, not its cycles
        own = [f for f in reasons if not (decays and f.code == "too_short")][:1]
        if cycles < CYCLES and not decays:
            own.append(Finding("few_cycles", params={"cycles": cycles}))
        for reason in own:
            mode = mode.flagged(ModeStatus.DOUBTFUL, reason)
        modes.append(mode)
    return replace(found, modes=tuple(modes))
