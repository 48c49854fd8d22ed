"""What was measured: records, their quality and their preparation."""

from jackettwin.records.prepare import bandpass, decimate, detrend, highpass
from jackettwin.records.quality import Quality, assess
from jackettwin.records.readers import from_sep005, read_record, to_sep005, write_record
from jackettwin.records.record import Channel, Record
from jackettwin.records.repair import repair

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
    "read_record",
    "repair",
    "to_sep005",
    "write_record",
]
