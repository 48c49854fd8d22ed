"""What was measured: records, their quality and their preparation."""

from jackettwin.records.merge import merge, shared_channels
from jackettwin.records.prepare import bandpass, decimate, detrend, highpass
from jackettwin.records.quality import Quality, assess
from jackettwin.records.readers import from_sep005, read_record, to_sep005, write_record
from jackettwin.records.record import Channel, Record
from jackettwin.records.repair import repair
from jackettwin.records.yaw import to_global_axes, to_rotor_axes

__all__ = [
    "Channel",
    "Quality",
    "Record",
    "assess",
    "bandpass",
    "decimate",
    "detrend",
    "from_sep005",
    "highpass",
    "merge",
    "read_record",
    "repair",
    "shared_channels",
    "to_global_axes",
    "to_rotor_axes",
    "to_sep005",
    "write_record",
]
