"""Modes to parameters, with uncertainty."""

from jackettwin.updating.band import numbered_modes
from jackettwin.updating.build import support_model
from jackettwin.updating.families import DEFAULT_LAWS, Parameter, family
from jackettwin.updating.joint import joint, single
from jackettwin.updating.model import SupportModel
from jackettwin.updating.problem import Problem
from jackettwin.updating.targets import Residuals, Target
from jackettwin.updating.update import Update, law_probability, update

__all__ = [
    "DEFAULT_LAWS",
    "Parameter",
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
