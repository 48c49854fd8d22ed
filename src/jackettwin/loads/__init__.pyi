from .aerodynamics.rotor import (
    AIR_KG_M3 as AIR_KG_M3,
    CompiledRotor as CompiledRotor,
    Linearised as Linearised,
    Rotor as Rotor,
    compiled_rotor as compiled_rotor,
    elements as elements,
    in_global_axes as in_global_axes,
    linearise as linearise,
    rotation as rotation,
)
from .aerodynamics.rotor_wind import PIECE_M as PIECE_M, RotorWind as RotorWind, rotor_wind as rotor_wind
from .aerodynamics.turbine_files import read_rotor as read_rotor
from .aerodynamics.turbulence import Coherent as Coherent
from .aerodynamics.wind import (
    TOWER_DRAG as TOWER_DRAG,
    Wind as Wind,
    tower_drag as tower_drag,
    tower_drag_damping as tower_drag_damping,
)
from .members.coefficients import Coefficients as Coefficients, GrowthBand as GrowthBand
from .members.drag_damping import sea_drag_damping as sea_drag_damping, velocity_std as velocity_std
from .members.ends import EndCoefficients as EndCoefficients, Ends as Ends, member_ends as member_ends
from .members.morison import (
    MorisonPoints as MorisonPoints,
    drag_damping as drag_damping,
    loads_along as loads_along,
    morison_points as morison_points,
    nodal_loads as nodal_loads,
    point_forces as point_forces,
    wetness as wetness,
)
from .members.radiation_damping import radiation_damping as radiation_damping
from .members.slam import (
    breaking_impact as breaking_impact,
    slam_coefficient as slam_coefficient,
    slam_per_length as slam_per_length,
)
from .members.water import (
    StillWater as StillWater,
    Water as Water,
    mass_per_level as mass_per_level,
    outside_pressure as outside_pressure,
    still_water as still_water,
    water_mass as water_mass,
    water_weights as water_weights,
)
from .members.water_files import (
    WaterSchema as WaterSchema,
    depth_of as depth_of,
    water_members as water_members,
)
from .operation.bem import (
    Control as Control,
    OperatingPoint as OperatingPoint,
    operating_point as operating_point,
    steady_operation as steady_operation,
)
from .operation.blade_bending import bending_blades as bending_blades
from .operation.damping import (
    OPERATING_LEAST_RATIO as OPERATING_LEAST_RATIO,
    OPERATING_LOG_STD as OPERATING_LOG_STD,
    operating_damping as operating_damping,
)
from .operation.excitation import (
    TowerOutline as TowerOutline,
    Turbulent as Turbulent,
    passing_loads as passing_loads,
    turbulent_loads as turbulent_loads,
)
from .operation.schedule import read_schedule as read_schedule
from .sea.current import Current as Current
from .sea.given_kinematics import (
    Kinematics as Kinematics,
    TravellingKinematics as TravellingKinematics,
    read_kinematics as read_kinematics,
)
from .sea.given_waves import (
    Elevation as Elevation,
    given_sea as given_sea,
    read_elevation as read_elevation,
    require_cover as require_cover,
)
from .sea.regular_waves import highest_wave as highest_wave, regular_wave as regular_wave
from .sea.sea_series import surface_series as surface_series
from .sea.wave_series import (
    WaveSeries as WaveSeries,
    resultant_columns as resultant_columns,
    wave_series as wave_series,
)
from .sea.waves import (
    AirySea as AirySea,
    SeaState as SeaState,
    Waves as Waves,
    airy_wave as airy_wave,
    depth_functions as depth_functions,
    irregular_sea as irregular_sea,
    jonswap as jonswap,
    peak_factor as peak_factor,
    wave_number as wave_number,
)
