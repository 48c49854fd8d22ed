"""Records of a known asset under wind and waves."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.simulate.files import read_scenario, shipped_scenarios
    from jackettwin.simulate.record import Simulation, simulate
    from jackettwin.simulate.resultant import loads_document
    from jackettwin.simulate.scenario import Scenario

__all__ = ["Scenario", "Simulation", "loads_document", "read_scenario", "shipped_scenarios", "simulate"]

door(
    __name__,
    {
        "files": "read_scenario shipped_scenarios",
        "record": "Simulation simulate",
        "resultant": "loads_document",
        "scenario": "Scenario",
    },
)
