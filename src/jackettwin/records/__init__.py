"""What was measured: records, their quality and their preparation.

The names here are the daily ones. Filters are in ``prepare``, rotation to the rotor's axes in ``yaw``,
several loggers in ``merge``, SEP005 dictionaries in ``readers``.
"""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.records.prepare import decimate, detrend
    from jackettwin.records.quality import assess
    from jackettwin.records.readers import read_record, write_record
    from jackettwin.records.record import Channel, Record
    from jackettwin.records.repair import repair

__all__ = ["Channel", "Record", "assess", "decimate", "detrend", "read_record", "repair", "write_record"]

door(
    __name__,
    {
        "prepare": "decimate detrend",
        "quality": "assess",
        "readers": "read_record write_record",
        "record": "Channel Record",
        "repair": "repair",
    },
)
