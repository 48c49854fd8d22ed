"""Watching: has a structure changed, since when, by how much and why; of any structure, on arrays."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.watching.causes import Cause, general_causes, lognormal_sizes, sensor_noise
    from jackettwin.watching.diagnosis import Diagnosis, Verdict, diagnose
    from jackettwin.watching.history import History
    from jackettwin.watching.next_look import expected_information
    from jackettwin.watching.watch import Change, Look, Watch, start, step

__all__ = [
    "Cause",
    "Change",
    "Diagnosis",
    "History",
    "Look",
    "Verdict",
    "Watch",
    "diagnose",
    "expected_information",
    "general_causes",
    "lognormal_sizes",
    "sensor_noise",
    "start",
    "step",
]

door(
    __name__,
    {
        "causes": "Cause general_causes lognormal_sizes sensor_noise",
        "diagnosis": "Diagnosis Verdict diagnose",
        "history": "History",
        "next_look": "expected_information",
        "watch": "Change Look Watch start step",
    },
)
