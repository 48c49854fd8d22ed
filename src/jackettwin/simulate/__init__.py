"""Records of a known asset under wind and waves."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.simulate.files import (
        read_scenario as read_scenario,
        shipped_scenarios as shipped_scenarios,
    )
    from jackettwin.simulate.record import Simulation as Simulation, simulate as simulate
    from jackettwin.simulate.resultant import loads_document as loads_document
    from jackettwin.simulate.scenario import Scenario as Scenario
    from jackettwin.simulate.sets import shipped_sets as shipped_sets

door(__name__)
