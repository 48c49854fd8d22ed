from .causes import (
    Cause as Cause,
    general_causes as general_causes,
    sensor_noise as sensor_noise,
    sizes_about as sizes_about,
)
from .change import Change as Change
from .condition_effects import unexplained_std as unexplained_std, unseen_share as unseen_share
from .design import (
    Design as Design,
    Lagged as Lagged,
    Slope as Slope,
    design_of as design_of,
    fresh as fresh,
    regressors as regressors,
    with_time_of_year as with_time_of_year,
)
from .detectable import CHANCE as CHANCE, Sight as Sight, sight as sight
from .diagnosis import (
    CLEAR as CLEAR,
    UNEXPLAINED as UNEXPLAINED,
    CauseVerdict as CauseVerdict,
    Diagnosis as Diagnosis,
    diagnose as diagnose,
    expected_information as expected_information,
)
from .directions import Pattern as Pattern
from .history import History as History, typical as typical
from .level import (
    Hypotheses as Hypotheses,
    Jump as Jump,
    Mixture as Mixture,
    Readings as Readings,
    after_row as after_row,
    forecast as forecast,
    halved as halved,
    no_rows as no_rows,
    rooted as rooted,
    smoothed as smoothed,
)
from .state import Watch as Watch
from .watch import (
    Look as Look,
    PendingChange as PendingChange,
    continues as continues,
    look_again as look_again,
    start as start,
    step as step,
)
