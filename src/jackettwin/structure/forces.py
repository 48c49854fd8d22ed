"""Section forces of every element from the displacements of its ends, and the stress in a tube."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.structure import beam
from jackettwin.structure.assemble import Assembly


class SectionForces(NamedTuple):
    """Forces at both ends of every element, each (..., n_elements, 2), in the element's local axes.

    Tension positive [N]; shear [N], torsion and bending [N·m] act on the face whose outward normal is x.
    """

    axial: FloatArray
    shear_y: FloatArray
    shear_z: FloatArray
    torsion: FloatArray
    bending_y: FloatArray
    bending_z: FloatArray

    @property
    def bending(self) -> FloatArray:
        """Resultant bending moment [N·m]."""
        return np.hypot(self.bending_y, self.bending_z)

    @property
    def shear(self) -> FloatArray:
        """Resultant shear force [N]."""
        return np.hypot(self.shear_y, self.shear_z)


def section_forces(
    assembly: Assembly, displacement: FloatArray, *, along: FloatArray | None = None
) -> SectionForces:
    """Return section forces k u − f from displacements of the assembly's DOFs (..., n_dof) [m, rad].

    Parameters
    ----------
    along : (..., n_elements, 12), optional
        Loads spread along the elements (weight, water) as loads f on their ends in local axes: minus the
        end forces of an element whose ends are fixed. Without them such loads act at the nodes alone.

    Geometric stiffness is not included.
    """
    mesh = assembly.mesh
    leading = displacement.shape[:-1]
    nodal = (assembly.expand @ displacement.reshape(-1, assembly.n_dof).T).T
    ends = np.asarray(nodal)[:, mesh.element_dofs()].reshape(len(nodal), mesh.start.size, 4, 3)
    local = np.einsum("eij,tekj->teki", mesh.axes, ends).reshape(len(nodal), mesh.start.size, 12)
    force = np.einsum("eij,tej->tei", beam.stiffness(mesh.properties), local)
    if along is not None:
        # loads that rest are one for all displacements
        force = force - along.reshape(int(np.prod(along.shape[:-2])), mesh.start.size, 12)
    force = force.reshape(*leading, mesh.start.size, 2, 6) * np.array([[-1.0], [1.0]])
    return SectionForces(*np.moveaxis(force, -1, 0))


def element_weight(assembly: Assembly) -> FloatArray:
    """Return the elements' own weight as loads on their ends, (n_elements, 12) [N, N·m], local axes."""
    mesh = assembly.mesh
    down = -GRAVITY_M_S2 * mesh.axes[:, :, 2]
    nothing = np.zeros_like(down)
    lifted = np.hstack([down, nothing, down, nothing])
    return np.asarray(np.einsum("eij,ej->ei", beam.mass(mesh.properties), lifted))


def tube_radius(p: beam.BeamProperties) -> FloatArray:
    """Return the outer radii [m] of tubes, from R² + r² = 4I/A and R² − r² = A/π."""
    return np.asarray(0.5 * np.sqrt(2.0 * (p.A / np.pi + 4.0 * p.I / p.A)))


def von_mises_stress(assembly: Assembly, forces: SectionForces) -> FloatArray:
    """Return the largest von Mises stress [Pa] at both ends of every element, (..., n_elements, 2).

    Thin tubes: σ = |N|/A + M/W on the outer fibre, τ = |T|R/J + 2V/A, both taken at one point, on the safe
    side: √(σ² + 3τ²).
    """
    p = assembly.mesh.properties
    R = tube_radius(p)[:, None]
    A, W, J = p.A[:, None], p.I[:, None] / R, p.J[:, None]
    sigma = np.abs(forces.axial) / A + forces.bending / W
    tau = np.abs(forces.torsion) * R / J + 2.0 * forces.shear / A
    return np.asarray(np.sqrt(sigma**2 + 3.0 * tau**2))
