"""A record examined: judged, repaired, turned to the rotor's axes and identified. Stateless.

What is done to the samples is a list of steps ``Record -> (Record, findings)``; a new one is a function and
a line in :func:`examine`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.findings import Finding
from jackettwin.identification import Comparison, Identification, IdentificationSettings, Pick, identify
from jackettwin.identification.comparison import compare_methods
from jackettwin.identification.many_records.pairs import along_axes
from jackettwin.identification.selection.candidates import beside_orders
from jackettwin.identification.tones.rotor_speed import higher_orders
from jackettwin.quantities import known_units
from jackettwin.records import (
    Record,
    Unsaid,
    assess,
    detrend,
    knows_yaw,
    read_record,
    repair,
    to_rotor_axes,
    with_conditions,
)
from jackettwin.records.processing.tones import RotorOrder, rotor_speed, stated_orders, without_orders
from jackettwin.records.processing.yaw import is_horizontal, yaw_of
from jackettwin.records.quality.record_quality import Quality
from jackettwin.records.quality.repair import common_time
from jackettwin.twin.cache import IDENTIFIED, NOT_KEPT, Identified, Keep, identified_key, kept
from jackettwin.twin.record_checks import UNFIT, doubted, each_sample_once, too_short, zeros_in_line

if TYPE_CHECKING:
    from jackettwin.response import Sensor

WORTH_SAYING = 1e-3
"""Share of a channel's power from which a tone is mentioned."""
ORDERS_FOUND = ("rotor_order_removed", "rotor_order_weak", "rotor_order_seen", "rotor_order_stated")
"""Findings that say where a multiple of the rotor's speed was."""
FEWEST_TO_COMPARE = 3
"""Sensors without a place of which it is said that they cannot be compared."""
MOTION = ("acceleration", "velocity", "displacement")
"""Quantities of which one record may mix several."""
DEFORMATION = ("inclination", "strain")
"""Quantities identified where no channel measures motion, the first of them that there is."""
_NAMED = 5
"""Channels that a finding names; more are dots."""

Findings = tuple[Finding, ...]
Step = Callable[[Record], tuple[Record, Findings]]
"""One thing done to a record before it is identified."""


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
    sensors: tuple[Sensor, ...] = (),
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
        return examine(record, settings, sensors=sensors, picks=picks, compare=compare, keep=keep)


def examine(
    record: Record,
    settings: IdentificationSettings,
    *,
    sensors: tuple[Sensor, ...] = (),
    picks: tuple[Pick, ...] = (),
    compare: bool = False,
    keep: Keep = NOT_KEPT,
) -> Examination:
    """Judge, repair, turn to the rotor's axes and identify one record.

    Parameters
    ----------
    sensors : tuple of Sensor, optional
        Only these channels, at these places; default: all that measure motion, where the record says.
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
    chosen, absent = _placed(source, sensors) if sensors else (moving_channels(source), ())
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
        *_unplaced(chosen),
        *(() if sensors else (*_unclear(source), *_set_aside(source, chosen))),
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


def prepared(record: Record, steps: Iterable[Step]) -> tuple[Record, Findings]:
    """Return a record after some steps, and everything they found."""
    findings: list[Finding] = []
    for step in steps:
        record, found = step(record)
        findings += found
    return record, tuple(findings)


def repaired(record: Record, *, quality: Quality) -> tuple[Record, Findings]:
    """Take out what the quality says is damaged; what was damaged stands in the quality."""
    return repair(record, quality), ()


def cut_to_common_time(record: Record, *, quality: Quality) -> tuple[Record, Findings]:
    """Cut a record to what all loggers have once in step; earlier steps need the source's samples."""
    return common_time(record, quality), ()


def in_rotor_axes(record: Record, *, source: Record) -> tuple[Record, Findings]:
    """Detrend a record and turn it to the rotor's axes, if ``source`` knows the yaw.

    Channels keep their names, so that records at different yaw compare and sensors find them: the one
    nearer to global x is the fore-aft one. A yaw that is zero throughout changes nothing.
    """
    if record.metadata.get("axes") == "rotor":
        return record, ()
    if not knows_yaw(source):
        frames = {channel.frame for channel in record.channels if is_horizontal(channel)}
        return record, (Finding("yaw_unknown"),) if len(frames) > 1 else ()
    yaw = yaw_of(source)
    if not np.any(yaw):
        return record, ()
    turned = to_rotor_axes(detrend(record), yaw_rad=yaw, rename=False)
    lost = turned.metadata.get("without_partner", [])
    if not turned.channels:
        return record, (Finding("not_in_rotor_axes"),)
    return turned, (Finding("channels_without_partner", _listed(lost)),) if lost else ()


def without_rotor_orders(record: Record, *, source: Record) -> tuple[Record, Findings]:
    """Take out the lowest tones of a rotor of measured speed; say where others, or of a stated one, are."""
    speed = rotor_speed(source)
    if speed is None:
        stated = stated_orders(source.conditions, source.duration_s)
        return record, tuple(_order("rotor_order_stated", order) for order in stated)
    left, orders = without_orders(record, speed)
    higher = higher_orders(detrend(left).data, left.sample_rate_hz, speed / (2.0 * np.pi))
    return left, (
        *(_order("rotor_order_removed" if o.share > WORTH_SAYING else "rotor_order_weak", o) for o in orders),
        *(_order("rotor_order_seen", RotorOrder(*seen, share=0.0)) for seen in higher),
    )


def _order(code: str, o: RotorOrder) -> Finding:
    params = {"order": o.order, "low_hz": o.low_hz, "high_hz": o.high_hz, "share": o.share}
    return Finding(code, f"{o.order}P", params)


def _beside_orders(found: Identification, findings: Findings) -> Identification:
    """Flag the modes that a multiple of the rotor's speed passed."""
    orders = [
        (int(f.params["order"] or 0), float(f.params["low_hz"] or 0.0), float(f.params["high_hz"] or 0.0))
        for f in findings
        if f.code in ORDERS_FOUND
    ]
    return replace(found, modes=tuple(beside_orders(mode, orders) for mode in found.modes))


def _unplaced(record: Record) -> Findings:
    """Say that signs and units were not judged, where several sensors do not say where they sit."""
    nowhere = [c.name for c in record.channels if c.node is None and c.height_m is None]
    return (Finding("places_unknown", _listed(nowhere)),) if len(nowhere) >= FEWEST_TO_COMPARE else ()


def _unclear(record: Record) -> Findings:
    """Name the channels that are left out because nobody knows what they measure."""
    names = [f"{c.name} ({c.unit})" for c in record.channels if c.quantity == "other"]
    return (Finding("channels_unclear", _listed(names)),) if names else ()


def _listed(names: Iterable[str]) -> str:
    """Return names in one text, at most ``_NAMED`` of them."""
    listed = list(names)
    return ", ".join(listed[:_NAMED]) + (" …" if len(listed) > _NAMED else "")


def _set_aside(record: Record, chosen: Record) -> Findings:
    """Name the inclinations and strains beside channels that measure motion."""
    names = [
        c.name for c in record.channels if c.quantity in DEFORMATION and c.name not in chosen.channel_names
    ]
    return (Finding("deformation_set_aside", _listed(names)),) if names else ()


def moving_channels(record: Record) -> Record:
    """Return the record with only the channels that measure motion; without any, its inclinations or strains.

    Raises
    ------
    InputError
        If there is none.
    """
    for kinds in (MOTION, *((kind,) for kind in DEFORMATION)):
        names = [c.name for c in record.channels if c.quantity in kinds]
        if names:
            return record.select(names)
    bare = all(c.unit == "-" for c in record.channels)
    raise InputError(
        "unit is missing, and no channel's name says what it measures"
        if bare
        else "no channel measures motion",
        field="unit" if bare else "channels",
        value=None if bare else _listed(f"{c.name} [{c.unit}]" for c in record.channels),
        allowed="; ".join(
            f"{kind} in {', '.join(known_units(kind)[:3])}" for kind in (*MOTION, *DEFORMATION)
        ),
        remedy="--unit (identify, init) or logger.unit (twin) states it"
        if bare
        else 'write "unit" (of counts and volts "gain", too) of each channel into the JSON beside the record',
    )


def _placed(record: Record, sensors: tuple[Sensor, ...]) -> tuple[Record, Findings]:
    """Return the channels of the sensors, where and which way these say they point, and those it lacks.

    A name that is nearly that of a channel without a sensor is a slip, which ``select`` refuses.
    """
    names = {s.channel for s in sensors}
    others = [name for name in record.channel_names if name not in names]
    absent = [name for name in names.difference(record.channel_names) if not did_you_mean(name, others)]
    if len(absent) == len(names):
        absent = []
    here = [s for s in sensors if s.channel not in absent]
    chosen = record.select([s.channel for s in here])
    channels = []
    for channel, s in zip(chosen.channels, here, strict=True):
        length = float(np.linalg.norm(s.direction)) or 1.0
        x, y, z = (float(v) / length for v in s.direction)
        channels.append(replace(channel, node=s.node, height_m=s.height_m, direction=(x, y, z)))
    findings = (Finding("sensors_absent", _listed(sorted(absent))),) if absent else ()
    return replace(chosen, channels=tuple(channels)), findings
