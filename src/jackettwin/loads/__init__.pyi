from .aerodynamics.bem import Control as Control
from .aerodynamics.rotor import (
    Rotor as Rotor,
    elements as elements,
    linearise as linearise,
    rotation as rotation,
)
from .aerodynamics.rotor_wind import PIECE_M as PIECE_M
from .aerodynamics.turbine_files import read_rotor as read_rotor
from .aerodynamics.turbulence import Coherent as Coherent
from .aerodynamics.wind import TOWER_DRAG as TOWER_DRAG, Wind as Wind
from .members.coefficients import Coefficients as Coefficients
from .members.ends import EndCoefficients as EndCoefficients
from .members.morison import morison_points as morison_points
from .members.water import Water as Water
from .members.water_files import (
    WaterSchema as WaterSchema,
    depth_of as depth_of,
    water_members as water_members,
)
from .sea.conditions import SeaState as SeaState
from .sea.current import Current as Current
from .sea.given_kinematics import Kinematics as Kinematics, read_kinematics as read_kinematics
from .sea.given_waves import Elevation as Elevation, read_elevation as read_elevation
from .sea.regular_waves import highest_wave as highest_wave
from .sea.waves import airy_wave as airy_wave, peak_factor as peak_factor, wave_number as wave_number
