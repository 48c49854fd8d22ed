r"""Surrogate of a problem near one point, with poles linear in the supports' complex stiffness.

A pole depends on a law only through its complex stiffness D at the pole. It is nearly linear in D even if D
is strongly non-linear in the law's parameters. With the modes known at one point z₀,

.. math:: r(z) ≈ r_0 + \sum_{m, g} \frac{∂r}{∂D_g(λ_m)} \left[D_g(λ_m; z) - D_g(λ_m; z_0)\right]
          + \sum_j \frac{∂r}{∂θ_j} (θ_j - θ_{j,0}) + R (z - z_0),

with θ_j the parameters of no law (dashpots, mass of water) and R the remaining derivatives, of shapes and
relaxations. At z₀ residuals and Jacobian equal those of the problem. Curved valleys of laws with several
branches are thus followed without evaluating the structure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response import NumberedModes
from jackettwin.updating.model import SupportModel
from jackettwin.updating.problem import Found, Problem, State

Rows = tuple[FloatArray, FloatArray]
"""Residuals (n,) and their Jacobian (n, d)."""


@dataclass(frozen=True, eq=False)
class _StatePart:
    """Contribution of one state's laws and other parameters to the residuals of all states.

    Attributes
    ----------
    model : SupportModel
    state : State
    poles : (n_modes,) poles at which the laws are evaluated
    laws : (n_data, 2 n_groups n_modes) derivatives of the residuals by Re D, then Im D
    others : (n_data, n_others) derivatives by the logarithms of the parameters of no law
    """

    model: SupportModel
    state: State
    poles: ComplexArray
    laws: FloatArray
    others: FloatArray

    def __call__(self, z: FloatArray) -> Rows:
        """Return this part of the residuals (n_data,), up to a constant, and its derivatives by z."""
        weights = self.state.weights
        theta = np.exp(weights @ z + self.state.shifts)
        D, dD = self.model.law_response(theta, self.poles)
        n = dD.shape[1]
        slopes = np.concatenate([dD.real, dD.imag])
        r = self.laws @ np.concatenate([D.real, D.imag]) + self.others @ theta[n:]
        J = (self.laws @ slopes) @ weights[:n] + (self.others * theta[n:]) @ weights[n:]
        return r, J


class Surrogate:
    """Residuals and Jacobian of a problem near a point whose modes are known.

    Parameters
    ----------
    z : (d,) the point
    rows : residuals and Jacobian of ``problem.evaluate`` at the point
    found : modes at the point
    """

    def __init__(self, problem: Problem, z: FloatArray, rows: Rows, found: Found) -> None:
        n = problem.n_data
        ends = np.cumsum([len(state.names) for state in problem.states])[:-1]
        roots = np.split(problem.whitening(found), ends, axis=1)
        self.problem, self.centre = problem, z
        self.parts = [
            _state_part(problem, z, state, modes, root)
            for state, modes, root in zip(problem.states, found, roots, strict=True)
        ]
        known = [part(z) for part in self.parts]
        self.constant = rows[0][:n] - sum(r for r, _ in known)
        self.rest = rows[1][:n] - sum(J for _, J in known)

    def __call__(self, z: FloatArray) -> Rows:
        """Return residuals and Jacobian at a point."""
        r, J = self.constant + self.rest @ (z - self.centre), self.rest
        for part in self.parts:
            own = part(z)
            r, J = r + own[0], J + own[1]
        if self.problem.relative:
            return r, J
        prior = self.problem.prior.rows(z)
        return np.concatenate([r, prior[0]]), np.concatenate([J, prior[1]])


def _state_part(
    problem: Problem, z: FloatArray, state: State, modes: NumberedModes, root: FloatArray
) -> _StatePart:
    poles, slopes, theta = modes.poles[0], modes.slopes[0], problem.vectors(z[None], state)[0]
    _, dD = problem.model.law_response(theta, poles)
    n_laws = dD.shape[1]
    dD = dD.reshape(-1, poles.size, n_laws)
    # dλ/dz = (∂λ/∂D) dD/dz: ∂λ/∂D follows from any parameter of this law only; the one with most effect
    # is used
    touched = (dD != 0.0).any(axis=1)
    alone = np.where((touched & (touched.sum(axis=0) == 1))[:, None], dD, 0.0)
    best = np.abs(alone).argmax(axis=2)[..., None]
    moved, by = (
        np.take_along_axis(alone, best, axis=2),
        np.take_along_axis(slopes[None, :, :n_laws], best, axis=2),
    )
    by_D = np.divide(by, moved, out=np.zeros_like(moved), where=moved != 0.0)
    each = (by_D * np.eye(poles.size)).transpose(1, 0, 2).reshape(poles.size, -1)
    columns = np.concatenate([each, 1j * each, slopes[:, n_laws:] / theta[n_laws:]], axis=1)
    own = root[:, : state.residuals.count] @ state.residuals.jacobian(poles, columns)
    return _StatePart(problem.model, state, poles, *np.split(own, [2 * each.shape[1]], axis=1))
