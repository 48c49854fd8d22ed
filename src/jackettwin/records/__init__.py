"""What was measured: records, their quality and their preparation."""

from jackettwin.records.prepare import bandpass, decimate, detrend, highpass
from jackettwin.records.record import Channel, Record

__all__ = ["Channel", "Record", "bandpass", "decimate", "detrend", "highpass"]
