"""Modes of a structure on springs of many stiffnesses, from shapes of a similar structure."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import NumericalError
from jackettwin.structure import definite_factor


class OnSprings:
    r"""A structure whose springs alone vary, in a basis that holds two steps of inverse iteration.

    With :math:`K_0` on springs of mean stiffness and :math:`E` the DOFs of those that vary,

    .. math:: K^{-1} b = K_0^{-1} b - K_0^{-1} E\,(\dots)

    so that :math:`X, A = K_0^{-1}E, K_0^{-1}M[X, A]` and :math:`(K_0^{-1}M)^2 X` contain one step from shapes
    X on springs of *any* stiffness, and two of all but what the springs' own change does in the second. One
    factor serves all stiffnesses, whose modes are then those of a small dense problem.

    Parameters
    ----------
    K, M : (n, n) sparse, without springs
    dofs : (n_springs,) on which a spring acts
    springs : (n_cases, n_springs) stiffness of each [N/m], the cases to which modes will be computed
    near : (n, k) shapes of a similar structure

    Raises
    ------
    NumericalError
        If the structure is not stable, or a vector of the basis has no mass.
    """

    def __init__(self, K: Any, M: Any, dofs: IntArray, springs: FloatArray, near: FloatArray) -> None:
        n = K.shape[0]
        self.mass, self.dofs = M, dofs
        self.mean = np.exp(np.log(springs).mean(axis=0))
        self.stiffness = sp.csc_array(K + sp.csc_array((self.mean, (dofs, dofs)), shape=(n, n)))
        self._factor = definite_factor(self.stiffness)
        varied = dofs[np.ptp(springs, axis=0) > 0.0]
        unit = np.zeros((n, varied.size))
        unit[varied, np.arange(varied.size)] = 1.0
        start = np.hstack([near, self._factor.solve(unit)])
        once = self._factor.solve(M @ start)
        twice = self._factor.solve(M @ once[:, : near.shape[1]])
        columns = np.hstack([start, once, twice])
        self.basis = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0]
        self._small = self.basis.T @ (self.stiffness @ self.basis), self.basis.T @ (M @ self.basis)

    def modes(self, springs: FloatArray, number: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest ω [rad/s], ascending, and mass-normalised shapes (n, number) on springs.

        Raises
        ------
        NumericalError
            If the structure is not stable.
        """
        K, M = self._small
        at = self.basis[self.dofs]
        last, number = len(M) - 1, min(number, len(M))
        try:
            # M x = μ K x: of many masses some may be zero
            mu, q = la.eigh(
                M, K + at.T @ ((springs - self.mean)[:, None] * at), subset_by_index=[last + 1 - number, last]
            )
        except la.LinAlgError as error:
            raise NumericalError(f"the structure is not stable: {error}") from error
        if mu[0] <= 0.0:
            raise NumericalError("a vector of the basis has no mass")
        return mu[::-1] ** -0.5, self.basis @ (q / np.sqrt(mu))[:, ::-1]

    def error(self, springs: FloatArray, omega: FloatArray, shapes: FloatArray) -> FloatArray:
        r"""Return the relative errors of ω² that residuals tell, (n_modes,).

        With :math:`r = Kx - ω²Mx` it is :math:`r^T K_0^{-1} r/ω²`: of what x has of a mode at :math:`ω_j`,
        :math:`1 - ω²/ω_j²` times the error of ω², which is the square of that of the shape.
        """
        residual = self.stiffness @ shapes - (self.mass @ shapes) * omega**2
        residual[self.dofs] += (springs - self.mean)[:, None] * shapes[self.dofs]
        return np.asarray(np.einsum("im,im->m", residual, self._factor.solve(residual)) / omega**2)
