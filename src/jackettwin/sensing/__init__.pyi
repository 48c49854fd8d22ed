from .estimate import (
    SECTION_REMAINDER as SECTION_REMAINDER,
    MotionEstimate as MotionEstimate,
    estimate_motion as estimate_motion,
    likely_motions as likely_motions,
    motion_from as motion_from,
    section_rows as section_rows,
    sensed_model as sensed_model,
    spread_of as spread_of,
    stress_remainder as stress_remainder,
)
from .latent_forces import LatentForce as LatentForce
from .motion_model import MotionModel as MotionModel, motion_model as motion_model
from .readings import SensorReadings as SensorReadings, Weather as Weather, readings_of as readings_of
from .rotor_by_wind import RotorAtTop as RotorAtTop, RotorByWind as RotorByWind
from .smoother import (
    SteadySmoother as SteadySmoother,
    discrete as discrete,
    steady_smoother as steady_smoother,
)
