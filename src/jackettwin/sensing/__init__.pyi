from .estimate import (
    BAND_HZ as BAND_HZ,
    MotionEstimate as MotionEstimate,
    estimate_motion as estimate_motion,
    moved as moved,
    section_rows as section_rows,
    sensed_model as sensed_model,
    spread_of as spread_of,
    under as under,
)
from .latent_forces import LatentForce as LatentForce
from .levels import Levels as Levels
from .motion_model import MotionModel as MotionModel, motion_model as motion_model
from .readings import SensorReadings as SensorReadings, Weather as Weather, readings_of as readings_of
from .smoother import (
    SteadySmoother as SteadySmoother,
    discrete as discrete,
    steady_smoother as steady_smoother,
)
