"""From a file to an observation: quality, repair, rotor axes, identification. Stateless."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.findings import Finding
from jackettwin.identification import Identification, IdentificationSettings, identify
from jackettwin.identification.comparison import Comparison, compare_methods
from jackettwin.identification.many_records.pairs import along_axes
from jackettwin.identification.picks import Pick
from jackettwin.identification.status import ModeStatus
from jackettwin.records import Record, assess, detrend, read_record, repair
from jackettwin.records.conditions import with_conditions
from jackettwin.records.quality import Quality
from jackettwin.records.readers.channels import Unsaid
from jackettwin.records.rotor_orders import RotorOrder, rotor_speed, without_orders
from jackettwin.records.yaw import is_horizontal, knows_yaw, to_rotor_axes, yaw_of
from jackettwin.response.sensors import Sensor

WORTH_SAYING = 1e-3
"""Share of a channel's power from which a tone is mentioned."""
FEWEST_TO_COMPARE = 3
"""Sensors without a place of which it is said that they cannot be compared."""
MOTION = ("acceleration", "velocity", "displacement")
"""Quantities of which one record may mix several."""
DEFORMATION = ("inclination", "strain")
"""Quantities identified where no channel measures motion, the first of them that there is."""


@dataclass(frozen=True)
class Observation:
    """One record, judged, repaired and identified.

    Attributes
    ----------
    record : Record
        As it was identified.
    quality : Quality
        Of the record as it was read.
    comparison : Comparison or None
        The same modes by every method, if it was asked for.
    """

    record: Record
    quality: Quality
    identification: Identification
    comparison: Comparison | None = None


def observe(
    path: Path,
    settings: IdentificationSettings,
    *,
    sensors: tuple[Sensor, ...] = (),
    picks: tuple[Pick, ...] = (),
    unsaid: Unsaid | None = None,
    compare: bool = False,
) -> Observation:
    """Read, judge, repair, turn to the rotor's axes and identify one record.

    Parameters
    ----------
    sensors : tuple of Sensor, optional
        Only these channels, at these places; default: all that measure motion, where the record says.
    picks : tuple of Pick
        Poles to take instead of the automatic selection, for the records they name.
    unsaid : Unsaid, optional
        Rate and unit, for a file that does not say them.
    compare : bool
        Identify by every method as well.

    Raises
    ------
    InputError
        If the record cannot be read, no channel carries a signal, or the record cannot be identified.
    """
    record = with_conditions(read_record(path, unsaid))
    with located(file=path):
        chosen = _placed(record, sensors) if sensors else moving_channels(record)
        quality = assess(chosen)
        ready, notes = in_rotor_axes(repair(chosen, quality), record)
        speed = rotor_speed(record)
        orders: tuple[RotorOrder, ...] = ()
        if speed is not None:
            ready, orders = without_orders(ready, speed)
        found = _beside_orders(identify(ready, settings, picks=picks), orders)
        if knows_yaw(record) or record.metadata.get("axes") == "rotor":
            found = along_axes(found)
        found = replace(found, warnings=(*notes, *found.warnings), notes=(*found.notes, *_unplaced(chosen)))
        if not sensors:
            found = replace(found, notes=(*found.notes, *_unknown(record), *_set_aside(record, chosen)))
        compared = compare_methods(ready, found, settings) if compare and found.modes else None
        return Observation(ready, quality, found, compared)


def _beside_orders(found: Identification, orders: tuple[RotorOrder, ...]) -> Identification:
    """Say which tones of the rotor were taken out, and flag modes they passed."""
    notes = tuple(
        f"{o.order}P, {o.low_hz:.3g} to {o.high_hz:.3g} Hz by the measured rotor speed: taken out, "
        f"{o.share:.1%} of a channel's power at most"
        for o in orders
        if o.share > WORTH_SAYING
    )
    modes = []
    for mode in found.modes:
        half = mode.damping_ratio * mode.frequency_hz
        passing = [o for o in orders if o.low_hz - half < mode.frequency_hz < o.high_hz + half]
        if passing:
            order = Finding("rotor_order_passes", params={"order": passing[0].order})
            mode = mode.flagged(ModeStatus.DOUBTFUL, order)
        modes.append(mode)
    return replace(found, modes=tuple(modes), warnings=(*notes, *found.warnings))


def in_rotor_axes(record: Record, source: Record) -> tuple[Record, tuple[str, ...]]:
    """Return a record detrended and turned to the rotor's axes if ``source`` knows the yaw, and remarks.

    Channels keep their names, so that records at different yaw compare and sensors find them: the one
    nearer to global x is the fore-aft one. A yaw that is zero throughout changes nothing.
    """
    if record.metadata.get("axes") == "rotor":
        return record, ()
    if not knows_yaw(source):
        frames = {channel.frame for channel in record.channels if is_horizontal(channel)}
        mixed = "the yaw is not known: sensors on the nacelle are taken to stand as the fixed ones do"
        return record, (mixed,) if len(frames) > 1 else ()
    yaw = yaw_of(source)
    if not np.any(yaw):
        return record, ()
    turned = to_rotor_axes(detrend(record), yaw_rad=yaw, rename=False)
    lost = turned.metadata.get("without_partner", [])
    if not turned.channels:
        return record, ("not turned to the rotor's axes: no two horizontal channels sit at one place",)
    if not lost:
        return turned, ()
    return turned, (f"left out, no second horizontal channel at the same place: {', '.join(lost)}",)


def _unplaced(record: Record) -> tuple[str, ...]:
    """Say that signs and units were not judged, where several sensors do not say where they sit."""
    nowhere = [c.name for c in record.channels if c.node is None and c.height_m is None]
    if len(nowhere) < FEWEST_TO_COMPARE:
        return ()
    names = ", ".join(nowhere[:3]) + (" …" if len(nowhere) > 3 else "")
    return (
        f"{names}: the place is not known (height_m or node in the JSON beside the record): swapped signs "
        "and wrong units are not looked for",
    )


def _unknown(record: Record) -> tuple[str, ...]:
    """Name the channels that are left out because nobody knows what they measure."""
    names = [f"{c.name} ({c.unit})" for c in record.channels if c.quantity == "other"]
    if not names:
        return ()
    what = ", ".join(names[:5]) + (" …" if len(names) > 5 else "")
    return (f"left out, neither name and unit nor the JSON say what they measure: {what}",)


def _set_aside(record: Record, chosen: Record) -> tuple[str, ...]:
    """Name the inclinations and strains beside channels that measure motion."""
    names = [
        c.name for c in record.channels if c.quantity in DEFORMATION and c.name not in chosen.channel_names
    ]
    if not names:
        return ()
    what = ", ".join(names[:5]) + (" …" if len(names) > 5 else "")
    return (f"left out beside accelerations, identify them in a file of their own: {what}",)


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
    raise InputError(
        "no channel measures motion",
        field="channels",
        value=record.channel_names,
        allowed=", ".join((*MOTION, *DEFORMATION)),
        remedy="state quantity and unit in the JSON beside the record (identify: or --unit)",
    )


def _placed(record: Record, sensors: tuple[Sensor, ...]) -> Record:
    """Return the channels of the sensors, where and which way these say they point."""
    chosen = record.select([s.channel for s in sensors])
    channels = []
    for channel, s in zip(chosen.channels, sensors, strict=True):
        length = float(np.linalg.norm(s.direction)) or 1.0
        x, y, z = (float(v) / length for v in s.direction)
        channels.append(replace(channel, node=s.node, height_m=s.height_m, direction=(x, y, z)))
    return replace(chosen, channels=tuple(channels))
