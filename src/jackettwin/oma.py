"""Operational modal analysis and monitoring of any structure, from its records alone.

Records are read, judged and repaired; their modes are identified, fused and watched through time. Nothing
here knows of jackets, soil or models: ``docs/tutorials/any_structure.md`` shows a bridge.
"""

from jackettwin.identification import (
    FusedIdentification,
    Identification,
    IdentificationSettings,
    ModalEstimate,
    fuse,
    identify,
    mac,
)
from jackettwin.records import Channel, Record, assess, read_record, repair, write_record
from jackettwin.watching import History, Look, Watch, start as start_watch, step as watch_day

__all__ = [
    "Channel",
    "FusedIdentification",
    "History",
    "Identification",
    "IdentificationSettings",
    "Look",
    "ModalEstimate",
    "Record",
    "Watch",
    "assess",
    "fuse",
    "identify",
    "mac",
    "read_record",
    "repair",
    "start_watch",
    "watch_day",
    "write_record",
]
