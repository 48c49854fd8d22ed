"""Predictions of the posterior for other modes, the undamped structure and the supports."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response import NumberedModes, numbered_poles
from jackettwin.soil import law_stiffness, static_rows
from jackettwin.updating.budget import damping_sources, of_the_asset
from jackettwin.updating.data.relaxations import RelaxationTarget
from jackettwin.updating.model import SupportModel

Missed = Callable[[NumberedModes], FloatArray]
_FIRST, _FOURTH = 1, 4
"""Modes at whose frequencies a support's stiffness and loss factor are stated."""


@dataclass(frozen=True)
class Predictive:
    """Draws of quantities of interest, NaN where a mode does not exist.

    Attributes
    ----------
    modes : mode numbers
    frequency_hz, damping_ratio, undamped_hz : (n_draws, n_modes)
    sources : (n_draws, n_modes, n_sources)
        Damping ratio of each source; they add up to ``damping_ratio``.
    support : {name: (n_draws,)}
        Quantities of each tie group: ``static_stiffness``, ``storage_stiffness`` and ``loss_factor`` at the
        first pinned frequency, ``stiffness_growth`` and ``loss_factor_growth`` to the fourth.
    rates : {name: (n_draws,)}
        Rates of measured relaxations [rad/s].
    """

    modes: tuple[int, ...]
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    undamped_hz: FloatArray
    sources: FloatArray
    support: Mapping[str, FloatArray]
    rates: Mapping[str, FloatArray]


def predict_quantities(
    model: SupportModel,
    theta: FloatArray,
    modes: tuple[int, ...],
    relaxations: tuple[RelaxationTarget, ...] = (),
    missed: Missed | None = None,
) -> Predictive:
    """Return the quantities at draws θ (n_draws, n_parameters) of the model's parameters.

    Parameters
    ----------
    missed : function of the modes at the draws, optional
        Returns the factors of the asset's frequencies and damping ratios on the model's, (3, n_draws,
        n_modes), as :meth:`jackettwin.updating.model_error.ErrorModel.factors` does.
    """
    damped = _from_first(model, theta, modes, undamped=False)
    undamped = _from_first(model, theta, modes, undamped=True)
    size = np.abs(damped.poles)
    factors = np.ones((3, *size.shape)) if missed is None else missed(damped)
    by_f, by_zeta, _ = factors
    return Predictive(
        modes,
        by_f * size / (2.0 * pi),
        by_zeta * -damped.poles.real / size,
        by_f * np.abs(undamped.poles) / (2.0 * pi),
        of_the_asset(damping_sources(model, model.points(theta).plain(), damped), factors),
        support_quantities(model, theta),
        {r.name: r.nearest(model, theta).rate for r in relaxations},
    )


def support_quantities(model: SupportModel, theta: FloatArray) -> dict[str, FloatArray]:
    """Return the quantities of the supports (see :class:`Predictive`)."""
    pinned = model.condensed.pinned.omega
    s = np.asarray(1j * pinned[[_FIRST - 1, min(_FOURTH, pinned.size) - 1]], dtype=np.complex128)
    rows = model.points(theta).plain().rows
    quantities = {}
    for g, suffix in enumerate(model.tie_groups.suffixes):
        D = law_stiffness(rows[:, g, None], s)
        loss = D.imag / D.real
        quantities[f"static_stiffness{suffix}"] = static_rows(rows[:, g])[:, 0]
        quantities[f"storage_stiffness{suffix}"] = D.real[:, 0]
        quantities[f"loss_factor{suffix}"] = loss[:, 0]
        quantities[f"stiffness_growth{suffix}"] = D.real[:, 1] / D.real[:, 0]
        quantities[f"loss_factor_growth{suffix}"] = loss[:, 1] / loss[:, 0]
    return quantities


def _from_first(
    model: SupportModel, theta: FloatArray, modes: tuple[int, ...], *, undamped: bool
) -> NumberedModes:
    """Return the modes of all draws, each search started from the first draw's modes."""
    points = model.points(theta).plain()
    start = model.points(theta[:1]).plain()
    if undamped:
        points, start = points.undamped(), start.undamped()
    near = numbered_poles(model.condensed, start, modes)
    return numbered_poles(model.condensed, points, modes, near=None if np.isnan(near.poles).any() else near)
