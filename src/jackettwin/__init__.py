"""Digital twin for the jacket foundations of offshore wind turbines.

The names a notebook needs are here; each is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jackettwin.version import __version__ as __version__

if TYPE_CHECKING:
    from jackettwin.identification import IdentificationSettings, identify
    from jackettwin.labelled import to_arviz, to_dataframe, to_xarray
    from jackettwin.records import Channel, Record, read_record, write_record
    from jackettwin.report import build_report
    from jackettwin.response import build_system, damped_modes, undamped_modes
    from jackettwin.soil import read_support
    from jackettwin.structure import Rayleigh, assemble, jacket, read_structure
    from jackettwin.twin import (
        Observation,
        TwinModel,
        TwinState,
        advance,
        empty_state,
        observe,
        read_twin,
        run_twin,
        twin_model,
    )
    from jackettwin.twin.follow import follow_twin as follow
    from jackettwin.updating import Posterior

_HOME = {
    "identification": "IdentificationSettings identify",
    "labelled": "to_arviz to_dataframe to_xarray",
    "records": "Channel Record read_record write_record",
    "report": "build_report",
    "response": "build_system damped_modes undamped_modes",
    "soil": "read_support",
    "structure": "Rayleigh assemble jacket read_structure",
    "twin": "Observation TwinModel TwinState advance empty_state follow observe read_twin run_twin "
    "twin_model",
    "updating": "Posterior",
}

__all__ = [
    "Channel",
    "IdentificationSettings",
    "Observation",
    "Posterior",
    "Rayleigh",
    "Record",
    "TwinModel",
    "TwinState",
    "advance",
    "assemble",
    "build_report",
    "build_system",
    "damped_modes",
    "empty_state",
    "follow",
    "identify",
    "jacket",
    "observe",
    "read_record",
    "read_structure",
    "read_support",
    "read_twin",
    "run_twin",
    "to_arviz",
    "to_dataframe",
    "to_xarray",
    "twin_model",
    "undamped_modes",
    "write_record",
]


def __getattr__(name: str) -> Any:
    home = next((home for home, names in _HOME.items() if name in names.split()), None)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "follow":  # the function: the module that it lives in has the same name
        return import_module(f"{__name__}.twin.follow").follow_twin
    return getattr(import_module(f"{__name__}.{home}"), name)
