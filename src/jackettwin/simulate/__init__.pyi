from .batch import pending_cases as pending_cases, record_path as record_path, run_set as run_set
from .combinations import (
    combined_uses as combined_uses,
    read_combinations as read_combinations,
    water_at_rest as water_at_rest,
)
from .given_sections import given_sections as given_sections
from .interface_motion import (
    InterfaceMotion as InterfaceMotion,
    read_interface_motion as read_interface_motion,
)
from .level import OperatingLevel as OperatingLevel, operating_levels as operating_levels
from .members import scenario_uses as scenario_uses, water_notes as water_notes
from .motion.model import asset_model as asset_model
from .operating_modes import (
    LEFT_OUT as LEFT_OUT,
    modes_with_rotor as modes_with_rotor,
    operating_asset as operating_asset,
    operating_row as operating_row,
)
from .record import Simulation as Simulation, simulate as simulate
from .recovery import FORCES_LEFT_OUT as FORCES_LEFT_OUT, recovered as recovered
from .resultant import loads_document as loads_document
from .scenario.air import rotor_notes as rotor_notes
from .scenario.asset import Asset as Asset
from .scenario.files import (
    read_scenario as read_scenario,
    scenario_from as scenario_from,
    shipped_scenarios as shipped_scenarios,
)
from .scenario.scenario import Scenario as Scenario
from .scenario.sets import read_set as read_set, shipped_sets as shipped_sets
from .section_series import force_series as force_series, write_force_series as write_force_series
from .weld_life import (
    ScenarioLife as ScenarioLife,
    given_life as given_life,
    scenario_life as scenario_life,
)
