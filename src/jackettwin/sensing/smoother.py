r"""The steady state of a Kalman filter and smoother, for whole records and for streams.

With the covariance P of the one-step prediction at rest, K = P Cᵀ S⁻¹ and L = F(I − K C),

.. math::

    x_{k|k-1} &= L\,x_{k-1|k-2} + F K\,y_{k-1}, \qquad e_k = y_k - C\,x_{k|k-1} \\
    r_{k-1} &= C^T S^{-1} e_k + L^T r_k, \qquad x_{k|N} = x_{k|k-1} + P\,r_{k-1}

(the backward pass of Rauch, Tung and Striebel in the form of Bryson and Frazier, which inverts no P: Bierman
1973, eqs. (14)–(19)). A stream stops the backward pass ``lag`` samples after the one it wants: what lies
further ahead counts by :math:`(L^T)^{lag}`. P solves the discrete Riccati equation, found by doubling
(Anderson & Moore 1979, section 6.7), which takes twenty steps where a filter takes a million.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from numba import njit

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError, require

_MOST_DOUBLINGS = 60
_GROWN = 1e60


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

    @property
    def precision(self) -> FloatArray:
        """S⁻¹ of the innovations, (m, m)."""
        return np.asarray(la.inv(self.C @ self.P @ self.C.T + np.diag(self.R)))

    @property
    def gain(self) -> FloatArray:
        """K of the filter, (n, m)."""
        return np.asarray(self.P @ self.C.T @ self.precision)

    @property
    def closed_loop(self) -> FloatArray:
        """L, (n, n)."""
        return np.asarray(self.F @ (np.eye(self.F.shape[0]) - self.gain @ self.C))

    def predict(self, y: FloatArray, start: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Return predictions x_{k|k−1} (N, n) and that after the last of readings y (N, m), (n,)."""
        driven = y @ (self.F @ self.gain).T
        x0 = np.zeros(self.F.shape[0]) if start is None else start
        x = _forward(np.ascontiguousarray(self.closed_loop.T), x0, np.ascontiguousarray(driven))
        return x[:-1], x[-1]

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
        x, after, r, first = self._passes(y, np.zeros(self.F.shape[0]) if start is None else start)
        kept = len(y) - ahead
        seen = x[:kept] @ wanted.T + r[:kept] @ (self.P @ wanted.T)
        if start is None:
            # what begins otherwise decays by L in the predictions, of which a long record corrects P Λ
            decay = _forward(
                np.ascontiguousarray(self.closed_loop.T), self.beginning(first), np.zeros_like(x)
            )
            seen += decay[:kept] @ (wanted.T - self.information @ (self.P @ wanted.T))
            x, after = x + decay[:-1], after + decay[-1]
        return seen, (after if ahead == 0 else x[kept])

    def beginning(self, first: FloatArray) -> FloatArray:
        """Return the state (n,) to begin with, from what the backward pass from rest leaves at the start.

        The state before anything is read is one of covariance P, which the gains at rest suppose, and one of
        the rest Δ of the stationary covariance; the record says of the latter Λ⁻¹r, so that it is
        Δ (I + Λ Δ)⁻¹ r.
        """
        rest = self.stationary - self.P
        return np.asarray(rest @ la.solve(np.eye(len(rest)) + self.information @ rest, first))

    def _passes(
        self, y: FloatArray, start: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return predictions, the one after the last sample, r_{k−1} (N, n), and r before the first (n,)."""
        x, after = self.predict(y, start)
        e = (y - x @ self.C.T) @ (self.precision @ self.C)
        r = _forward(np.ascontiguousarray(self.closed_loop), np.zeros(x.shape[1]), e[::-1].copy())[1:][::-1]
        return x, after, r, r[0]

    def draw(self, number: int, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return states (number, n) that the model makes of its own, and their readings (number, m)."""
        start, drive = (
            _root(matrix) @ rng.standard_normal((len(self.F), n))
            for matrix, n in ((self.stationary, 1), (self.Q, number - 1))
        )
        x = _forward(np.ascontiguousarray(self.F.T), start[:, 0], np.ascontiguousarray(drive.T))
        return x, x @ self.C.T + np.sqrt(self.R) * rng.standard_normal((number, self.R.size))

    def filtered(self, y: FloatArray) -> FloatArray:
        """Return states given the past and the present only, (N, n)."""
        x, _ = self.predict(y)
        return np.asarray(x + (y - x @ self.C.T) @ self.gain.T)


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
    scale = np.sqrt(np.maximum(np.diag(_stationary(F, Q)), 1e-300))
    f, q, c = F / scale[:, None] * scale, Q / np.outer(scale, scale), C * scale
    p, before = _riccati(f, q, c, R), _stationary(f, q)
    s = la.inv(c @ p @ c.T + np.diag(R))
    loop = f @ (np.eye(len(f)) - p @ c.T @ s @ c)
    known = _stationary(loop.T, c.T @ s @ c)
    size = np.outer(scale, scale)
    P, smoothed, stationary = (size * 0.5 * (m + m.T) for m in (p, p - p @ known @ p, before))
    return SteadySmoother(F, Q, C, R, P, smoothed, stationary, known / size)


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


def _root(covariance: FloatArray) -> FloatArray:
    """Return a matrix G (n, n) with G Gᵀ = covariance, which may be singular."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


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
def _forward(LT: FloatArray, x0: FloatArray, driven: FloatArray) -> FloatArray:
    """Return x_{k+1} = x_k LT + d_k from x_0, (N + 1, n)."""
    x = np.empty((driven.shape[0] + 1, x0.size))
    x[0] = x0
    for k in range(driven.shape[0]):
        x[k + 1] = np.dot(x[k], LT) + driven[k]
    return x
