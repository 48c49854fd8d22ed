from .aerodynamics.rotor import linearise as linearise
from .aerodynamics.turbine_files import read_rotor as read_rotor
from .aerodynamics.wind import Wind as Wind
from .members.morison import morison_points as morison_points
from .sea.conditions import SeaState as SeaState
from .sea.waves import airy_wave as airy_wave
