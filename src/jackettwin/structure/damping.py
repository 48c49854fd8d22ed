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
        """Return the damping that has the given ratios at two frequencies.

        Raises
        ------
        InputError
            If a ratio or frequency is out of range, the frequencies are equal, or the ratios are so far apart
            that α or β is negative: beyond the two frequencies the damping would feed energy in.
        """
        f, z = np.array(frequency_hz, dtype=float), np.array(zeta, dtype=float)
        for wrong, name, value, allowed in (
            (not ((z >= 0.0) & (z < 1.0)).all(), "ratio", zeta, "two, 0 ≤ ratio < 1"),
            (not ((f > 0.0) & (f < inf)).all() or f[0] == f[1], "frequency_hz", frequency_hz, "two, > 0"),
        ):
            if wrong:
                raise InputError("two points of damping", field=name, value=list(value), allowed=allowed)
        omega = 2.0 * pi * f
        alpha, beta = np.linalg.solve(0.5 * np.column_stack([1.0 / omega, omega]), z)
        # rounding of the solution, relative to its two terms
        least = -1e-12 * z.max()
        if alpha < least * omega.max() or beta < least / omega.min():
            low, high = sorted((f[0] / f[1], f[1] / f[0]))
            raise InputError(
                "ratios too far apart for Rayleigh damping: beyond them it would feed energy in",
                field="ratio",
                value=list(zeta),
                allowed=f"second over first from {low:.3g} to {high:.3g} at these frequencies",
                remedy="damping.modes takes a ratio for each mode",
            )
        return cls(max(float(alpha), 0.0), max(float(beta), 0.0))

    def ratio(self, frequency_hz: float | FloatArray) -> float | FloatArray:
        """Return ζ(ω) = α/(2ω) + βω/2."""
        omega = 2.0 * pi * np.asarray(frequency_hz)
        return 0.5 * (self.alpha / omega + self.beta * omega)


Ratio = Annotated[float, Field(ge=0.0, lt=1.0)]


class RayleighSchema(Schema):
    """Steel damping in a file: a least ratio and where it stands, or two ratios at two frequencies."""

    ratio: Ratio | tuple[Ratio, Ratio]
    frequency_hz: Frequency | tuple[Frequency, Frequency]

    def build(self) -> Rayleigh:
        """Return the damping.

        Raises
        ------
        InputError
            If there is one ratio for two frequencies or the other way round, or they do not go together.
        """
        ratio, f = self.ratio, self.frequency_hz
        if isinstance(ratio, tuple) and isinstance(f, tuple):
            return Rayleigh.two_points(ratio, f)
        if isinstance(ratio, tuple) or isinstance(f, tuple):
            raise InputError(
                "one ratio at one frequency, or two at two",
                field="damping.rayleigh",
                value={"ratio": ratio, "frequency_hz": f},
                remedy="ratio: [0.005, 0.01] goes with frequency_hz: [0.18, 0.75]",
            )
        return Rayleigh.minimum(ratio, f)

    @property
    def least(self) -> float:
        """The smallest ratio at any frequency: √(αβ)."""
        made = self.build()
        return float(np.sqrt(made.alpha * made.beta))
