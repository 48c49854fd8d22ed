"""What the structure does: modes, poles, motion in time."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.response.modal import DampedModes, UndampedModes, damped_modes, undamped_modes
    from jackettwin.response.sensors import Sensor, observation_matrix
    from jackettwin.response.system import System, build_system

__all__ = [
    "DampedModes",
    "Sensor",
    "System",
    "UndampedModes",
    "build_system",
    "damped_modes",
    "observation_matrix",
    "undamped_modes",
]

door(
    __name__,
    {
        "modal": "DampedModes UndampedModes damped_modes undamped_modes",
        "sensors": "Sensor observation_matrix",
        "system": "System build_system",
    },
)
