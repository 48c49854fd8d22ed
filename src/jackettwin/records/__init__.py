"""What was measured: records, their quality and their preparation."""

from jackettwin.records.record import Channel, Record

__all__ = ["Channel", "Record"]
