from .modes.modal import (
    DampedModes as DampedModes,
    UndampedModes as UndampedModes,
    damped_modes as damped_modes,
    undamped_modes as undamped_modes,
)
from .motion.time import free_decay as free_decay
from .sensors import Sensor as Sensor, observation_matrix as observation_matrix, sensor_kinds as sensor_kinds
from .system import System as System, build_system as build_system
