r"""Mode shapes as data: one minus the MAC at the sensors, over its standard deviation.

.. math:: r = \frac{1}{σ}\left(1 - \frac{|m^H y|^2}{(m^H m)(y^H y)}\right), \quad y = T x

with the measured shape m, the model's coordinates x and T their motion at the sensors. The record was rotated
to rotor axes before, so that yaw does not affect m.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response import Sensor, observation_matrix
from jackettwin.updating.model import SupportModel


@dataclass(frozen=True)
class ShapeTarget:
    """A measured mode shape.

    Attributes
    ----------
    mode : int
    at_sensors : (n_channels, n) motion of the sensors for each coordinate of the condensed model, at the
        measured frequency
    shape : (n_channels,) measured shape
    std : float
        Standard deviation of 1 − MAC, due to noise at the sensors and errors of the model's shapes.
    """

    mode: int
    at_sensors: ComplexArray
    shape: ComplexArray
    std: float

    @classmethod
    def seen(
        cls,
        model: SupportModel,
        mode: int,
        frequency_hz: float,
        sensors: tuple[Sensor, ...],
        shape: ComplexArray,
        std: float,
    ) -> ShapeTarget:
        """Return the target of a shape measured by sensors on the model's structure."""
        expansion = model.condensed.expansion(2j * pi * frequency_hz)
        return cls(mode, np.asarray(observation_matrix(model.assembly, sensors) @ expansion), shape, std)

    @property
    def log_normalisation(self) -> float:
        """−log of the normal density at zero."""
        return log(sqrt(2.0 * pi) * self.std)

    def values(self, x: ComplexArray) -> FloatArray:
        """Return the residuals (n_sets,) of shapes x (n_sets, n)."""
        return self._parts(x)[0]

    def jacobian(self, x: ComplexArray, slopes: ComplexArray) -> FloatArray:
        """Return the derivatives (n_z,) of the residual of one shape x (n,) from dx/dz (n_z, n)."""
        value, y, overlap, size = self._parts(x[None])
        dy = slopes @ self.at_sensors.T
        d_overlap = 2.0 * (np.conj(overlap[0]) * (dy @ self.shape.conj())).real
        d_size = 2.0 * (dy @ y[0].conj()).real
        mac = 1.0 - self.std * value[0]
        norm = float(np.vdot(self.shape, self.shape).real) * size[0]
        return np.asarray(-(d_overlap / norm - mac * d_size / size[0]) / self.std)

    def _parts(self, x: ComplexArray) -> tuple[FloatArray, ComplexArray, ComplexArray, FloatArray]:
        y = np.asarray(x @ self.at_sensors.T)
        overlap = y @ self.shape.conj()
        size = np.einsum("ki,ki->k", y.conj(), y).real
        mac = np.abs(overlap) ** 2 / (size * np.vdot(self.shape, self.shape).real)
        return (1.0 - mac) / self.std, y, overlap, size
