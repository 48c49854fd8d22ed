r"""Lags of an operating rotor's aerodynamics: dynamic inflow of the wake, and unsteady lift of a section.

The wake follows what balances momentum through two lags in series, Øye's model (Snel & Schepers 1995,
ECN-C--94-107; OpenFAST's DBEMT): of a motion with e^{st} a blade element sees the share

.. math:: H(s) = \frac{1 + k s τ_1}{(1 + s τ_1)(1 + s τ_2)}, \quad k = 0.6

of the wake in balance, with τ₁ = 1.1 R/((1 − 1.3 ā) V) and τ₂ = (0.39 − 0.26 (r/R)²) τ₁. Attached flow gives
of a change of the angle of attack the share

.. math:: 1 - \sum_j A_j \frac{p}{p + b_j}, \quad p = s c / 2U

of the steady lift, A = 0.3, 0.7 and b = 0.14, 0.53 (Leishman & Beddoes 1989, J. Am. Helicopter Soc. 34(3):3).
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.loads.operation.bem import OperatingPoint, ring_radius

_FAST_SHARE = 0.6
"""k of Øye's model, the part of the wake that answers with the second lag alone."""
_HIGHEST_INDUCTION = 0.5
"""Beyond which τ₁ grows no further."""
_LIFT_LAGS = ((0.3, 0.14), (0.7, 0.53))
"""A and b of Leishman and Beddoes."""


def wake_share(rotor: Rotor, operation: OperatingPoint, rate: complex) -> ComplexArray:
    """Return H(s) at the stations (n,); iω is a harmonic motion."""
    r = ring_radius(rotor)
    area = r * rotor.blade.weight
    a = float(area @ operation.induced[:, 0] / area.sum()) / operation.wind_speed
    tau = 1.1 / (1.0 - 1.3 * min(a, _HIGHEST_INDUCTION)) * rotor.radius / operation.wind_speed
    near = (0.39 - 0.26 * (r / rotor.radius) ** 2) * tau
    return np.asarray((1.0 + _FAST_SHARE * tau * rate) / ((1.0 + tau * rate) * (1.0 + near * rate)))


def lift_share(reduced_rate: ComplexArray) -> ComplexArray:
    """Return the share of the steady lift at reduced rates sc/2U, of any shape."""
    return np.asarray(1.0 - sum(A * reduced_rate / (reduced_rate + b) for A, b in _LIFT_LAGS))
