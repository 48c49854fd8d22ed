r"""Linear viscoelastic laws as one idea: a complex stiffness D(s).

A force f follows a displacement u as f̂(s) = D(s) û(s). Springs, dashpots and Maxwell branches give

.. math:: D(s) = k_0 + c s + \sum_j \frac{k_j τ_j s}{1 + τ_j s}

which holds the elastic spring, Kelvin–Voigt (thesis (4.5)), Maxwell (4.3), Zener (4.7) and the generalised
Maxwell (Prony) solid. A springpot, D(s) = k (s/ω₀)^α, dissipates the same share of energy at every frequency.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import atan, gamma, pi

import numpy as np
from scipy.linalg import expm

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.laws.coefficients import (
    ALPHA,
    BRANCHES,
    K0,
    K_ALPHA,
    OMEGA0,
    C,
    law_slope,
    law_stiffness,
    static_rows,
)

_LARGEST = 1e25
"""Largest stiffness, damping and relaxation time: rigid in any structure, and clear of overflow."""


class Law(ABC):
    """A complex stiffness, vectorised over s [rad/s]: what its row of numbers says."""

    @property
    @abstractmethod
    def row(self) -> FloatArray:
        """Its numbers (width,), as :mod:`jackettwin.soil.laws.coefficients` orders them."""

    @abstractmethod
    def creep(self, t: FloatArray) -> FloatArray:
        """Return the displacement under a unit step of force at times t > 0 [m/N]."""

    @abstractmethod
    def relaxation(self, t: FloatArray) -> FloatArray:
        """Return the force under a unit step of displacement at times t > 0 [N/m]."""

    def stiffness(self, s: ComplexArray | complex) -> ComplexArray:
        """Return D(s) [N/m]."""
        return law_stiffness(self.row, s)

    def slope(self, s: ComplexArray | complex) -> ComplexArray:
        """Return dD/ds [N·s/m]."""
        return law_slope(self.row, s)

    @property
    def dashpot(self) -> float:
        """Parallel dashpot [N·s/m]."""
        return float(self.row[C])

    @property
    def branches(self) -> list[tuple[float, float]]:
        """Spring [N/m] and relaxation time [s] of each Maxwell branch that is neither absent nor locked."""
        pairs = self.row[BRANCHES:].reshape(-1, 2).tolist()
        return [(k, tau) for k, tau in pairs if k > 0.0 and tau > 0.0]

    @property
    def is_rational(self) -> bool:
        """Whether D(s) has finitely many poles, so that internal variables describe the law."""
        return not self.row[K_ALPHA]

    @property
    def dissipates(self) -> bool:
        """Whether a motion loses energy in it."""
        fractional = self.row[K_ALPHA] > 0.0 and self.row[ALPHA] > 0.0
        return bool(self.dashpot > 0.0 or fractional or self.branches)

    @property
    def static_stiffness(self) -> float:
        """Stiffness of the undamped structure: D(0), for the springpot Re D(iω₀) [N/m]."""
        return float(static_rows(self.row)[K0])


@dataclass(frozen=True)
class Prony(Law):
    """Spring, dashpot and Maxwell branches in parallel.

    Attributes
    ----------
    k0 : float
        Parallel spring [N/m].
    c : float
        Parallel dashpot [N·s/m].
    k, tau : tuple of float
        Spring [N/m] and relaxation time c_j/k_j [s] of each Maxwell branch.
    """

    k0: float = 0.0
    c: float = 0.0
    k: tuple[float, ...] = ()
    tau: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for name, values in (("k0", (self.k0,)), ("c", (self.c,)), ("k", self.k), ("tau", self.tau)):
            for value in values:
                require_passive(name, value)
        if len(self.k) != len(self.tau):
            raise InputError(
                "every branch needs k and tau", field="branches", value=(len(self.k), len(self.tau))
            )

    @property
    def row(self) -> FloatArray:
        """Its numbers."""
        row = np.zeros(BRANCHES + 2 * len(self.k))
        row[K0], row[C], row[OMEGA0] = self.k0, self.c, 1.0
        row[BRANCHES::2], row[BRANCHES + 1 :: 2] = self.k, self.tau
        return row

    def relaxation(self, t: FloatArray) -> FloatArray:
        """Return k0 + Σ k_j exp(−t/τ_j), thesis (4.4) and (4.9), without the dashpot's impulse at t = 0."""
        t = np.asarray(t, dtype=np.float64)
        force = np.full_like(t, self.k0)
        for k, tau in zip(self.k, self.tau, strict=True):
            force = force + k * np.exp(-t / tau) if tau > 0.0 else force
        return np.asarray(force)

    def creep(self, t: FloatArray) -> FloatArray:
        """Return the displacement under a unit force, thesis (4.6) and (4.8), from the internal variables.

        Raises
        ------
        InputError
            If the law has no stiffness at all and cannot carry a force.
        """
        t = np.asarray(t, dtype=np.float64)
        k, tau = np.array(self.k), np.array(self.tau)
        live = tau > 0.0
        k, tau = k[live], tau[live]
        if self.c > 0.0:
            # c u̇ + k0 u + Σ k_j (u − y_j) = 1,  τ_j ẏ_j = u − y_j
            A = np.zeros((1 + k.size, 1 + k.size))
            A[0, 0], A[0, 1:] = -(self.k0 + k.sum()) / self.c, k / self.c
            A[1:, 0], A[1:, 1:] = 1.0 / tau, -np.diag(1.0 / tau)
            forcing = np.concatenate([[1.0 / self.c], np.zeros(k.size)])
            return np.asarray(_step_response(A, forcing, np.zeros(1 + k.size), t)[0])
        total = self.k0 + k.sum()
        if total <= 0.0:
            raise InputError(
                "a law without stiffness cannot carry a force", field="k0", value=self.k0, allowed="> 0"
            )
        # (k0 + Σk_j) u = 1 + Σ k_j y_j,  τ_j ẏ_j = u − y_j
        A = (np.outer(np.ones(k.size), k / total) - np.eye(k.size)) / tau[:, None]
        y = _step_response(A, 1.0 / (total * tau), np.zeros(k.size), t) if k.size else np.zeros((0, t.size))
        return np.asarray((1.0 + k @ y) / total)


@dataclass(frozen=True)
class Springpot(Law):
    """D(s) = k (s/ω₀)^α on the principal branch: loss factor tan(απ/2) at every frequency.

    Attributes
    ----------
    k : float
        |D(iω₀)| [N/m].
    alpha : float
        0 is a spring, 1 a dashpot.
    omega0 : float
        Reference angular frequency [rad/s].
    """

    k: float
    alpha: float
    omega0: float

    def __post_init__(self) -> None:
        require_positive("k", self.k)
        require_positive("omega0", self.omega0)
        if not 0.0 <= self.alpha < 1.0:
            raise InputError(
                "exponent out of range", field="alpha", value=self.alpha, allowed="0 ≤ alpha < 1"
            )

    @classmethod
    def from_loss_factor(cls, k: float, loss_factor: float, omega0: float) -> Springpot:
        """Return the springpot with storage stiffness ``k`` at ω₀ and a loss factor: α = (2/π) atan η."""
        alpha = 2.0 / pi * atan(loss_factor)
        return cls(k / float(np.cos(0.5 * pi * alpha)), alpha, omega0)

    @property
    def row(self) -> FloatArray:
        """Its numbers."""
        row = np.zeros(BRANCHES)
        row[K_ALPHA], row[ALPHA], row[OMEGA0] = self.k, self.alpha, self.omega0
        return row

    def creep(self, t: FloatArray) -> FloatArray:
        """Return (ω₀t)^α / (k Γ(1+α))."""
        return np.asarray((self.omega0 * np.asarray(t)) ** self.alpha / (self.k * gamma(1.0 + self.alpha)))

    def relaxation(self, t: FloatArray) -> FloatArray:
        """Return k (ω₀t)^(−α) / Γ(1−α)."""
        return np.asarray(self.k * (self.omega0 * np.asarray(t)) ** (-self.alpha) / gamma(1.0 - self.alpha))


def require_positive(field: str, value: float) -> None:
    """Refuse what is not a positive number.

    Raises
    ------
    InputError
        Names the field.
    """
    if not 0.0 < value <= _LARGEST:
        allowed, remedy = f"> 0, at most {_LARGEST:g}", "check the number and its unit"
        raise InputError("must be positive", field=field, value=value, allowed=allowed, remedy=remedy)


def require_passive(field: str, value: float) -> None:
    """Refuse a number that would make a support feed energy in, or that is no support's."""
    if not 0.0 <= value <= _LARGEST:
        problem = "must not be negative: the support would feed energy in" if value < 0.0 else "out of range"
        allowed, remedy = f"0 to {_LARGEST:g}", "check the number; SI units"
        raise InputError(problem, field=field, value=value, allowed=allowed, remedy=remedy)


def kelvin_voigt(k: float, c: float) -> Prony:
    """Return D = k + c s, thesis (4.5)."""
    require_passive("k", k)
    return Prony(k0=k, c=c)


def maxwell(k: float, c: float) -> Prony:
    """Return a spring and a dashpot in series, thesis (4.3)."""
    require_positive("k", k)
    require_passive("c", c)
    return Prony(k=(k,), tau=(c / k,))


def zener(k0: float, c: float, k1: float) -> Prony:
    """Return k0 beside a Maxwell branch (k1, c), thesis (4.7) and (7.5)."""
    require_positive("k1", k1)
    require_passive("c", c)
    return Prony(k0=k0, k=(k1,), tau=(c / k1,))


# Fixed shape of the three-branch law: least-maximum error of a constant loss factor from 0.55 to 16 f0, which
# holds the global modes of a support structure whose first is f0 (0.1–3 Hz at 0.183 Hz).
MAXWELL_3_CORNERS = (0.519, 3.153, 20.0)
"""In units of f0."""
MAXWELL_3_WEIGHTS = (0.161, 0.128, 0.219)
"""Branches over the static spring at a loss factor of 0.1."""
MAXWELL_3_BRANCHES = 1j / (np.array(MAXWELL_3_CORNERS) + 1j)
"""Response of each branch at f0."""
MAXWELL_3_TILT = 1.5
"""ln of what the ratio of neighbouring weights grows by as the loss factor grows by one."""
MAXWELL_3_LARGEST = 0.8
"""Three branches cannot give this loss factor or a larger one."""


def maxwell_3(k: float, loss_factor: float, f0: float) -> Prony:
    """Return the three-branch law with storage stiffness ``k`` and ``loss_factor`` at ``f0`` [Hz].

    The branches keep their corners about f0. A spring that loses more stiffens more with frequency; branches
    at higher frequencies must grow with it for the loss factor to stay: their weights are
    w_j exp(1.5 (η − 0.1) j). Their common scale s solves η = s·I/(1 + s·R), with R + iI the response of the
    unscaled branches at f0. From 0.55 to 16 f0 the loss factor is then constant to 3 % for η from 0.02 to 0.3
    and to 8 % at 0.6.

    Raises
    ------
    InputError
        If the loss factor is beyond what the shape can give.
    """
    require_positive("f0", f0)
    require_passive("k", k)
    common, response, w = maxwell_3_scale(loss_factor)
    scale = float(common)
    k0 = k / (1.0 + scale * float(response.real))
    return Prony(
        k0=k0, k=tuple(float(v) for v in scale * w * k0), tau=tuple(float(v) for v in maxwell_3_times(f0))
    )


def maxwell_3_times(f0: float) -> FloatArray:
    """Return the relaxation times (3,) of the three branches about ``f0`` [Hz]."""
    return np.asarray(1.0 / (2.0 * pi * f0 * np.array(MAXWELL_3_CORNERS)))


def maxwell_3_scale(loss_factor: FloatArray | float) -> tuple[FloatArray, ComplexArray, FloatArray]:
    """Return the branches' common scale s (...), their response R + iI at f0 (...) and weights (..., 3).

    Raises
    ------
    InputError
        If the loss factor is beyond what the shape can give.
    """
    eta = np.asarray(loss_factor, dtype=float)
    if not ((eta >= 0.0) & (eta < MAXWELL_3_LARGEST)).all():
        raise InputError(
            "loss factor out of range",
            field="loss_factor",
            value=loss_factor,
            allowed=f"0 ≤ loss_factor < {MAXWELL_3_LARGEST:.3g}",
        )
    tilt = MAXWELL_3_TILT * np.multiply.outer(eta - 0.1, np.arange(3.0))
    w = np.array(MAXWELL_3_WEIGHTS) * np.exp(tilt)
    response = w @ MAXWELL_3_BRANCHES
    return np.asarray(eta / (response.imag - eta * response.real)), np.asarray(response), w


def loss_factor(law: Law, frequency_hz: FloatArray | float) -> FloatArray:
    """Return η = Im D / Re D at real frequencies, thesis (5.2) for Kelvin–Voigt."""
    D = law.stiffness(2j * pi * np.asarray(frequency_hz))
    return np.asarray(D.imag / D.real)


def prony_fit(law: Springpot, low_hz: float, high_hz: float, per_decade: int = 4) -> Prony:
    r"""Return branches that follow a springpot between two frequencies (a start for exact solvers).

    The trapezoidal rule in ln ω on the springpot's continuous relaxation spectrum

    .. math:: D(s) = \frac{\sin πα}{π} k \int (ω/ω_0)^α \frac{s}{s + ω} \, d\ln ω

    converges exponentially with the number of branches. Its infinite tails are geometric series: those below
    are lumped into one slow branch with their weight and mean corner, those above into a dashpot.
    """
    alpha = law.alpha
    if alpha == 0.0:
        return Prony(k0=law.k)
    number = int(np.ceil(per_decade * np.log10(high_hz / low_hz))) + 1
    log_omega, h = np.linspace(np.log(2.0 * pi * low_hz), np.log(2.0 * pi * high_hz), number, retstep=True)
    omega = np.exp(log_omega)
    k = np.sin(pi * alpha) / pi * law.k * (omega / law.omega0) ** alpha * h
    below = k[0] / np.expm1(alpha * h)
    below_moment = k[0] * omega[0] / np.expm1((1.0 + alpha) * h)
    above = k[-1] / omega[-1] / np.expm1((1.0 - alpha) * h)
    return Prony(
        c=float(above),
        k=(float(below), *map(float, k)),
        tau=(float(below / below_moment), *map(float, 1.0 / omega)),
    )


def one_branch(row: FloatArray, radius: float) -> Prony:
    """Return spring, dashpot and one branch with its corner in mid band, least squares on a law's D(iω).

    A start for exact solvers: within 10 % of a springpot, its exponent 0.1, from ``radius``/30 [rad/s] up.

    Parameters
    ----------
    row : (width,) numbers of the law, as :mod:`jackettwin.soil.laws.coefficients` orders them
    radius : float
        End of the band [rad/s].
    """
    omega = radius * np.array([0.1, 0.2, 0.4, 0.8])
    s = np.asarray(1j * omega, dtype=np.complex128)
    tau = 2.0 / radius
    D = law_stiffness(row, s)
    A = np.stack([np.ones_like(s), s / radius, tau * s / (1.0 + tau * s)], axis=1) / np.abs(D)[:, None]
    D = D / np.abs(D)
    fit = np.linalg.lstsq(np.vstack([A.real, A.imag]), np.concatenate([D.real, D.imag]))[0]
    k0, c, k1 = np.maximum(fit, 0.0)
    return Prony(float(k0), float(c / radius), (float(k1),), (tau,))


def _step_response(A: FloatArray, b: FloatArray, x0: FloatArray, t: FloatArray) -> FloatArray:
    """Return x(t) of ẋ = Ax + b, shape (n, n_times)."""
    n = x0.size
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = A, b
    start = np.concatenate([x0, [1.0]])
    return np.stack([(expm(augmented * time) @ start)[:n] for time in t.ravel()], axis=1)
