"""What the environment does."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.loads.conditions import Conditions, SeaState
    from jackettwin.loads.files import read_rotor
    from jackettwin.loads.morison import morison_points, wave_loads
    from jackettwin.loads.rotor import linearise
    from jackettwin.loads.waves import airy_wave
    from jackettwin.loads.wind import Wind

__all__ = [
    "Conditions",
    "SeaState",
    "Wind",
    "airy_wave",
    "linearise",
    "morison_points",
    "read_rotor",
    "wave_loads",
]

door(
    __name__,
    {
        "conditions": "Conditions SeaState",
        "files": "read_rotor",
        "morison": "morison_points wave_loads",
        "rotor": "linearise",
        "waves": "airy_wave",
        "wind": "Wind",
    },
)
