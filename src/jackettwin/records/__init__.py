"""What was measured: records, their quality and their preparation."""

from jackettwin.records.prepare import bandpass, decimate, detrend, highpass
from jackettwin.records.readers import read_record, write_record
from jackettwin.records.record import Channel, Record

__all__ = [
    "Channel",
    "Record",
    "bandpass",
    "decimate",
    "detrend",
    "highpass",
    "read_record",
    "write_record",
]
