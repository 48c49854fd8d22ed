"""What is kept of the living twin: one database, one folder of waveforms."""

from jackettwin.store.database import open_database, reading, sqlite_url, writing
from jackettwin.store.waveforms import read_waveform, waveform_path, write_waveform

__all__ = [
    "open_database",
    "read_waveform",
    "reading",
    "sqlite_url",
    "waveform_path",
    "write_waveform",
    "writing",
]
