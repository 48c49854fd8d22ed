"""Modes to parameters, with uncertainty."""

from jackettwin.updating.families import DEFAULT_LAWS, Parameter, family
from jackettwin.updating.model import SupportModel, numbered_modes, support_model
from jackettwin.updating.targets import Residuals, Target
from jackettwin.updating.update import Update, update

__all__ = [
    "DEFAULT_LAWS",
    "Parameter",
    "Residuals",
    "SupportModel",
    "Target",
    "Update",
    "family",
    "numbered_modes",
    "support_model",
    "update",
]
