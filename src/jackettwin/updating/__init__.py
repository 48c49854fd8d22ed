"""Modes to parameters, with uncertainty."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.soil.families import DEFAULT_LAWS as DEFAULT_LAWS, family as family
    from jackettwin.soil.parameter import Parameter as Parameter
    from jackettwin.updating.band import numbered_modes as numbered_modes
    from jackettwin.updating.build import support_model as support_model
    from jackettwin.updating.joint import joint as joint, single as single
    from jackettwin.updating.model import SupportModel as SupportModel
    from jackettwin.updating.posterior import Posterior as Posterior
    from jackettwin.updating.problem import Problem as Problem
    from jackettwin.updating.targets import Residuals as Residuals, Target as Target
    from jackettwin.updating.update import (
        Update as Update,
        law_probability as law_probability,
        update as update,
    )

door(__name__)
