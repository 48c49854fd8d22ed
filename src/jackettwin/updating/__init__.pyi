from .build import support_model as support_model
from .data.targets import Residuals as Residuals, Target as Target
from .joint import joint as joint, single as single
from .model import SupportModel as SupportModel
from .posterior.sampling import Posterior as Posterior
from .problem import Problem as Problem
from .steel.band import numbered_modes as numbered_modes
from .update import Update as Update, law_probability as law_probability, update as update
