"""Preparation steps of a record before identification, each ``Record -> (Record, findings)``."""

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
"""Share of a channel's power above which a tone is reported."""
FEWEST_TO_COMPARE = 3
"""Number of sensors without a position above which a finding states that they cannot be compared."""
MOTION = ("acceleration", "velocity", "displacement")
"""Quantities of motion, which one record may mix."""
DEFORMATION = ("inclination", "strain")
"""Quantities used if no channel measures motion; the first one present is taken."""
_NAMED = 5
"""Number of channels that a finding names."""

Findings = tuple[Finding, ...]
Step = Callable[[Record], tuple[Record, Findings]]
"""One preparation step of a record."""


def prepared(record: Record, steps: Iterable[Step]) -> tuple[Record, Findings]:
    """Return a record after some steps, with all their findings."""
    findings: list[Finding] = []
    for step in steps:
        record, found = step(record)
        findings += found
    return record, tuple(findings)


def repaired(record: Record, *, quality: Quality) -> tuple[Record, Findings]:
    """Remove samples that the quality check reports as damaged."""
    return repair(record, quality), ()


def cut_to_common_time(record: Record, *, quality: Quality) -> tuple[Record, Findings]:
    """Cut a record to the time that all loggers share once in step; earlier steps need all samples."""
    return common_time(record, quality), ()


def in_rotor_axes(record: Record, *, source: Record) -> tuple[Record, Findings]:
    """Detrend a record and rotate it to the rotor's axes if ``source`` contains the yaw.

    Channels keep their names, so that records at different yaw remain comparable:
    of two, the one nearer to global x becomes fore-aft. A yaw of zero throughout changes nothing.
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
    """Subtract the lowest rotor tones of measured speed; report where other orders are."""
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
    """Return the channels that measure motion; if there are none, inclinations or strains.

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
        "the unit is missing, and no channel's name gives its quantity"
        if bare
        else "no channel measures motion",
        field="unit" if bare else "channels",
        value=None if bare else _listed(f"{c.name} [{c.unit}]" for c in record.channels),
        allowed="; ".join(
            f"{kind} in {', '.join(known_units(kind)[:3])}" for kind in (*MOTION, *DEFORMATION)
        ),
        remedy="--unit (identify, init) or logger.unit (twin) states it"
        if bare
        else 'write "unit" (and for counts and volts "gain") of each channel into the JSON beside the record',
    )


def placed(record: Record, places: Sequence[Channel]) -> tuple[Record, Findings]:
    """Return the channels named in ``places`` with their nodes, heights and directions, and the absent ones.

    A name close to that of a channel without a place is taken as a typing error, which ``select`` refuses.
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
    """Report that signs and units were not checked because several sensors have no place."""
    nowhere = [c.name for c in record.channels if c.node is None and c.height_m is None]
    return (Finding("places_unknown", _listed(nowhere)),) if len(nowhere) >= FEWEST_TO_COMPARE else ()


def unclear(record: Record) -> Findings:
    """Report the channels that are omitted because their quantity is unknown."""
    names = [f"{c.name} ({c.unit})" for c in record.channels if c.quantity == "other"]
    return (Finding("channels_unclear", _listed(names)),) if names else ()


def set_aside(record: Record, chosen: Record) -> Findings:
    """Report inclinations and strains that are omitted because other channels measure motion."""
    names = [
        c.name for c in record.channels if c.quantity in DEFORMATION and c.name not in chosen.channel_names
    ]
    return (Finding("deformation_set_aside", _listed(names)),) if names else ()


def _listed(names: Iterable[str]) -> str:
    """Return names as one text, at most ``_NAMED`` of them."""
    listed = list(names)
    return ", ".join(listed[:_NAMED]) + (" …" if len(listed) > _NAMED else "")
