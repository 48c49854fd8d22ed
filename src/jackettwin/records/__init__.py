"""What was measured: records, their quality and their preparation.

The names here are the daily ones. Other filters are in ``prepare``, SEP005 dictionaries in ``readers``.
"""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.records.merge import merge as merge, shared_channels as shared_channels
    from jackettwin.records.prepare import bandpass as bandpass, decimate as decimate, detrend as detrend
    from jackettwin.records.quality import assess as assess
    from jackettwin.records.readers import read_record as read_record, write_record as write_record
    from jackettwin.records.record import Channel as Channel, Record as Record
    from jackettwin.records.repair import repair as repair
    from jackettwin.records.yaw import to_global_axes as to_global_axes, to_rotor_axes as to_rotor_axes

door(__name__)
