"""Files in and out: one small reader a format behind one registry."""

from jackettwin.records.readers.registry import FORMATS, read_record, write_record

__all__ = ["FORMATS", "read_record", "write_record"]
