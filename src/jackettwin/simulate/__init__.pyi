from .record import Simulation as Simulation, simulate as simulate
from .resultant import loads_document as loads_document
from .scenario.files import read_scenario as read_scenario, shipped_scenarios as shipped_scenarios
from .scenario.scenario import Scenario as Scenario
from .scenario.sets import shipped_sets as shipped_sets
