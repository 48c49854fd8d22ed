"""Watching: has a structure changed, since when, by how much and why; of any structure, on arrays."""

from jackettwin.watching.causes import Cause, general_causes, lognormal_sizes, sensor_noise
from jackettwin.watching.diagnosis import Diagnosis, Verdict, diagnose
from jackettwin.watching.history import History
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
    "general_causes",
    "lognormal_sizes",
    "sensor_noise",
    "start",
    "step",
]
