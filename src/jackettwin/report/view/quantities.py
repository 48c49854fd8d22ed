"""Quantities by which a view colours elements: dimensions, material, mass, dissipation of a mode."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.report.view.page import ColouredQuantity, diameters
from jackettwin.response import DampedModes, System
from jackettwin.structure import Assembly, beam

_LIVELY = 0.3
"""Damping ratio above which poles are motions of the supports, which are not shown."""


def thickness_quantities(assembly: Assembly) -> tuple[ColouredQuantity, ...]:
    """Return wall thickness, diameter and slenderness of every element."""
    p = assembly.mesh.properties
    D = diameters(assembly)
    bore = np.sqrt(np.maximum(D**2 - 4.0 * p.A / np.pi, 0.0))
    t = 0.5 * (D - bore)
    return (
        ColouredQuantity("wall thickness", "mm", 1e3 * t, log=True),
        ColouredQuantity("outer diameter", "m", D, log=True),
        ColouredQuantity("diameter over wall", "–", D / t),
    )


def material_quantities(assembly: Assembly) -> tuple[ColouredQuantity, ...]:
    """Return Young's modulus, density, and mass per metre of every element."""
    p = assembly.mesh.properties
    return (
        ColouredQuantity("Young's modulus", "GPa", p.E / 1e9),
        ColouredQuantity("density", "kg/m³", p.rho),
        ColouredQuantity("mass per metre", "t/m", p.rho * p.A / 1e3, from_zero=True),
    )


def damping_quantity(system: System, modes: DampedModes) -> ColouredQuantity | None:
    """Return the share of each element in the dissipation of the first mode; None without dissipation."""
    lively = np.flatnonzero(modes.damping_ratio < _LIVELY)
    if lively.size == 0:
        return None
    pole, shape = complex(modes.eigenvalues[lively[0]]), modes.shapes[:, lively[0]]
    power = dissipation(system, pole, shape)
    total = float(power.sum())
    if not total > 0.0:
        return None
    return ColouredQuantity(
        "damping: share of the first mode",
        "%/m",
        100.0 * power / total / system.assembly.mesh.properties.L,
        from_zero=True,
    )


def dissipation(system: System, pole: complex, shape: ComplexArray) -> FloatArray:
    """Return each element's part of xᴴ C(λ) x of a mode, (n_elements,), whose sum is 2ζ|λ| xᴴMx.

    An element has its part of the steel's Rayleigh damping αM + βK, without the part αM of bodies. The
    dissipation of springs and dashpots at a node is divided among the elements that meet there.

    Parameters
    ----------
    pole : λ [rad/s]
    shape : (assembly.n_dof,)
    """
    mesh = system.assembly.mesh
    u = np.asarray(system.assembly.expand @ shape)
    met = np.bincount(np.concatenate([mesh.start, mesh.end]), minlength=len(mesh.node_names))
    place = {node: k for k, node in enumerate(mesh.node_names)}
    at_node = np.zeros(len(mesh.node_names))
    for spring in system.support.springs:
        moved = u[mesh.node_dofs(spring.node)]
        loss = complex(spring.law.stiffness(pole)).imag / pole.imag
        at_node[place[spring.node]] += loss * float((moved.conj() @ spring.matrix @ moved).real)
    share = at_node / np.maximum(met, 1)
    return np.asarray(_of_steel(system, u) + share[mesh.start] + share[mesh.end])


def _of_steel(system: System, u: ComplexArray) -> FloatArray:
    """Return uᴴ(αM + βK)u of every element for motions u of the mesh's DOFs."""
    mesh, rayleigh = system.assembly.mesh, system.pencil.rayleigh
    ends = u[mesh.element_dofs()].reshape(-1, 4, 3)
    local = np.einsum("eij,ekj->eki", mesh.axes, ends).reshape(-1, 12)
    C = rayleigh.alpha * beam.mass(mesh.properties) + rayleigh.beta * beam.stiffness(mesh.properties)
    return np.asarray(np.einsum("ei,eij,ej->e", local.conj(), C, local).real)
