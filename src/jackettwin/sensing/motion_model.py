r"""State-space model of a structure's modes driven by latent forces, with which a record is smoothed.

.. math:: \ddot q + C \dot q + Ω^2 q = Φ^T S f, \qquad u = Φ q + R f, \quad
          R = (K^{-1} - Φ Ω^{-2} Φ^T) S

The modes stand on the updated supports. R is how the structure yields to a pattern beyond the modes kept, so
that no static part is lost, braces under waves included. Damping is that of the supports' laws at each pair
of modes, :math:`C_{ij} = φ_i^T\,\mathrm{Im} F(iω_{ij})\,φ_j/ω_{ij}`, :math:`ω_{ij}^2 = ω_i ω_j`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import require
from jackettwin.response import System, UndampedModes, static_displacement, undamped_modes
from jackettwin.sensing.latent_forces import LatentForce, LocalWaves
from jackettwin.structure import Assembly

_FIRST_GUESS = 20


@dataclass(frozen=True)
class MotionModel:
    """Modes and forces of a structure.

    Attributes
    ----------
    assembly : Assembly
    omega : (n_modes,) undamped [rad/s]
    shapes : (n_dof, n_modes) mass-normalised
    damping : (n_modes, n_modes) [rad/s]
    forces : tuple of LatentForce
    flexibility : (n_dof, n_forces) displacement per unit of each force beyond the modes
    computed : all modes that were computed, from which those of a similar structure are found soon
    local : what bends members and moves no sensor
    bent : (n_dof, n) displacement under each pattern of each of ``local``
    """

    assembly: Assembly
    omega: FloatArray
    shapes: FloatArray
    damping: FloatArray
    forces: tuple[LatentForce, ...]
    flexibility: FloatArray
    computed: UndampedModes
    local: tuple[LocalWaves, ...] = ()
    bent: tuple[FloatArray, ...] = ()

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return int(self.omega.size)

    @property
    def modal_loads(self) -> FloatArray:
        """Loads on the modes per unit of each force, (n_modes, n_forces)."""
        return np.asarray(self.shapes.T @ np.column_stack([force.load for force in self.forces]))

    def with_ratios(self, ratios: FloatArray) -> MotionModel:
        """Return the model with damping ratios (n_modes,) of its modes; NaN leaves a mode its own."""
        own = np.diag(self.damping) / (2.0 * self.omega)
        kept = np.where(np.isnan(ratios), own, ratios)
        known = ~np.isnan(ratios)
        damping = np.where(known[:, None] | known, 0.0, self.damping)
        np.fill_diagonal(damping, 2.0 * kept * self.omega)
        return replace(self, damping=damping)

    def at_top(self, heading_rad: float) -> FloatArray:
        """Return how the modes move the tower top towards a heading, (n_modes,)."""
        x, y = self.shapes[self.assembly.dofs(self.assembly.structure.top_node)[:2]]
        return np.asarray(np.cos(heading_rad) * x + np.sin(heading_rad) * y)

    def with_dashpot(self, ratio: float, heading_rad: float) -> MotionModel:
        """Return the model with a dashpot at the tower top, of this damping ratio in the first pair."""
        moved = self.at_top(heading_rad)
        most = int(np.abs(moved[:2]).argmax())
        c = 2.0 * ratio * self.omega[most] / moved[most] ** 2
        return replace(self, damping=self.damping + c * np.outer(moved, moved))

    def with_damping_at_top(self, damping: FloatArray, least_ratio: float) -> MotionModel:
        """Return the model with damping (6, 6) at the tower top; no motion is damped by less than a ratio.

        A rotor's damping of one of six motions may be negative, what is left of the structure's own is not.
        """
        top = self.shapes[self.assembly.dofs(self.assembly.structure.top_node)]
        values, vectors = np.linalg.eigh(self.damping + top.T @ damping @ top)
        least = 2.0 * least_ratio * float(self.omega[0])
        return replace(self, damping=(vectors * np.maximum(values, least)) @ vectors.T)

    def dashpot(self, heading_rad: float) -> float:
        """Return the dashpot at the tower top [N·s/m] that damps the first pair towards a heading so much."""
        moved = self.at_top(heading_rad)
        most = int(np.abs(moved[:2]).argmax())
        return float(self.damping[most, most] / moved[most] ** 2)

    def with_damping_beyond(self, first: int, factor: float) -> MotionModel:
        """Return the model with another damping of all modes but the first ones."""
        root = np.where(np.arange(self.n_modes) < first, 1.0, np.sqrt(factor))
        return replace(self, damping=root[:, None] * self.damping * root)

    def with_forces(self, forces: tuple[LatentForce, ...]) -> MotionModel:
        """Return the model with the same patterns at other levels and rates."""
        return replace(self, forces=forces)

    def dynamics(self) -> tuple[FloatArray, FloatArray]:
        """Return A (n, n) and the noise's density (n, n) of the state: modes, their velocities, forces."""
        m, loads = self.n_modes, self.modal_loads
        own = [force.dynamics() for force in self.forces]
        n = 2 * m + sum(h.size for _, _, h in own)
        A, Q = np.zeros((n, n)), np.zeros((n, n))
        A[:m, m : 2 * m] = np.eye(m)
        A[m : 2 * m, :m], A[m : 2 * m, m : 2 * m] = -np.diag(self.omega**2), -self.damping
        at = 2 * m
        for j, (a, q, h) in enumerate(own):
            here = slice(at, at + h.size)
            A[here, here], Q[here, here] = a, q
            A[m : 2 * m, here] = np.outer(loads[:, j], h)
            at += h.size
        return A, Q

    def force_rows(self) -> FloatArray:
        """Return the forces from the state, (n_forces, n)."""
        return la.block_diag(np.zeros((0, 2 * self.n_modes)), *(force.dynamics()[2] for force in self.forces))

    def local_forces(self) -> tuple[LatentForce, ...]:
        """Return the processes that local waves follow, at their levels."""
        named = {force.name: force for force in self.forces}
        return tuple(waves.force(named) for waves in self.local)

    def displacement_rows(self, rows: FloatArray) -> FloatArray:
        """Return what ``rows`` (k, n_dof) see of the displacement from the state, (k, n)."""
        m = self.n_modes
        seen = (rows @ self.flexibility) @ self.force_rows()
        seen[:, :m] += rows @ self.shapes
        return np.asarray(seen)

    def motion_rows(self, rows: FloatArray, tilt: FloatArray, derivative: tuple[int, ...]) -> FloatArray:
        """Return what sensors read from the state, (k, n).

        Of velocity and acceleration the part beyond the modes is left out: it is small, as it is slow.

        Parameters
        ----------
        rows : (k, n_dof) what each sees of the displacement, or of its derivative
        tilt : (k, n_dof) what it sees of the displacement beside
        derivative : (k,) of the displacement: 0, 1 or 2
        """
        m, A = self.n_modes, self.dynamics()[0]
        shift = {1: np.eye(m, A.shape[0], m), 2: A[m : 2 * m]}
        at = np.array(derivative)
        seen = self.displacement_rows(np.where((at == 0)[:, None], rows, 0.0) + tilt)
        for k, by in shift.items():
            seen += np.where((at == k)[:, None], rows, 0.0) @ self.shapes @ by
        return np.asarray(seen)

    def transfer(
        self, rows: FloatArray, tilt: FloatArray, derivative: tuple[int, ...], omega: FloatArray
    ) -> ComplexArray:
        """Return what sensors read of each unit force in frequency, (n_omega, k, n_forces)."""
        s = 1j * omega[:, None, None]
        F = s**2 * np.eye(self.n_modes) + s * self.damping + np.diag(self.omega**2)
        modal = np.linalg.solve(F, np.broadcast_to(self.modal_loads, (omega.size, *self.modal_loads.shape)))
        at = np.array(derivative)[:, None]
        still = np.where(at == 0, rows, 0.0) + tilt
        moving = s**at * np.where(at == 0, 0.0, rows @ self.shapes)
        return np.asarray(still @ self.shapes @ modal + still @ self.flexibility + moving @ modal)


def motion_model(
    system: System,
    forces: tuple[LatentForce, ...],
    *,
    below_hz: float,
    drag: sp.csr_array | None = None,
    near: UndampedModes | None = None,
    local: tuple[LocalWaves, ...] = (),
) -> MotionModel:
    """Return the modes of a supported structure below a frequency, and what forces do to it.

    Parameters
    ----------
    drag : (n_dof, n_dof) damping of the water besides that of supports and steel
    near : modes of a similar structure
    local : what bends members and moves no sensor

    Raises
    ------
    InputError
        If no mode lies below the frequency, or the structure cannot stand.
    """
    number = _FIRST_GUESS if near is None else near.omega.size
    modes = undamped_modes(system, number, near=near)
    while modes.frequency_hz[-1] < below_hz and modes.omega.size == number < system.free.size:
        number *= 2
        modes = undamped_modes(system, number)
    keep = (modes.frequency_hz < below_hz) & (np.arange(modes.omega.size) >= modes.n_at_rest)
    require(
        keep.any(),
        "no mode lies below this frequency",
        field="below_hz",
        value=below_hz,
        allowed=f"> {modes.frequency_hz[modes.n_at_rest :].min(initial=np.inf):.3g} Hz",
    )
    omega, shapes = modes.omega[keep], modes.shapes[:, keep]
    loads = np.column_stack([force.load for force in forces])
    still = static_displacement(system, np.hstack([loads, *(waves.load for waves in local)]))
    yielded, *bent = np.split(still, np.cumsum([len(forces), *(w.load.shape[1] for w in local)])[:-1], axis=1)
    flexibility = yielded - shapes @ ((shapes.T @ loads) / omega[:, None] ** 2)
    damping = _damping(system, omega, shapes)
    if drag is not None:
        damping = damping + shapes.T @ (drag @ shapes)
    return MotionModel(
        system.assembly, omega, shapes, damping, forces, flexibility, modes, local, tuple(bent)
    )


def _damping(system: System, omega: FloatArray, shapes: FloatArray) -> FloatArray:
    """Return the damping between modes, that of the laws at the geometric mean of their frequencies."""
    pencil, x = system.pencil, shapes[system.free]
    C = pencil.rayleigh.alpha * np.eye(omega.size) + pencil.rayleigh.beta * (x.T @ (pencil.K @ x))
    between = np.sqrt(np.outer(omega, omega))
    for group in pencil.groups:
        S = x.T @ (group.S @ x)
        C += group.law.stiffness(1j * between).imag / between * S
    return np.asarray(0.5 * (C + C.T))
