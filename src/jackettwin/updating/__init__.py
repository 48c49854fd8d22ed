"""Modes to parameters, with uncertainty."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.updating.band import numbered_modes
    from jackettwin.updating.build import support_model
    from jackettwin.updating.families import DEFAULT_LAWS, Parameter, family
    from jackettwin.updating.joint import joint, single
    from jackettwin.updating.model import SupportModel
    from jackettwin.updating.posterior import Posterior
    from jackettwin.updating.problem import Problem
    from jackettwin.updating.targets import Residuals, Target
    from jackettwin.updating.update import Update, law_probability, update

__all__ = [
    "DEFAULT_LAWS",
    "Parameter",
    "Posterior",
    "Problem",
    "Residuals",
    "SupportModel",
    "Target",
    "Update",
    "family",
    "joint",
    "law_probability",
    "numbered_modes",
    "single",
    "support_model",
    "update",
]

door(
    __name__,
    {
        "band": "numbered_modes",
        "build": "support_model",
        "families": "DEFAULT_LAWS Parameter family",
        "joint": "joint single",
        "model": "SupportModel",
        "posterior": "Posterior",
        "problem": "Problem",
        "targets": "Residuals Target",
        "update": "Update law_probability update",
    },
)
