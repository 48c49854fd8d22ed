"""Damping of the steel itself."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import Annotated

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.files import Frequency, Schema


@dataclass(frozen=True)
class Rayleigh:
    """C = αM + βK on the structure only (thesis (4.1)–(4.2), whose α and β stand the other way round)."""

    alpha: float = 0.0
    beta: float = 0.0

    @classmethod
    def minimum(cls, damping_ratio: float, frequency_hz: float) -> Rayleigh:
        """Return the damping whose smallest ratio is ``damping_ratio``, at ``frequency_hz``: α = ζω, β = ζ/ω.

        Raises
        ------
        InputError
            If the ratio is not in [0, 1) or the frequency not positive.
        """
        if not 0.0 <= damping_ratio < 1.0:
            raise InputError(
                "damping ratio out of range", field="ratio", value=damping_ratio, allowed="0 ≤ ratio < 1"
            )
        if not 0.0 < frequency_hz < inf:
            raise InputError(
                "frequency must be positive", field="frequency_hz", value=frequency_hz, allowed="> 0"
            )
        omega = 2.0 * pi * frequency_hz
        return cls(alpha=damping_ratio * omega, beta=damping_ratio / omega)

    @classmethod
    def two_points(cls, zeta: tuple[float, float], frequency_hz: tuple[float, float]) -> Rayleigh:
        """Return the damping that has the given ratios at two frequencies."""
        omega = 2.0 * pi * np.array(frequency_hz)
        alpha, beta = np.linalg.solve(0.5 * np.column_stack([1.0 / omega, omega]), np.array(zeta))
        return cls(float(alpha), float(beta))

    def ratio(self, frequency_hz: float | FloatArray) -> float | FloatArray:
        """Return ζ(ω) = α/(2ω) + βω/2."""
        omega = 2.0 * pi * np.asarray(frequency_hz)
        return 0.5 * (self.alpha / omega + self.beta * omega)


class RayleighSchema(Schema):
    """Steel damping in a file: a least ratio and where it stands."""

    ratio: Annotated[float, Field(ge=0.0, lt=1.0)]
    frequency_hz: Frequency

    def build(self) -> Rayleigh:
        """Return the damping."""
        return Rayleigh.minimum(self.ratio, self.frequency_hz)
