"""What the structure does: modes, poles, motion in time."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.response.modal import (
        DampedModes as DampedModes,
        UndampedModes as UndampedModes,
        damped_modes as damped_modes,
        undamped_modes as undamped_modes,
    )
    from jackettwin.response.sensors import Sensor as Sensor, observation_matrix as observation_matrix
    from jackettwin.response.system import System as System, build_system as build_system
    from jackettwin.response.time import free_decay as free_decay

door(__name__)
