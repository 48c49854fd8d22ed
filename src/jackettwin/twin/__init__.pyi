from .advance import advance as advance, advance_all as advance_all
from .config import TwinConfig as TwinConfig, assembled as assembled, assembled_dry as assembled_dry
from .exact_sums import UNIT as UNIT, average as average, plus as plus
from .files import read_twin as read_twin, shipped_twins as shipped_twins
from .inputs import inputs_document as inputs_document
from .life.damage_sums import SensedTime as SensedTime, WeldSums as WeldSums
from .life.likely_structures import StressModel as StressModel
from .life.sensed_damage import DAMAGE_UNIT as DAMAGE_UNIT
from .life.settings import LifeSettings as LifeSettings
from .life.weld_map import (
    RestingLoads as RestingLoads,
    WeldMap as WeldMap,
    planned_joints as planned_joints,
    weld_map as weld_map,
)
from .model import TwinModel as TwinModel, twin_model as twin_model
from .observation import (
    OBSERVATION as OBSERVATION,
    Observation as Observation,
    Recognised as Recognised,
)
from .observe import examined as examined, observe as observe
from .observe_files import Failed as Failed, observe_files as observe_files, sorted_out as sorted_out
from .pair_angles import stations as stations
from .rotor_at_work import (
    AT_WORK_STD as AT_WORK_STD,
    USUAL_WIND_M_S as USUAL_WIND_M_S,
    RotorSide as RotorSide,
    of_side as of_side,
    rotor_at_work as rotor_at_work,
    rotor_by_wind as rotor_by_wind,
    stiffness_at_work as stiffness_at_work,
)
from .state import (
    ALL as ALL,
    STATE as STATE,
    UNDATED as UNDATED,
    AngleSums as AngleSums,
    Day as Day,
    OperationTotal as OperationTotal,
    TwinState as TwinState,
    empty_state as empty_state,
)
from .stated_model import model_of_records as model_of_records, stated_model as stated_model
from .tolerances.registry import (
    REMAINDERS as REMAINDERS,
    SCALES as SCALES,
    KnownTolerance as KnownTolerance,
    directions as directions,
    suspects as suspects,
)
from .water import WaterConfig as WaterConfig, in_water as in_water
