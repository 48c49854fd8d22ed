r"""Strength of simple tubular joints to ISO 19902 (2007), clause 14.3.

Symbols and equation numbers are the standard's: chord D, T, brace d, t at an angle θ, gap g between braces;
β = d/D, γ = D/(2T), τ = t/T. K, Y and X name how a brace's force leaves the joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks.iso19902 import HIGHEST_YIELD_PA
from jackettwin.errors import InputError

GAMMA_J, GAMMA_Q = 1.05, 1.05
"""Partial resistance factors of joints (14.3-3, 14.3-4) and of the chord's yield strength (14.3-10)."""
KINDS = ("K", "Y", "X")
ALPHA_F = (0.030, 0.045, 0.021)
"""Factor of (14.3-9) against a brace's axial force, in-plane and out-of-plane bending."""
C_1 = (14.0, 25.0, 20.0)
C_2 = (43.0, 11.0, 22.0)
"""Table 14.3-2, axial force of K, Y and X joints."""
C_BENDING = (25.0, 43.0)
"""The same against moments, whatever the joint."""
GAMMA_Z = 1.17
"""Extra resistance factor of critical joints, (14.3-13): their braces are to fail first."""
YIELD_OF_TENSILE = 0.8
"""Share of the tensile strength up to which the chord's yield strength counts, 14.2.3."""
IN_PLANE = float(np.cos(np.radians(15.0)))
"""Braces within 15° of each other count as one plane, 14.2.4."""


@dataclass(frozen=True)
class Joint:
    """A brace on its chord: lengths [m], θ [rad], yield strengths [Pa].

    ``gap`` is the largest to a brace beside it in its plane, negative where they overlap; NaN without one.
    ``can_factor`` is what the length of its can leaves of the axial strength of Y and X joints,
    ``can_short_m`` how much longer it ought to be [m] (cans.py).
    """

    D: float
    T: float
    d: float
    t: float
    theta: float
    f_y: float
    f_yb: float
    gap: float = np.nan
    can_factor: float = 1.0
    can_short_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("D", "T", "d", "t", "f_y", "f_yb"):
            if not getattr(self, name) > 0.0:
                raise InputError("must be positive", field=name, value=getattr(self, name), allowed="> 0")
        if not 0.0 < self.theta <= 0.5 * np.pi + 1e-9:
            raise InputError("angle out of range", field="theta", value=self.theta, allowed="0 < θ ≤ π/2")

    @property
    def beta(self) -> float:
        """β = d/D."""
        return self.d / self.D

    @property
    def gamma(self) -> float:
        """γ = D/(2T)."""
        return 0.5 * self.D / self.T

    @property
    def beyond_validity(self) -> tuple[str, ...]:
        """The ranges of 14.3.1 that the joint is outside of, in words."""
        ranges = (
            (0.2 <= self.beta <= 1.0, f"β = {self.beta:.2f} is not 0.2 to 1"),
            (10.0 <= self.gamma <= 50.0, f"γ = {self.gamma:.1f} is not 10 to 50"),
            (np.radians(29.99) <= self.theta, f"θ = {np.degrees(self.theta):.0f}° is below 30°"),
            (self.f_y <= HIGHEST_YIELD_PA, f"f_y = {self.f_y / 1e6:.0f} MPa is above 500 MPa"),
            (
                not self.gap / self.T <= -1.2 * self.gamma,
                f"overlap g/T = {self.gap / self.T:.0f} is beyond −1.2 γ",
            ),
        )
        return tuple(said for fits, said in ranges if not fits)


class StrengthFactors(NamedTuple):
    """Q_u of table 14.3-1: axial force of K, Y and X joints (3,) in tension and compression; bending."""

    tension: FloatArray
    compression: FloatArray
    in_plane: float
    out_of_plane: float


def strength_factors(joint: Joint) -> StrengthFactors:
    r"""Return Q_u.

    .. math::

        K: (1.9 + 19β)\sqrt{Q_β}\,Q_g; \qquad Y: 30β \mid (1.9 + 19β)\sqrt{Q_β}; \qquad
        X: 23β,\; 20.7 + (β - 0.9)(17γ - 220) \text{ from } β = 0.9 \mid (2.8 + (12 + 0.1γ)β)\,Q_β

        M_{ip}: 4.5β\sqrt{γ}, \qquad M_{op}: 3.2γ^{β^2/2}

    (tension | compression), with Q_β = 0.3/(β(1 − 0.833β)) above β = 0.6, else 1 (14.3-5, 14.3-6).
    """
    beta, gamma = min(joint.beta, 1.0), joint.gamma
    Q_beta = 0.3 / (beta * (1.0 - 0.833 * beta)) if beta > 0.6 else 1.0
    y = (1.9 + 19.0 * beta) * Q_beta**0.5
    K = y * gap_factor(joint)
    x_tension = 23.0 * beta if beta <= 0.9 else 20.7 + (beta - 0.9) * (17.0 * gamma - 220.0)
    x_compression = (2.8 + (12.0 + 0.1 * gamma) * beta) * Q_beta
    return StrengthFactors(
        np.array([K, 30.0 * beta, x_tension]),
        np.array([K, y, x_compression]),
        4.5 * beta * gamma**0.5,
        3.2 * gamma ** (0.5 * beta**2),
    )


def gap_factor(joint: Joint) -> float:
    r"""Return Q_g of K joints; 1 without a brace beside.

    .. math::

        1.9 - 0.7\sqrt{g/(Tγ)} \ge 1 \text{ from } g/T = 2 \;(14.3\text{-}7), \qquad
        0.13 + 0.65 φ\sqrt{γ},\; φ = t f_{yb}/(T f_y) \text{ up to } g/T = -2 \;(14.3\text{-}8),

    straight in between.
    """
    ratio, gamma = joint.gap / joint.T, joint.gamma
    if not np.isfinite(ratio):
        return 1.0
    phi = joint.t * joint.f_yb / (joint.T * joint.f_y)
    apart = max(1.0, 1.9 - 0.7 * (max(ratio, 2.0) / gamma) ** 0.5)
    overlapping = 0.13 + 0.65 * phi * gamma**0.5
    return float(np.interp(ratio, (-2.0, 2.0), (overlapping, apart)))


class BraceForces(NamedTuple):
    """Axial force (tension positive), in-plane and out-of-plane moment of a brace [N, N·m], (n,) each."""

    axial: FloatArray
    in_plane: FloatArray
    out_of_plane: FloatArray


class JointUse(NamedTuple):
    """U_j (n,) and what made it: axial Q_u (n,), and Q_f of axial force and both moments (3, n)."""

    utilisation: FloatArray
    Q_u: FloatArray
    Q_f: FloatArray


def joint_use(
    joint: Joint,
    forces: BraceForces,
    shares: FloatArray,
    chord_axial: FloatArray,
    chord_bending: FloatArray,
    *,
    conservative: bool = False,
) -> JointUse:
    r"""Return U_j of (14.3-12) at every instant.

    .. math::

        P_d = \frac{f_y T^2}{γ_j \sin θ} Q_u Q_f, \quad M_d = \frac{f_y T^2 d}{γ_j \sin θ} Q_u Q_f
        \;(14.3\text{-}1\ldots4), \qquad U_j = \frac{|P|}{P_d} + \left(\frac{M}{M_d}\right)_{ip}^2 +
        \left|\frac{M}{M_d}\right|_{op}

        Q_f = 1 - α q_A^2 \;(14.3\text{-}9), \quad q_A = γ_q\sqrt{C_1 (P_C/P_y)^2 + C_2 (M_C/M_p)^2}
        \;(14.3\text{-}10)

    Parameters
    ----------
    shares : (3, n)
        How much of the axial force is a K, Y and X joint's; they mix strengths and C_1, C_2 (14.2.4).
    chord_axial, chord_bending : (n,) or (n_sides, n)
        Chord's axial force and resultant moment [N, N·m]; of several sides the worst counts.
    conservative : bool
        Take the weakest kind instead of the shares.
    """
    q = strength_factors(joint)
    by_kind = np.where(forces.axial >= 0.0, q.tension[:, None], q.compression[:, None])
    by_kind = by_kind * np.array([1.0, joint.can_factor, joint.can_factor])[:, None]
    C_1n, C_2n = np.array(C_1) @ shares, np.array(C_2) @ shares
    Q_u = (shares * by_kind).sum(axis=0)
    if conservative:
        Q_u, C_1n, C_2n = by_kind.min(axis=0), np.full_like(Q_u, max(C_1)), np.full_like(Q_u, max(C_2))
    inner = joint.D - 2.0 * joint.T
    P_y = joint.f_y * 0.25 * np.pi * (joint.D**2 - inner**2)
    M_p = joint.f_y * (joint.D**3 - inner**3) / 6.0
    p, m = (np.atleast_2d(v) ** 2 for v in (chord_axial / P_y, chord_bending / M_p))
    axial = (GAMMA_Q**2 * (C_1n * p + C_2n * m)).max(axis=0)
    bending = (GAMMA_Q**2 * (C_BENDING[0] * p + C_BENDING[1] * m)).max(axis=0)
    lost = np.array(ALPHA_F)[:, None] * np.stack([axial, bending, bending])
    # a chord that yields leaves the joint nothing: a use beyond any limit, but finite
    Q_f = np.maximum(1.0 - lost, 1e-3)
    force = joint.f_y * joint.T**2 / (GAMMA_J * np.sin(joint.theta))
    U = (
        np.abs(forces.axial) / (force * Q_u * Q_f[0])
        + (forces.in_plane / (force * joint.d * q.in_plane * Q_f[1])) ** 2
        + np.abs(forces.out_of_plane) / (force * joint.d * q.out_of_plane * Q_f[2])
    )
    return JointUse(U, Q_u, Q_f)


def load_path(
    axial: FloatArray, theta: FloatArray, across: FloatArray, of: Sequence[int] | None = None
) -> FloatArray:
    """Return how much of every brace's force is a K, Y and X joint's, (3, n_braces, n), by 14.2.4.

    In each plane what pulls and what pushes on one side of the chord balances: K. Of what is left, what meets
    the like from the other side goes through the chord: X. The rest goes into the chord: Y.

    Parameters
    ----------
    axial : (n_braces, n) tension positive [N]
    theta : (n_braces,) [rad]
    across : (n_braces, 3) unit vectors from the chord, normal to it
    of : braces whose shares are returned; all of them without it
    """
    normal = axial * np.sin(theta)[:, None]
    cosines = across @ across.T
    beside, opposite = cosines > IN_PLANE, cosines < -IN_PLANE
    asked = range(len(axial)) if of is None else of
    shares = np.zeros((3, len(asked), axial.shape[1]))
    for at, i in enumerate(asked):
        pull, push = _both(normal[beside[i]])
        left = np.abs(pull - push)
        own = np.where(normal[i] >= 0.0, pull, push)
        safe = np.maximum(own, 1e-300)
        # a brace on the weaker side of its plane is balanced wholly
        free = np.where(np.where(normal[i] >= 0.0, pull - push, push - pull) > 0.0, left / safe, 0.0)
        other_pull, other_push = _both(normal[opposite[i]])
        like = np.where(normal[i] >= 0.0, other_pull - other_push, other_push - other_pull)
        through = free * np.minimum(np.maximum(like, 0.0) / np.maximum(left, 1e-300), 1.0)
        shares[:, at] = 1.0 - free, free - through, through
    return shares


def _both(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the sums of what pulls and of what pushes, (n,) each."""
    return np.maximum(normal, 0.0).sum(axis=0), np.maximum(-normal, 0.0).sum(axis=0)
