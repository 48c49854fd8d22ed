"""Readers and writers of record files, one module per format, and their registry."""

from jackettwin.records.readers.pieces import read_record_pieces
from jackettwin.records.readers.registry import (
    Format,
    described_by,
    description_file,
    formats,
    read_record,
    record_files,
    write_record,
)
from jackettwin.records.readers.sep005 import from_sep005, to_sep005

__all__ = [
    "Format",
    "described_by",
    "description_file",
    "formats",
    "from_sep005",
    "read_record",
    "read_record_pieces",
    "record_files",
    "to_sep005",
    "write_record",
]
