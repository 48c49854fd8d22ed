"""What was measured: records, their quality and their preparation.

The names here are the daily ones. Filters are in ``prepare``, rotation to the rotor's axes in ``yaw``,
several loggers in ``merge``, SEP005 dictionaries in ``readers``.
"""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.records.prepare import decimate as decimate, detrend as detrend
    from jackettwin.records.quality import assess as assess
    from jackettwin.records.readers import read_record as read_record, write_record as write_record
    from jackettwin.records.record import Channel as Channel, Record as Record
    from jackettwin.records.repair import repair as repair

door(__name__)
