"""Static displacement of a supported structure under a constant load."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError, did_you_mean
from jackettwin.response.state import factorised
from jackettwin.response.system import System
from jackettwin.structure import Assembly, rigid_body_motion


def static_displacement(system: System, load: FloatArray) -> FloatArray:
    """Return displacements under loads (assembly.n_dof, ...) on the assembly's DOFs, supports relaxed.

    Raises
    ------
    InputError
        If the structure cannot stand on its support.
    """
    K = sp.csc_array(system.pencil.static_stiffness())
    try:
        u = factorised(K).solve(np.asarray(load)[system.free])
    except RuntimeError:
        u = np.full((system.free.size, *np.shape(load)[1:]), np.nan)
    if not np.isfinite(u).all() or np.abs(u).max(initial=0.0) > 1e6:
        raise InputError(
            "the structure cannot stand on its support", field="support", remedy="fix it in every direction"
        )
    return np.asarray(system.expand(u))


def beyond_basis(system: System, basis: FloatArray, loads: FloatArray) -> FloatArray:
    """Return static displacements under loads (assembly.n_dof, k) beyond those in the coordinates of a basis.

    What a reduced model leaves out of a slow load: K⁻¹f − T (TᵀKT)⁻¹ Tᵀf, with T = ``basis`` (n_dof, n).
    """
    T = basis[system.free]
    own = T.T @ (system.pencil.static_stiffness() @ T)
    return static_displacement(system, loads) - basis @ np.linalg.solve(own, basis.T @ loads)


def self_weight(assembly: Assembly) -> FloatArray:
    """Return the weight of everything that has mass, (assembly.n_dof,) [N, N·m]."""
    return np.asarray(-GRAVITY_M_S2 * (assembly.mass @ rigid_body_motion(assembly)[:, 2]))


def nodal_load(assembly: Assembly, forces: Mapping[str, tuple[float, ...]]) -> FloatArray:
    """Return forces and moments on nodes, (assembly.n_dof,); those on a follower node act on its leader.

    Parameters
    ----------
    forces : {node: (Fx, Fy, Fz) or (Fx, Fy, Fz, Mx, My, Mz)} [N, N·m]

    Raises
    ------
    InputError
        If a node does not exist, or has not 3 or 6 components.
    """
    total = np.zeros(assembly.n_dof)
    for node, components in forces.items():
        if node not in assembly.structure.nodes:
            raise InputError(
                "no such node",
                field="force",
                value=node,
                allowed="a node of the structure",
                remedy=did_you_mean(node, assembly.structure.nodes) or "`view` lists all nodes",
            )
        if len(components) not in (3, DOFS_PER_NODE):
            raise InputError("give 3 or 6 components", field=f"force.{node}", value=components)
        rows = assembly.expand[assembly.mesh.node_dofs(node)[: len(components)]]
        total += rows.T @ np.array(components)
    return total
