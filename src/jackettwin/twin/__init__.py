"""The living model: the main job, from a twin file to a result."""

from jackettwin.twin.config import TwinConfig
from jackettwin.twin.document import observation_document, run_document, update_document
from jackettwin.twin.files import read_twin, shipped_twins
from jackettwin.twin.observe import Observation, observe
from jackettwin.twin.result import DampingExcess, TwinResult
from jackettwin.twin.run import count_steps, run_twin

__all__ = [
    "DampingExcess",
    "TwinConfig",
    "TwinResult",
    "count_steps",
    "Observation",
    "observation_document",
    "observe",
    "read_twin",
    "run_document",
    "run_twin",
    "shipped_twins",
    "update_document",
]
