r"""Real poles as data: the rate of a measured relaxation and the nearest one of the model.

.. math:: r = \frac{\ln(a_\mathrm{model}/a)}{σ}

or, without a standard deviation, relative to the measured rate as in thesis (8.4). The relaxation is paired
with the model's pole of smallest |Δ ln a|, plus 1 − MAC if its shape was measured, as in identification.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.response import Relaxation, Sensor, nearest_relaxation, observation_matrix
from jackettwin.updating.model import SupportModel


@dataclass(frozen=True)
class RelaxationTarget:
    """A measured relaxation exp(−at).

    Attributes
    ----------
    name : str
        ``a1``, ``a2``, … by rate.
    rate : float
        a [rad/s].
    log_std : float or None
        Standard deviation of ln a; None makes the residual relative.
    at_sensors : (n_channels, n) motion of the sensors for each coordinate of the condensed model, or None
    shape : (n_channels,) measured shape, or None
    """

    name: str
    rate: float
    log_std: float | None = None
    at_sensors: FloatArray | None = None
    shape: ComplexArray | None = None

    def __post_init__(self) -> None:
        if not self.rate > 0.0 or not (self.log_std is None or self.log_std > 0.0):
            raise InputError(
                "rate and standard deviation of a relaxation must be positive",
                field="targets.rate_rad_s",
                value=[self.rate, self.log_std],
            )

    def seen(self, model: SupportModel, sensors: tuple[Sensor, ...], shape: ComplexArray) -> RelaxationTarget:
        """Return the target with the shape that sensors of a model's structure measured."""
        moved = observation_matrix(model.assembly, sensors) @ model.condensed.expansion(-self.rate)
        return RelaxationTarget(self.name, self.rate, self.log_std, np.asarray(moved.real), shape)

    @property
    def log_normalisation(self) -> float:
        """−log of the normal density at zero, in ln a; zero without a standard deviation."""
        return 0.0 if self.log_std is None else log(sqrt(2.0 * pi) * self.log_std)

    def nearest(self, model: SupportModel, theta: FloatArray, *, slopes: bool = False) -> Relaxation:
        """Return the model's relaxation that is paired with this one, at parameter vectors (n_sets, n)."""
        points = model.points(theta)
        points = points if slopes else points.plain()
        return nearest_relaxation(
            model.condensed, points, self.rate, at_sensors=self.at_sensors, shape=self.shape
        )

    def values(self, rate: FloatArray) -> FloatArray:
        """Return the residuals (n_sets,) of the model's rates (n_sets,)."""
        ratio = rate / self.rate
        return np.asarray(ratio - 1.0 if self.log_std is None else np.log(ratio) / self.log_std)

    def jacobian(self, found: Relaxation) -> FloatArray:
        """Return the derivatives (n_z,) of the residual at the first parameter vector."""
        scale = self.rate if self.log_std is None else self.log_std * found.rate[0]
        return np.asarray(found.slopes[0] / scale)
