from .advance import advance as advance, advance_all as advance_all
from .config import TwinConfig as TwinConfig
from .examine import Examination as Examination, examine as examine, examine_file as examine_file
from .files import read_twin as read_twin, shipped_twins as shipped_twins
from .model import TwinModel as TwinModel, twin_model as twin_model
from .observation import OBSERVATION as OBSERVATION, Observation as Observation
from .observe import observe as observe
from .state import STATE as STATE, TwinState as TwinState, empty_state as empty_state
