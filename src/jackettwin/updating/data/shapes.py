r"""Mode shapes as data: the MAC at the sensors, and how far they move low on the tower.

Of the MAC one less it over its standard deviation is the residual:

.. math:: r = \frac{1}{σ}\left(1 - \frac{|m^H y|^2}{(m^H m)(y^H y)}\right), \quad y = T x

with the measured shape m, the model's coordinates x and T their motion at the sensors. The record was rotated
to rotor axes before, so that yaw does not affect m. One minus the MAC is of second order in what shapes
differ by, and the two modes of a pair lie in their plane in any directions. How far the place that moves
least moves with the one that moves most is of first order and, of a structure alike in all directions, of
none:

.. math:: r = \frac{p(y) - p(m)}{σ}, \qquad p(y) = \frac{\mathrm{Re}\, y_{most}^H y_{least}}{|y_{most}|^2}

It tells how much of a first mode is motion of the feet, which its frequency hardly does.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt
from typing import Self

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import require
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
    frequency_hz : at which it was measured
    sensors : (n_channels,) by which
    """

    mode: int
    at_sensors: ComplexArray
    shape: ComplexArray
    std: float
    frequency_hz: float
    sensors: tuple[Sensor, ...]

    @classmethod
    def seen(
        cls,
        model: SupportModel,
        mode: int,
        frequency_hz: float,
        sensors: tuple[Sensor, ...],
        shape: ComplexArray,
        std: float,
    ) -> Self:
        """Return the target of a shape measured by sensors on the model's structure.

        Raises
        ------
        InputError
            If a profile is asked for and no two places have sensors that measure the same.
        """
        sensors, shape = cls._compared(sensors, shape)
        expansion = model.condensed.expansion(2j * pi * frequency_hz)
        at_sensors = np.asarray(observation_matrix(model.assembly, sensors) @ expansion)
        return cls(mode, at_sensors, shape, std, frequency_hz, sensors)

    @staticmethod
    def _compared(
        sensors: tuple[Sensor, ...], shape: ComplexArray
    ) -> tuple[tuple[Sensor, ...], ComplexArray]:
        """Return the sensors of which the datum is made, and what they measured."""
        return sensors, shape

    def on(self, model: SupportModel) -> Self:
        """Return the target on the coordinates of another model."""
        return self.seen(model, self.mode, self.frequency_hz, self.sensors, self.shape, self.std)

    @property
    def name(self) -> str:
        """What the datum is called."""
        return f"MAC{self.mode}"

    @property
    def log_normalisation(self) -> float:
        """−log of the normal density at zero."""
        return log(sqrt(2.0 * pi) * self.std)

    def nearest(self, planes: ComplexArray) -> ComplexArray:
        """Return weights (n_sets, 2) on two shapes (n_sets, 2, n), together most like the measured one."""
        motion = np.swapaxes(planes @ self.at_sensors.T, 1, 2)
        return np.asarray(np.linalg.pinv(motion) @ self.shape)

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


@dataclass(frozen=True)
class ProfileTarget(ShapeTarget):
    """How far the place that moves least in a measured shape moves with the one that moves most.

    Attributes
    ----------
    at_sensors, shape : of the channels (2k,) of the place that moves most, then of those (k,) of the other
        that measure the same
    std : float
        Standard deviation of that share.
    """

    @staticmethod
    def _compared(
        sensors: tuple[Sensor, ...], shape: ComplexArray
    ) -> tuple[tuple[Sensor, ...], ComplexArray]:
        """Return the sensors of the two places, and what they measured."""
        pairs = _most_and_least(sensors, shape)
        return tuple(sensors[i] for i in pairs), np.asarray(shape)[pairs]

    @property
    def name(self) -> str:
        """What the datum is called."""
        return f"profile{self.mode}"

    def values(self, x: ComplexArray) -> FloatArray:
        """Return the residuals (n_sets,) of shapes x (n_sets, n)."""
        return np.asarray((_share(x @ self.at_sensors.T) - _share(self.shape[None])) / self.std)

    def jacobian(self, x: ComplexArray, slopes: ComplexArray) -> FloatArray:
        """Return the derivatives (n_z,) of the residual of one shape x (n,) from dx/dz (n_z, n)."""
        most, least = np.split(x @ self.at_sensors.T, 2)
        d_most, d_least = np.split(slopes @ self.at_sensors.T, 2, axis=1)
        size = float(np.vdot(most, most).real)
        share = float(np.vdot(most, least).real) / size
        change = (d_most.conj() @ least + d_least @ most.conj()).real
        return np.asarray((change - 2.0 * share * (d_most @ most.conj()).real) / (size * self.std))


def _share(y: ComplexArray) -> FloatArray:
    """Return p (n_sets,) of motions (n_sets, 2k) of two places."""
    most, least = np.split(y, 2, axis=1)
    return np.asarray((most.conj() * least).sum(axis=1).real / (np.abs(most) ** 2).sum(axis=1))


def _most_and_least(sensors: tuple[Sensor, ...], shape: ComplexArray) -> list[int]:
    """Return the channels of the place that moves most, then those of the one that moves least."""
    places: dict[tuple[object, ...], dict[tuple[object, ...], int]] = {}
    for i, s in enumerate(sensors):
        at = places.setdefault((s.node, s.height_m, s.member, s.position), {})
        at[s.quantity, *s.direction] = i
    size = {place: float(np.linalg.norm(shape[[*at.values()]])) for place, at in places.items()}
    most, least = (places[pick(size, key=size.__getitem__)] for pick in (max, min))
    alike = [way for way in most if way in least] if most is not least else []
    require(
        alike,
        "a profile needs sensors that measure the same at two places",
        field="update.profile_std",
        value=[s.channel for s in sensors],
        remedy="place sensors of the same direction at two heights, or omit profile_std",
    )
    return [*(most[way] for way in alike), *(least[way] for way in alike)]
