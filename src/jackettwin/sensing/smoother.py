r"""The steady state of a Kalman filter and smoother, for whole records and for streams.

With the covariance P of the one-step prediction at rest, K = P Cᵀ S⁻¹ and L = F(I − K C),

.. math::

    x_{k|k-1} &= L\,x_{k-1|k-2} + F K\,y_{k-1}, \qquad e_k = y_k - C\,x_{k|k-1} \\
    r_{k-1} &= C^T S^{-1} e_k + L^T r_k, \qquad x_{k|N} = x_{k|k-1} + P\,r_{k-1}

(the backward pass of Rauch, Tung and Striebel in the form of Bryson and Frazier, which inverts no P: Bierman
1973, eqs. (14)–(19)). A stream stops the backward pass ``lag`` samples after the one it wants: what lies
further ahead counts by :math:`(L^T)^{lag}`. Both passes run in the eigenvectors of L, :math:`L = V Λ V^{-1}`,
where a step is one product a state instead of one a pair of states. P solves the discrete Riccati equation,
found by doubling (Anderson & Moore 1979, section 6.7): twenty steps where a filter takes a million.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as la
from numba import njit

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import NumericalError, require

_MOST_DOUBLINGS = 60
_GROWN = 1e60
_APART = 1e-8
"""Of L, by which its eigenvectors may miss it: they do where two motions decay as one."""
_DRAWN = 1e-9
"""Of the largest variance of what drives states, each in its own scale, below which nothing is drawn."""


@dataclass(frozen=True)
class SteadySmoother:
    """Gains of a model x⁺ = F x + w, y = C x + v at rest.

    Attributes
    ----------
    F, Q : (n, n) step and covariance of what drives it
    C : (m, n)
    R : (m,) variances of the noise
    P : (n, n) covariance of the prediction one step ahead
    smoothed : (n, n) covariance of the state given all of a long record
    stationary : (n, n) covariance of the state before anything is read
    information : (n, n) Λ, what a long record says of the state before it
    """

    F: FloatArray
    Q: FloatArray
    C: FloatArray
    R: FloatArray
    P: FloatArray
    smoothed: FloatArray
    stationary: FloatArray
    information: FloatArray

    @cached_property
    def precision(self) -> FloatArray:
        """S⁻¹ of the innovations, (m, m)."""
        return np.asarray(la.inv(self.C @ self.P @ self.C.T + np.diag(self.R)))

    @cached_property
    def gain(self) -> FloatArray:
        """K of the filter, (n, m)."""
        return np.asarray(self.P @ self.C.T @ self.precision)

    @cached_property
    def closed_loop(self) -> FloatArray:
        """L, (n, n)."""
        return np.asarray(self.F @ (np.eye(self.F.shape[0]) - self.gain @ self.C))

    @cached_property
    def motions(self) -> _Motions:
        """Motions of the closed loop, each of which decays for itself."""
        return _Motions.of(self.closed_loop, self._scale)

    @cached_property
    def _drawn(self) -> tuple[_Motions, FloatArray, FloatArray]:
        """Motions of the model itself, and roots of the covariances of its start and of what drives it."""
        return _Motions.of(self.F, self._scale), _root(self.stationary), _root(self.Q)

    @cached_property
    def _scale(self) -> FloatArray:
        return _scale_of(self.stationary)

    def predict(self, y: FloatArray, start: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Return predictions x_{k|k−1} (N, n) and that after the last of readings y (N, m), (n,)."""
        found = self.motions.forward(y, self.F @ self.gain, start) @ self.motions.states(np.eye(len(self.F)))
        return found[:-1], found[-1]

    def smooth(
        self,
        y: FloatArray,
        start: FloatArray | None = None,
        *,
        ahead: int = 0,
        rows: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Return smoothed states (N − ahead, n), and the prediction (n,) from which the next piece goes on.

        Parameters
        ----------
        y : (N, m) readings
        start : (n,) the prediction of the first sample; without it the motion may have begun anyhow
        ahead : how many samples at the end are only looked ahead at; the next piece begins with them
        rows : (k, n) what is returned of the states, (N − ahead, k); all of them without it
        """
        wanted = np.eye(self.F.shape[0]) if rows is None else rows
        own, kept = self.motions, len(y) - ahead
        x = own.forward(y, self.F @ self.gain, start)
        e = y - x[:-1] @ own.states(self.C)
        r = own.backward(e, self.C.T @ self.precision)
        seen = x[:kept] @ own.states(wanted)
        if start is None:
            # what begins otherwise decays by L in the predictions, of which a long record corrects P Λ
            begun = self.beginning(r[0] @ own.costates(np.eye(len(self.F))))
            first = own.decaying(begun, len(x))
            seen += first[:kept] @ own.states(wanted - wanted @ self.P @ self.information)
            x[kept] += first[kept]
        seen += r[:kept] @ own.costates(wanted @ self.P)
        return seen, x[kept] @ own.states(np.eye(len(self.F)))

    def beginning(self, first: FloatArray) -> FloatArray:
        """Return the state (n,) to begin with, from what the backward pass from rest leaves at the start.

        The state before anything is read is one of covariance P, which the gains at rest suppose, and one of
        the rest Δ of the stationary covariance; the record says of the latter Λ⁻¹r, so that it is
        Δ (I + Λ Δ)⁻¹ r.
        """
        rest = self.stationary - self.P
        return np.asarray(rest @ la.solve(np.eye(len(rest)) + self.information @ rest, first))

    def draw(
        self, number: int, rng: np.random.Generator, rows: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return states (number, n) that the model makes of its own, and their readings (number, m).

        Parameters
        ----------
        rows : (k, n) what is returned of the states, (number, k); all of them without it
        """
        own, start, drive = self._drawn
        first, pushed = rng.standard_normal(start.shape[1]), rng.standard_normal((number - 1, drive.shape[1]))
        x = own.forward(pushed, drive, start @ first)
        noise = np.sqrt(self.R) * rng.standard_normal((number, self.R.size))
        wanted = np.eye(len(self.F)) if rows is None else rows
        return x @ own.states(wanted), x @ own.states(self.C) + noise

    def filtered(self, y: FloatArray) -> FloatArray:
        """Return states given the past and the present only, (N, n)."""
        x, _ = self.predict(y)
        return np.asarray(x + (y - x @ self.C.T) @ self.gain.T)


@dataclass(frozen=True)
class _Motions:
    """Motions of x⁺ = L x that decay each for itself, of conjugate pairs one; all of them where L has none.

    Series of motions are real and imaginary parts side by side, (N, 2p).

    Attributes
    ----------
    rates : (p,) eigenvalues of L
    right : (n, p) its eigenvectors, twice those of pairs
    left : (p, n) rows of their inverse
    """

    rates: ComplexArray
    right: ComplexArray
    left: ComplexArray

    @classmethod
    def of(cls, L: FloatArray, scale: FloatArray) -> _Motions:
        """Return those of L, whose states have a scale (n,).

        Raises
        ------
        NumericalError
            If two motions are one and the same.
        """
        rates, V = np.linalg.eig(L / scale[:, None] * scale)
        inverse: ComplexArray = la.inv(V)
        if not np.abs((V * rates) @ inverse - L / scale[:, None] * scale).max() < _APART:
            raise NumericalError("two motions of the filter decay as one")
        one = rates.imag >= 0.0
        right = np.asarray(_members(rates[one]) * scale[:, None] * V[:, one], dtype=np.complex128)
        return cls(rates[one], right, np.asarray(inverse[one] / scale, dtype=np.complex128))

    def states(self, rows: FloatArray) -> FloatArray:
        """Return what rows (k, n) see of states, by motions (2p, k)."""
        return _parts((rows @ self.right).T)

    def costates(self, rows: FloatArray) -> FloatArray:
        """Return what rows (k, n) see of r, by its motions (2p, k)."""
        return _parts(_members(self.rates)[:, None] * (self.left @ rows.T))

    def forward(self, u: FloatArray, G: FloatArray, start: FloatArray | None) -> FloatArray:
        """Return x⁺ = L x + G u of inputs u (N, m) from a state (n,) or from rest, as motions (N + 1, 2p)."""
        z0 = np.zeros(self.rates.size, dtype=complex) if start is None else self.left @ start
        return _each(self.rates, z0, u @ (self.left @ G).T)

    def backward(self, e: FloatArray, G: FloatArray) -> FloatArray:
        """Return r⁻ = Lᵀ r + G e of inputs e (N, m), from rest at the end, as motions of Lᵀ (N, 2p)."""
        into = (self.right / _members(self.rates)).T @ G
        return _each(self.rates, np.zeros(self.rates.size, dtype=complex), e[::-1] @ into.T)[:0:-1]

    def decaying(self, start: FloatArray, number: int) -> FloatArray:
        """Return how a state (n,) decays, (number, 2p)."""
        still = np.zeros((number - 1, self.rates.size), dtype=complex)
        return _each(self.rates, self.left @ start, still)


def _members(rates: ComplexArray) -> FloatArray:
    """Return 2 for a motion that stands for a conjugate pair, 1 for a real one, (p,)."""
    return np.where(rates.imag > 0.0, 2.0, 1.0)


def _parts(of_motions: ComplexArray) -> FloatArray:
    return np.concatenate([of_motions.real, -of_motions.imag])


def steady_smoother(F: FloatArray, Q: FloatArray, C: FloatArray, R: FloatArray) -> SteadySmoother:
    """Return the gains at rest.

    Raises
    ------
    InputError
        If a variance of the noise is not positive.
    NumericalError
        If there is no rest: what the sensors do not see does not decay.
    """
    require(
        bool((R > 0.0).all()), "must be positive", field="noise", value=R.min(initial=np.inf), allowed="> 0"
    )
    stationary = _stationary(F, Q)
    scale = _scale_of(stationary)
    f, q, c = F / scale[:, None] * scale, Q / np.outer(scale, scale), C * scale
    p = _riccati(f, q, c, R)
    s = la.inv(c @ p @ c.T + np.diag(R))
    loop = f @ (np.eye(len(f)) - p @ c.T @ s @ c)
    known = _stationary(loop.T, c.T @ s @ c)
    size = np.outer(scale, scale)
    P, smoothed = (size * 0.5 * (m + m.T) for m in (p, p - p @ known @ p))
    return SteadySmoother(F, Q, C, R, P, smoothed, 0.5 * (stationary + stationary.T), known / size)


def discrete(A: FloatArray, density: FloatArray, step_s: float) -> tuple[FloatArray, FloatArray]:
    """Return F = e^{Ah} and the covariance (n, n) of what white noise adds in a step (Van Loan 1978).

    By a step so short that nothing decays much within it, and doubling: e^{−Ah}, which the method needs, has
    no digits left of what decays within a step.
    """
    n = len(A)
    fastest = float(np.abs(np.linalg.eigvals(A)).max()) * step_s
    halvings = max(0, int(np.ceil(np.log2(max(fastest, 1e-300)))))
    block = np.zeros((2 * n, 2 * n))
    block[:n, :n], block[:n, n:], block[n:, n:] = -A, density, A.T
    exact = la.expm(block * step_s / 2**halvings)
    F = exact[n:, n:].T
    Q = F @ exact[:n, n:]
    for _ in range(halvings):
        Q, F = Q + F @ Q @ F.T, F @ F
    return F, 0.5 * (Q + Q.T)


def _scale_of(covariance: FloatArray) -> FloatArray:
    """Return standard deviations (n,), by which states of any size are made alike."""
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 1e-300)))


def _root(covariance: FloatArray) -> FloatArray:
    """Return a matrix G (n, k) with G Gᵀ = covariance, which may be singular."""
    scale = _scale_of(covariance)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    some = values > _DRAWN * values[-1]
    return np.asarray(scale[:, None] * vectors[:, some] * np.sqrt(values[some]))


def _stationary(F: FloatArray, Q: FloatArray) -> FloatArray:
    """Return X = F X Fᵀ + Q by doubling.

    Raises
    ------
    NumericalError
        If F does not decay.
    """
    X, power = Q, F
    for _ in range(_MOST_DOUBLINGS):
        X, power = X + power @ X @ power.T, power @ power
        size = np.abs(power).max()
        if size < 1e-16:
            return np.asarray(X)
        if not size < _GROWN:
            break
    raise NumericalError("a motion of the model does not decay")


def _riccati(F: FloatArray, Q: FloatArray, C: FloatArray, R: FloatArray) -> FloatArray:
    """Return P = F (P⁻¹ + CᵀR⁻¹C)⁻¹ Fᵀ + Q by doubling."""
    A, G, H, eye = F.T, C.T @ (C / R[:, None]), Q, np.eye(len(F))
    for _ in range(_MOST_DOUBLINGS):
        W = la.solve(eye + G @ H, np.hstack([A, G]), check_finite=False)
        A1, G1 = W[:, : len(F)], W[:, len(F) :]
        step = A.T @ H @ A1
        G, H, A = G + A @ G1 @ A.T, H + step, A @ A1
        H, G = 0.5 * (H + H.T), 0.5 * (G + G.T)
        if not np.isfinite(H).all():
            break
        if np.abs(step).max() <= 1e-13 * np.abs(H).max():
            return np.asarray(H)
    raise NumericalError("the filter does not come to rest")


@njit(cache=True)
def _each(rates: ComplexArray, z0: ComplexArray, driven: ComplexArray) -> FloatArray:
    """Return z_{k+1} = λ z_k + d_k from z_0 of each motion, real parts beside imaginary ones (N + 1, 2p)."""
    p = rates.size
    x = np.empty((driven.shape[0] + 1, 2 * p))
    x[0, :p], x[0, p:] = z0.real, z0.imag
    c, s = rates.real, rates.imag
    for k in range(driven.shape[0]):
        for j in range(p):
            a, b = x[k, j], x[k, p + j]
            x[k + 1, j] = c[j] * a - s[j] * b + driven[k, j].real
            x[k + 1, p + j] = s[j] * a + c[j] * b + driven[k, j].imag
    return x
