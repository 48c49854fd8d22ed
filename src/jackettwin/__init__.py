"""Digital twin for the jacket foundations of offshore wind turbines.

The names a notebook needs are here; each is loaded when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jackettwin.doors import door
from jackettwin.version import __version__ as __version__

if TYPE_CHECKING:
    from jackettwin.identification import (
        IdentificationSettings as IdentificationSettings,
        identify as identify,
    )
    from jackettwin.labelled import to_arviz as to_arviz, to_dataframe as to_dataframe, to_xarray as to_xarray
    from jackettwin.records import (
        Channel as Channel,
        Record as Record,
        read_record as read_record,
        write_record as write_record,
    )
    from jackettwin.report import build_report as build_report
    from jackettwin.response import (
        build_system as build_system,
        damped_modes as damped_modes,
        undamped_modes as undamped_modes,
    )
    from jackettwin.soil import read_support as read_support
    from jackettwin.structure import (
        Rayleigh as Rayleigh,
        assemble as assemble,
        jacket as jacket,
        read_structure as read_structure,
    )
    from jackettwin.twin import (
        Observation as Observation,
        TwinModel as TwinModel,
        TwinState as TwinState,
        advance as advance,
        empty_state as empty_state,
        observe as observe,
        read_twin as read_twin,
        run_twin as run_twin,
        twin_model as twin_model,
    )
    from jackettwin.twin.follow import follow_twin as follow
    from jackettwin.updating import Posterior as Posterior

__all__ = ["follow"]  # for type checkers, to whom a name that changes is not public; the door lists all
door(__name__)
