"""Digital twin for the jacket foundations of offshore wind turbines.

The names a notebook needs are here; each is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jackettwin.version import __version__ as __version__

if TYPE_CHECKING:
    from jackettwin.identification import IdentificationSettings, identify
    from jackettwin.records import Channel, Record, read_record, write_record
    from jackettwin.report import build_report
    from jackettwin.response import build_system, damped_modes, undamped_modes
    from jackettwin.soil import read_support
    from jackettwin.structure import Rayleigh, assemble, jacket, read_structure
    from jackettwin.twin import read_twin, run_twin

_HOME = {
    "Channel": "records",
    "IdentificationSettings": "identification",
    "Rayleigh": "structure",
    "Record": "records",
    "assemble": "structure",
    "build_report": "report",
    "build_system": "response",
    "damped_modes": "response",
    "identify": "identification",
    "jacket": "structure",
    "read_record": "records",
    "read_structure": "structure",
    "read_support": "soil",
    "read_twin": "twin",
    "run_twin": "twin",
    "undamped_modes": "response",
    "write_record": "records",
}

__all__ = [
    "Channel",
    "IdentificationSettings",
    "Rayleigh",
    "Record",
    "assemble",
    "build_report",
    "build_system",
    "damped_modes",
    "identify",
    "jacket",
    "read_record",
    "read_structure",
    "read_support",
    "read_twin",
    "run_twin",
    "undamped_modes",
    "write_record",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
