from .decks import read_structure as read_structure
from .identification import IdentificationSettings as IdentificationSettings, identify as identify
from .labelled import to_arviz as to_arviz, to_dataframe as to_dataframe, to_xarray as to_xarray
from .records import (
    Channel as Channel,
    Record as Record,
    read_record as read_record,
    write_record as write_record,
)
from .report import build_report as build_report
from .response import (
    build_system as build_system,
    damped_modes as damped_modes,
    state_model as state_model,
    undamped_modes as undamped_modes,
)
from .soil import read_support as read_support
from .structure import Rayleigh as Rayleigh, assemble as assemble, jacket as jacket
from .study import follow as follow, run_twin as run_twin
from .twin import (
    Observation as Observation,
    TwinModel as TwinModel,
    TwinState as TwinState,
    advance as advance,
    empty_state as empty_state,
    observe as observe,
    read_twin as read_twin,
    twin_model as twin_model,
)
from .updating import Posterior as Posterior

__version__: str
