"""What the report evaluates around a solution: sensitivities, cost surface, root locus, undamped shapes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.report.figures_landscape import Curve, Locus
from jackettwin.response.follow import follow
from jackettwin.response.modal import undamped_modes
from jackettwin.updating import Residuals, SupportModel, Update, numbered_modes
from jackettwin.updating.landscape import cost_surface, sensitivity_curve

FloatArray = npt.NDArray[np.float64]

_LOSSY = 1
"""Position of the parameter that damps in every family: c, loss_factor, alpha."""


def sensitivities(model: SupportModel, residuals: Residuals, theta: FloatArray) -> list[Curve]:
    """Return the cost as each parameter moves by ±50 % (thesis figures 8.5 and 8.6)."""
    curves = []
    for j, p in enumerate(model.parameters):
        factor, cost = sensitivity_curve(model, residuals, theta, j)
        curves.append(Curve(model.family.name, p.name, float(theta[j]), p.unit, factor, cost))
    return curves


def surface(update: Update, *, n: int = 36) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (x, y, cost) over the bounds of a law with two parameters."""
    first, second = update.model.parameters
    x, y = np.geomspace(first.low, first.high, n), np.geomspace(second.low, second.high, n)
    return x, y, cost_surface(update.model, update.residuals, update.best.theta, (0, 1), x, y)


def locus(
    model: SupportModel, theta: FloatArray, modes: tuple[int, ...], labels: tuple[str, ...], *, n: int = 81
) -> Locus:
    """Return how the poles move as the damping parameter of every support goes from bound to bound.

    Where the poles at a bound are the limits c → 0 and c → ∞ of a dashpot.
    """
    width = len(model.family.parameters)
    p = model.parameters[_LOSSY]
    values = np.geomspace(p.low, p.high, n)
    poles = []
    for value in values:
        moved = np.reshape(theta, (-1, width)).copy()
        moved[:, _LOSSY] = value
        poles.append(model.predict(moved.ravel(), modes).poles)
    here = model.predict(theta, modes).poles
    name = model.family.parameters[_LOSSY].name
    return Locus(model.family.name, name, p.unit, labels, values, np.array(poles), here)


def undamped_shapes(update: Update) -> FloatArray:
    """Return the undamped shapes (assembly.n_dof, n_modes) of the updated full model; NaN if not followed."""
    model, modes = update.model, update.residuals.modes
    reference = numbered_modes(model.assembly, max(modes) + 2)
    undamped = undamped_modes(model.system(update.best.theta), max(modes) + 12)
    found = follow(model.assembly.mass, reference.omega, reference.shapes, undamped.shapes)[
        [m - 1 for m in modes]
    ]
    return np.asarray(np.where(found >= 0, undamped.shapes[:, found], np.nan))
