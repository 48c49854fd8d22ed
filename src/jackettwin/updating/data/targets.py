"""Targets of the update: frequencies and damping ratios of numbered modes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, log, pi

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError, require
from jackettwin.response import damping_ratio

_LEAST = 1e-9
"""Damping ratios below this, or negative, are set to it, so that the logarithm exists."""


@dataclass(frozen=True)
class Target:
    """A measured or given mode; ``mode`` is its number, from 1, on pinned supports.

    A value that is None is not fitted. Residuals are divided by the standard deviations; with None the
    residual is relative, as in thesis (8.4), and its square is multiplied by a weight, w_ω or w_ζ there.
    ``correlation`` is that of ln f and ln ζ.
    """

    mode: int
    frequency_hz: float | None = None
    frequency_std_hz: float | None = None
    damping_ratio: float | None = None
    damping_ratio_std: float | None = None
    correlation: float = 0.0
    frequency_weight: float = 1.0
    damping_weight: float = 1.0

    @property
    def log_stds(self) -> tuple[float | None, float | None]:
        """Standard deviations of ln f and ln ζ, None if value or deviation is not known."""
        return (
            _ratio(self.frequency_std_hz, self.frequency_hz),
            _ratio(self.damping_ratio_std, self.damping_ratio),
        )


def _ratio(std: float | None, value: float | None) -> float | None:
    return None if std is None or value is None else std / value


@dataclass(frozen=True)
class Residuals:
    r"""Residuals of a set of targets, differentiable in the poles.

    ``relative`` is the thesis's cost (8.4), each residual relative to its measured value and multiplied by
    the root of its weight. Otherwise they are logarithms, whitened by their covariance,

    .. math:: r = L^{-1} \ln(y_\mathrm{model}/y), \quad L L^T = Σ,

    with Σ from the standard deviations and from the correlation of a mode's frequency and damping ratio.
    """

    targets: tuple[Target, ...]
    relative: bool

    def __post_init__(self) -> None:
        require(
            self.targets, "nothing to update to", field="targets", value=[], remedy="give at least one target"
        )
        modes = [target.mode for target in self.targets]
        if len(set(modes)) != len(modes):
            raise InputError(
                "a mode is given twice", field="targets.mode", value=modes, remedy="give one target per mode"
            )
        require(self.used, "no target has a frequency or a damping ratio", field="targets", value=modes)
        for t in self.targets:
            if not -1.0 < t.correlation < 1.0:
                raise InputError(
                    "a correlation must be between −1 and 1", field="targets.correlation", value=t.correlation
                )
            for weight in (t.frequency_weight, t.damping_weight):
                require(
                    0.0 < weight < inf,
                    "a weight must be positive",
                    field="update.weights",
                    value=weight,
                    allowed="> 0",
                    remedy="leave out a value that is not to be fitted",
                )

    @cached_property
    def used(self) -> tuple[Target, ...]:
        """The targets that have a value."""
        return tuple(t for t in self.targets if t.frequency_hz is not None or t.damping_ratio is not None)

    @cached_property
    def modes(self) -> tuple[int, ...]:
        """Mode numbers of the targets that have a value, in their order."""
        return tuple(target.mode for target in self.used)

    @cached_property
    def names(self) -> list[str]:
        """``f1``, ``ζ1``, … of each residual."""
        pairs = [f"{letter}{t.mode}" for t in self.used for letter in ("f", "ζ")]
        return [pairs[i] for i in self._places]

    @property
    def count(self) -> int:
        """Number of residuals."""
        return self._places.size

    @property
    def weighted(self) -> bool:
        """Whether every value has a standard deviation."""
        return not np.isnan(self._log_std).any()

    @property
    def log_normalisation(self) -> float:
        """−log of the normal density of zero residuals in the logarithms of the measured values."""
        known = ~np.isnan(self._log_std)
        return float(0.5 * known.sum() * log(2.0 * pi) - np.log(np.diag(self._whitener)[known]).sum())

    @cached_property
    def _places(self) -> IntArray:
        """Which of (f, ζ) of every used mode are data."""
        pairs = [value for t in self.used for value in (t.frequency_hz, t.damping_ratio)]
        return np.flatnonzero([value is not None for value in pairs])

    @cached_property
    def _measured(self) -> FloatArray:
        pairs = [value or np.nan for t in self.used for value in (t.frequency_hz, t.damping_ratio)]
        return np.array(pairs)[self._places]

    @cached_property
    def _log_std(self) -> FloatArray:
        """Standard deviation of every logarithm, NaN where it is not known."""
        pairs = [np.nan if std is None else std for t in self.used for std in t.log_stds]
        return np.array(pairs)[self._places]

    @cached_property
    def _weight(self) -> FloatArray:
        """Weight of every squared residual; 1 for those with a standard deviation."""
        pairs = [weight for t in self.used for weight in (t.frequency_weight, t.damping_weight)]
        return np.where(self._logarithmic, 1.0, np.array(pairs)[self._places])

    @property
    def total_weight(self) -> float:
        """Sum of the weights: the number of residuals if none has a weight."""
        return float(self._weight.sum())

    @cached_property
    def _logarithmic(self) -> BoolArray:
        return np.logical_and(not self.relative, ~np.isnan(self._log_std))

    @cached_property
    def _whitener(self) -> FloatArray:
        """L⁻¹ (count, count); the roots of the weights for relative residuals."""
        std = np.where(self._logarithmic, self._log_std, 1.0 / np.sqrt(self._weight))
        correlation = np.eye(self.count)
        first = {int(place): i for i, place in enumerate(self._places)}
        for m, t in enumerate(self.used):
            i, j = first.get(2 * m, -1), first.get(2 * m + 1, -1)
            if i >= 0 and j >= 0 and self._logarithmic[[i, j]].all():
                correlation[i, j] = correlation[j, i] = t.correlation
        return np.asarray(np.linalg.inv(np.linalg.cholesky(correlation * np.outer(std, std))))

    def values(self, poles: ComplexArray, *, shift: FloatArray | float = 0.0) -> FloatArray:
        """Return residuals (n_sets, count) for many sets of poles (n_sets, n_modes).

        Parameters
        ----------
        shift : (n_sets, count), optional
            Added to the logarithms of the model's values, to represent errors of the model.
        """
        size = np.abs(poles)
        pairs = np.stack([size / (2.0 * pi), damping_ratio(poles)], axis=-1)
        model = pairs.reshape(len(poles), 2 * len(self.used))[:, self._places]
        ratio = np.maximum(model, _LEAST) / self._measured
        deviation = np.where(self._logarithmic, np.log(ratio), model / self._measured - 1.0)
        return np.asarray((deviation + shift) @ self._whitener.T)

    def jacobian(self, poles: ComplexArray, slopes: ComplexArray) -> FloatArray:
        """Return the residuals' derivatives (count, n_parameters).

        Parameters
        ----------
        poles : (n_modes,) λ of ``modes``
        slopes : (n_modes, n_parameters) dλ/d ln θ
        """
        pairs, model = self._pairs(poles, slopes)
        scale = np.where(self._logarithmic, np.maximum(model, _LEAST), self._measured)
        return np.asarray(self._whitener @ (pairs / scale[:, None]))

    def gains(self, poles: ComplexArray, slopes: ComplexArray) -> FloatArray:
        """Return the residuals' derivatives (n_sets, count, n) by quantities φ that change the poles.

        Parameters
        ----------
        poles : (n_sets, n_modes) λ of ``modes``
        slopes : (n_sets, n_modes, n) dλ/dφ
        """
        pairs, model = self._pairs(poles, slopes)
        return np.asarray(self._whitener @ (pairs / np.maximum(model, _LEAST)[..., None]))

    def _pairs(self, poles: ComplexArray, slopes: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Return derivatives (..., count, n) of frequencies and damping ratios, and these (..., count)."""
        size, zeta, radial, turned = polar(poles, slopes)
        pairs = np.stack([radial / (2.0 * pi), turned], axis=-2)
        model = np.stack([size / (2.0 * pi), zeta], axis=-1)
        shape = (*poles.shape[:-1], 2 * len(self.used))
        pairs, model = pairs.reshape(*shape, slopes.shape[-1]), model.reshape(shape)
        return pairs[..., self._places, :], model[..., self._places]

    def shift_jacobian(self, rows: FloatArray) -> FloatArray:
        """Return the residuals' derivatives from those of the ``shift``, (count, n)."""
        return np.asarray(self._whitener @ rows)


def polar(poles: ComplexArray, slopes: ComplexArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return |λ| and ζ = −Re λ/|λ| of poles, (..., n) each, and the derivatives of both, (..., n, n_z) each.

    Parameters
    ----------
    poles : (..., n) λ
    slopes : (..., n, n_z) dλ
    """
    size = np.abs(poles)
    zeta, column = damping_ratio(poles), size[..., None]
    radial = (np.conj(poles)[..., None] * slopes).real / column
    return size, zeta, radial, -slopes.real / column - zeta[..., None] * radial / column
