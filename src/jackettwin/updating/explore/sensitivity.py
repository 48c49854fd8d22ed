"""Sensitivity of frequencies and damping ratios to every parameter."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response import damping_ratio
from jackettwin.soil import Parameter
from jackettwin.updating.data.targets import polar
from jackettwin.updating.model import SupportModel

_STEP = 1e-4
"""Step of ln θ: the error of a central difference is 2e-9 times the third derivative, plus 1e-11 of
rounding."""


@dataclass(frozen=True)
class ModeSensitivity:
    """Derivatives at a point; NaN where a mode does not oscillate.

    Attributes
    ----------
    parameters : parameters of the model
    modes : mode numbers
    frequency_hz, damping_ratio : (n_modes,)
    frequency : (n_modes, n_parameters) ∂ ln f/∂ ln θ: per cent of frequency per per cent of the parameter
    damping : (n_modes, n_parameters) ∂ζ/∂ ln θ: a hundred times the change of ζ per per cent of the parameter
    difference : float
        Largest deviation from central differences.
    """

    parameters: tuple[Parameter, ...]
    modes: tuple[int, ...]
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    frequency: FloatArray
    damping: FloatArray
    difference: float


def sensitivity(model: SupportModel, theta: FloatArray, modes: tuple[int, ...]) -> ModeSensitivity:
    """Return the analytical derivatives of some modes at a point, checked by central differences.

    Parameters
    ----------
    theta : (n_parameters,)
    modes : mode numbers, on pinned supports
    """
    model = model.reaching(max(modes))
    found = model.predict_many(theta[None], modes)
    size, zeta, radial, angular = polar(found.poles[0], found.slopes[0])
    frequency, damping = radial / size[:, None], angular
    steps = _STEP * np.concatenate([np.eye(theta.size), -np.eye(theta.size)])
    near = model.predict_many(theta * np.exp(steps), modes, near=found, slopes=False)
    ln_f = np.log(np.abs(near.poles))
    ratio = damping_ratio(near.poles)
    by_f, by_zeta = ((a[: theta.size] - a[theta.size :]).T / (2.0 * _STEP) for a in (ln_f, ratio))
    apart = np.concatenate([np.abs(by_f - frequency), np.abs(by_zeta - damping)])
    known = apart[np.isfinite(apart)]
    return ModeSensitivity(
        model.parameters,
        modes,
        size / (2.0 * pi),
        zeta,
        frequency,
        damping,
        float(known.max()) if known.size else float("nan"),
    )
