"""Corrosion environment of a weld by its elevation, which selects its S-N curve."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from jackettwin.fatigue.curves import ENVIRONMENTS, Environment, read_curve
from jackettwin.fatigue.life import LifeModel
from jackettwin.fatigue.weld_life import ModelsAtHeight

SPLASH_M = (-5.0, 5.0)
"""About the sea level: no cathodic protection reaches there for all of the time."""


def models_at_height(
    curve: str = "T", *, design_factor: float = 1.0, edition: str | None = None
) -> ModelsAtHeight:
    """Return what corrodes a weld at an elevation above the sea [m], and its curve there.

    In the air above the splash zone, free to corrode in it, under cathodic protection below.

    Raises
    ------
    InputError
        If there is no such curve or edition.
    """
    source = () if edition is None else (edition,)
    models = {name: LifeModel(read_curve(curve, name, *source), design_factor) for name in ENVIRONMENTS}
    return partial(_model_there, models)


def _model_there(models: Mapping[Environment, LifeModel], z_m: float) -> tuple[Environment, LifeModel]:
    low, high = SPLASH_M
    name: Environment = "air" if z_m > high else "cathodic" if z_m < low else "free-corrosion"
    return name, models[name]
