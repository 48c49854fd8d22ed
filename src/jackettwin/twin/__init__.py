"""The living model: the main job, from a twin file to a result."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.twin.advance import advance, advance_all
    from jackettwin.twin.config import TwinConfig
    from jackettwin.twin.document import observation_document, run_document, update_document
    from jackettwin.twin.examine import Examination, examine, examine_file
    from jackettwin.twin.files import read_twin, shipped_twins
    from jackettwin.twin.judge import JUDGED, Judged, judge
    from jackettwin.twin.model import TwinModel, twin_model
    from jackettwin.twin.observation import OBSERVATION, Observation
    from jackettwin.twin.observe import observe
    from jackettwin.twin.result import DampingExcess, TwinResult
    from jackettwin.twin.run import count_steps, run_twin
    from jackettwin.twin.state import STATE, TwinState, empty_state

__all__ = [
    "DampingExcess",
    "JUDGED",
    "Judged",
    "Examination",
    "OBSERVATION",
    "Observation",
    "STATE",
    "TwinConfig",
    "TwinModel",
    "TwinResult",
    "TwinState",
    "advance",
    "advance_all",
    "count_steps",
    "empty_state",
    "examine",
    "examine_file",
    "judge",
    "observation_document",
    "observe",
    "read_twin",
    "run_document",
    "run_twin",
    "shipped_twins",
    "twin_model",
    "update_document",
]

door(
    __name__,
    {
        "advance": "advance advance_all",
        "config": "TwinConfig",
        "document": "observation_document run_document update_document",
        "examine": "Examination examine examine_file",
        "files": "read_twin shipped_twins",
        "judge": "JUDGED Judged judge",
        "model": "TwinModel twin_model",
        "observation": "OBSERVATION Observation",
        "observe": "observe",
        "result": "DampingExcess TwinResult",
        "run": "count_steps run_twin",
        "state": "STATE TwinState empty_state",
    },
)
