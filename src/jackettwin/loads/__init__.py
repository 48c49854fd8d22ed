"""What the environment does."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.loads.conditions import SeaState as SeaState
    from jackettwin.loads.files import read_rotor as read_rotor
    from jackettwin.loads.morison import morison_points as morison_points
    from jackettwin.loads.rotor import linearise as linearise
    from jackettwin.loads.waves import airy_wave as airy_wave
    from jackettwin.loads.wind import Wind as Wind

door(__name__)
