from .causes import (
    Cause as Cause,
    general_causes as general_causes,
    sensor_noise as sensor_noise,
    sizes_about as sizes_about,
)
from .change import Change as Change
from .design import Slope as Slope
from .diagnosis import (
    CauseVerdict as CauseVerdict,
    Diagnosis as Diagnosis,
    diagnose as diagnose,
    expected_information as expected_information,
)
from .directions import Pattern as Pattern
from .history import History as History, typical as typical
from .state import Watch as Watch
from .variance_shares import unexplained_std as unexplained_std
from .watch import Look as Look, start as start, step as step
