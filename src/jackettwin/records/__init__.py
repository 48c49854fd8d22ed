"""What was measured: records, their quality and their preparation."""

from jackettwin.records.prepare import bandpass, decimate, detrend, highpass
from jackettwin.records.readers import from_sep005, read_record, to_sep005, write_record
from jackettwin.records.record import Channel, Record

__all__ = [
    "Channel",
    "Record",
    "bandpass",
    "decimate",
    "detrend",
    "from_sep005",
    "highpass",
    "read_record",
    "to_sep005",
    "write_record",
]
