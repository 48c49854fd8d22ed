"""From a file to an observation: quality, repair, identification. Stateless, for one record or a farm."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jackettwin.errors import InputError, located
from jackettwin.identification import Identification, IdentificationSettings, identify
from jackettwin.records import Record, assess, read_record, repair
from jackettwin.records.quality import Quality


@dataclass(frozen=True)
class Observation:
    """One record, judged, repaired and identified.

    Attributes
    ----------
    record : Record
        As it was identified.
    quality : Quality
        Of the record as it was read.
    """

    record: Record
    quality: Quality
    identification: Identification


def observe(
    path: Path,
    settings: IdentificationSettings,
    *,
    channels: tuple[str, ...] | None = None,
    drop_dead: bool = False,
) -> Observation:
    """Read, judge, repair and identify one record.

    Parameters
    ----------
    channels : tuple of str, optional
        Only these; default: all that measure motion.
    drop_dead : bool
        Leave channels that carry nothing out instead of refusing the record.

    Raises
    ------
    InputError
        If the record cannot be read, a channel carries nothing, or the record cannot be identified.
    """
    record = read_record(path)
    with located(file=path):
        record = record.select(channels) if channels else moving_channels(record)
        quality = assess(record)
        if not drop_dead:
            _refuse_dead(quality)
        repaired = repair(record, quality)
        return Observation(repaired, quality, identify(repaired, settings))


MOTION = ("acceleration", "velocity", "displacement")


def moving_channels(record: Record) -> Record:
    """Return the record with only the channels that measure motion.

    Raises
    ------
    InputError
        If there is none.
    """
    names = [c.name for c in record.channels if c.quantity in MOTION]
    if not names:
        raise InputError(
            "no channel measures motion",
            field="channels",
            value=record.channel_names,
            allowed=", ".join(MOTION),
            remedy="state the quantity of each channel",
        )
    return record.select(names)


def _refuse_dead(quality: Quality) -> None:
    for channel in quality.channels:
        if channel.dead:
            empty = channel.gap_share > 0.0
            raise InputError(
                "channel is empty" if empty else "channel is constant",
                field=f"channels.{channel.name}",
                value=f"{100 * channel.gap_share:.0f} % missing" if empty else "no variation",
                allowed="a signal that varies",
                remedy="repair the sensor's data, or leave the channel out (sensors: of a twin; --drop-dead)",
            )
