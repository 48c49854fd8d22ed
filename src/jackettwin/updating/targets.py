"""What the model is updated to: frequencies and damping ratios of numbered modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Target:
    """A mode known from elsewhere; ``mode`` counts from 1 on pinned supports.

    A value that is None takes no part in the fit. The standard deviations weigh the residuals; with None
    the residual is relative, as in thesis (8.4).
    """

    mode: int
    frequency_hz: float | None = None
    frequency_std_hz: float | None = None
    damping_ratio: float | None = None
    damping_ratio_std: float | None = None


@dataclass(frozen=True)
class Residuals:
    """Residuals of a set of targets, differentiable in the poles.

    ``relative`` is the thesis's cost (8.4), each residual relative to its measured value; otherwise each is a
    logarithm over its own standard deviation, which treats a ratio that is known to 30 % as such.
    """

    targets: tuple[Target, ...]
    relative: bool

    def __post_init__(self) -> None:
        if not self.targets:
            raise InputError(
                "nothing to update to", field="targets", value=[], remedy="give at least one target"
            )
        modes = [target.mode for target in self.targets]
        if len(set(modes)) != len(modes):
            raise InputError("a mode is given twice", field="targets.mode", value=modes)
        if not any(self._used()):
            raise InputError("no target has a frequency or a damping ratio", field="targets", value=modes)

    def _used(self) -> list[bool]:
        return [
            flag for t in self.targets for flag in (t.frequency_hz is not None, t.damping_ratio is not None)
        ]

    @property
    def used(self) -> tuple[Target, ...]:
        """The targets that have a value."""
        return tuple(t for t in self.targets if t.frequency_hz is not None or t.damping_ratio is not None)

    @property
    def modes(self) -> tuple[int, ...]:
        """Mode numbers of the targets that have a value, in their order."""
        return tuple(target.mode for target in self.used)

    @property
    def names(self) -> list[str]:
        """``f1``, ``ζ1``, … of each residual."""
        pairs = [(letter, t.mode) for t in self.targets for letter in ("f", "ζ")]
        return [f"{letter}{mode}" for (letter, mode), used in zip(pairs, self._used(), strict=True) if used]

    @property
    def count(self) -> int:
        """Number of residuals."""
        return sum(self._used())

    @property
    def weighted(self) -> bool:
        """Whether every value has a standard deviation."""
        return all(
            std is not None
            for t in self.targets
            for value, std in (
                (t.frequency_hz, t.frequency_std_hz),
                (t.damping_ratio, t.damping_ratio_std),
            )
            if value is not None
        )

    @property
    def log_normalisation(self) -> float:
        """−log of the normal density of zero residuals in the logarithms of the measured values."""
        scales = [
            std / value
            for t in self.targets
            for value, std in (
                (t.frequency_hz, t.frequency_std_hz),
                (t.damping_ratio, t.damping_ratio_std),
            )
            if value is not None and std is not None
        ]
        return float(np.sum(np.log(np.sqrt(2.0 * np.pi) * np.array(scales))))

    def values(self, poles: ComplexArray) -> FloatArray:
        """Return residuals (n_sets, count) alone for many sets of poles (n_sets, n_modes)."""
        columns = []
        for target, pole in zip(self.used, poles.T, strict=True):
            size = np.abs(pole)
            if target.frequency_hz is not None:
                columns.append(
                    self._value(size / (2.0 * np.pi), target.frequency_hz, target.frequency_std_hz)
                )
            if target.damping_ratio is not None:
                columns.append(self._value(-pole.real / size, target.damping_ratio, target.damping_ratio_std))
        return np.stack(columns, axis=1)

    def _value(self, model: FloatArray, measured: float, std: float | None) -> FloatArray:
        if self.relative or std is None:
            return (model - measured) / measured
        return np.asarray(np.log(np.maximum(model, 1e-9) / measured) / (std / measured))

    def evaluate(self, poles: ComplexArray, slopes: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals (count,) and their Jacobian (count, n_parameters).

        Parameters
        ----------
        poles : (n_modes,) λ of ``modes``
        slopes : (n_modes, n_parameters) dλ/d ln θ
        """
        values, rows = [], []
        for target, pole, slope in zip(self.used, poles, slopes, strict=True):
            size = abs(pole)
            radial = (np.conj(pole) * slope).real / size  # d|λ|
            if target.frequency_hz is not None:
                r, dr = self._residual(
                    size / (2.0 * np.pi), radial / (2.0 * np.pi), target.frequency_hz, target.frequency_std_hz
                )
                values.append(r)
                rows.append(dr)
            if target.damping_ratio is not None:
                zeta = -pole.real / size
                dzeta = -slope.real / size - zeta * radial / size
                r, dr = self._residual(zeta, dzeta, target.damping_ratio, target.damping_ratio_std)
                values.append(r)
                rows.append(dr)
        return np.array(values), np.array(rows)

    def _residual(
        self, model: float, slope: FloatArray, measured: float, std: float | None
    ) -> tuple[float, FloatArray]:
        value = float(self._value(np.asarray(model), measured, std))
        if self.relative or std is None:
            return value, slope / measured
        return value, slope / max(model, 1e-9) * (measured / std)
