"""What is done to a record before it is identified: a list of steps ``Record -> (Record, findings)``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from jackettwin.errors import InputError, did_you_mean
from jackettwin.findings import Finding
from jackettwin.identification.tones.rotor_speed import higher_orders
from jackettwin.quantities import known_units
from jackettwin.records import Channel, Record, detrend, knows_yaw, repair, to_rotor_axes
from jackettwin.records.processing.tones import RotorOrder, rotor_speed, stated_orders, without_orders
from jackettwin.records.processing.yaw import is_horizontal, yaw_of
from jackettwin.records.quality.record_quality import Quality
from jackettwin.records.quality.repair import common_time

WORTH_SAYING = 1e-3
"""Share of a channel's power from which a tone is mentioned."""
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


def placed(record: Record, places: Sequence[Channel]) -> tuple[Record, Findings]:
    """Return the channels named in ``places`` at their nodes, heights and directions, and the absent ones.

    A name that is nearly that of a channel without a place is a slip, which ``select`` refuses.
    """
    names = {place.name for place in places}
    others = [name for name in record.channel_names if name not in names]
    absent = [name for name in names.difference(record.channel_names) if not did_you_mean(name, others)]
    if len(absent) == len(names):
        absent = []
    here = [place for place in places if place.name not in absent]
    chosen = record.select([place.name for place in here])
    channels = []
    for channel, place in zip(chosen.channels, here, strict=True):
        x, y, z = np.asarray(place.direction) / (np.linalg.norm(place.direction) or 1.0)
        along = float(x), float(y), float(z)
        channels.append(replace(channel, node=place.node, height_m=place.height_m, direction=along))
    findings = (Finding("sensors_absent", _listed(sorted(absent))),) if absent else ()
    return replace(chosen, channels=tuple(channels)), findings


def unplaced(record: Record) -> Findings:
    """Say that signs and units were not judged, where several sensors do not say where they sit."""
    nowhere = [c.name for c in record.channels if c.node is None and c.height_m is None]
    return (Finding("places_unknown", _listed(nowhere)),) if len(nowhere) >= FEWEST_TO_COMPARE else ()


def unclear(record: Record) -> Findings:
    """Name the channels that are left out because nobody knows what they measure."""
    names = [f"{c.name} ({c.unit})" for c in record.channels if c.quantity == "other"]
    return (Finding("channels_unclear", _listed(names)),) if names else ()


def set_aside(record: Record, chosen: Record) -> Findings:
    """Name the inclinations and strains beside channels that measure motion."""
    names = [
        c.name for c in record.channels if c.quantity in DEFORMATION and c.name not in chosen.channel_names
    ]
    return (Finding("deformation_set_aside", _listed(names)),) if names else ()


def _listed(names: Iterable[str]) -> str:
    """Return names in one text, at most ``_NAMED`` of them."""
    listed = list(names)
    return ", ".join(listed[:_NAMED]) + (" …" if len(listed) > _NAMED else "")
