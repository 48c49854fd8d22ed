r"""Moment and curvature of an elastic, perfectly plastic tube, for piles whose steel yields.

A solid circle of radius R whose fibres yield at |y| > y_e = ε_y/κ carries

.. math:: M = \frac{f_y}{y_e} \int_{|y|<y_e} y^2 dA + f_y \int_{|y|>y_e} |y|\, dA

in closed form; a tube is the outer circle less the inner one. Axial force and hardening are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.soil.piles.piles import Pile

_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
"""Two points: exact for the straight curvature of a cubic element."""


@dataclass(frozen=True)
class YieldingTube:
    """Outer and inner diameter [m], Young's modulus and yield strength [Pa]."""

    D: float
    d: float
    E: float
    f_y: float

    @property
    def plastic_moment(self) -> float:
        """f_y (D³ − d³)/6 [N·m]."""
        return self.f_y * (self.D**3 - self.d**3) / 6.0

    @property
    def yield_curvature(self) -> float:
        """At which the outermost fibre yields, 2 f_y/(E D) [1/m]."""
        return 2.0 * self.f_y / (self.E * self.D)

    def moment(self, curvature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return moments [N·m] at curvatures [1/m], and their slopes [N·m²]."""
        kappa = np.maximum(np.abs(curvature), 1e-300)
        y_e = self.f_y / (self.E * kappa)
        core, plastic = (
            outer - inner
            for outer, inner in zip(_circle(0.5 * self.D, y_e), _circle(0.5 * self.d, y_e), strict=True)
        )
        M = self.E * kappa * core + self.f_y * plastic
        return np.sign(curvature) * M, self.E * core


def _circle(R: float, y_e: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ∫y² dA within ±y_e [m⁴] and ∫|y| dA beyond [m³] of a circle."""
    if R <= 0.0:
        return np.zeros_like(y_e), np.zeros_like(y_e)
    u = np.minimum(y_e / R, 1.0)
    root = np.sqrt(1.0 - u**2)
    core = 0.5 * R**4 * (np.arcsin(u) - u * (1.0 - 2.0 * u**2) * root)
    return core, 4.0 / 3.0 * R**3 * root**3


class PlasticSteel:
    """Difference between the elastic forces of a pile bent in its x–z plane and those of yielding steel."""

    def __init__(self, pile: Pile, node_depth: FloatArray, yield_strength_pa: float) -> None:
        self.tube = YieldingTube(
            pile.outer_diameter_m, pile.inner_diameter_m, pile.youngs_modulus_pa, yield_strength_pa
        )
        self.EI = self.tube.E * np.pi / 64.0 * (self.tube.D**4 - self.tube.d**4)
        L = np.diff(node_depth)
        n = node_depth.size
        # slope dx/dz downwards is −θ_y: curvature of the four DOFs x₁, θ₁, x₂, θ₂
        points = [
            np.stack([6.0 * s / L**2, -(3.0 * s - 1.0) / L, -6.0 * s / L**2, -(3.0 * s + 1.0) / L], axis=1)
            for s in _GAUSS
        ]
        self.B, self.weight = np.stack(points), 0.5 * L
        first = 6 * np.arange(n - 1)
        self.dofs = np.stack([first, first + 4, first + 6, first + 10], axis=1)
        self.size = 6 * n

    def curvature(self, u: FloatArray) -> FloatArray:
        """Return curvatures (2, n_elements) [1/m] of displacements (n, 6)."""
        return np.asarray(np.einsum("gej,ej->ge", self.B, u.ravel()[self.dofs]))

    def lost(self, u: FloatArray) -> tuple[FloatArray, sp.csc_array]:
        """Return by how much elastic forces (n, 6) and tangent (6n, 6n) exceed those of yielding steel."""
        kappa = self.curvature(u)
        M, slope = self.tube.moment(kappa)
        force = np.zeros(self.size)
        np.add.at(force, self.dofs, np.einsum("gej,ge->ej", self.B, (self.EI * kappa - M) * self.weight))
        blocks = np.einsum("gei,gej,ge->eij", self.B, self.B, (self.EI - slope) * self.weight)
        rows = np.broadcast_to(self.dofs[:, :, None], blocks.shape).ravel()
        columns = np.broadcast_to(self.dofs[:, None, :], blocks.shape).ravel()
        tangent = sp.csc_array((blocks.ravel(), (rows, columns)), shape=(self.size, self.size))
        return force.reshape(-1, 6), tangent
