"""Matrices of elements and nodes summed on the DOFs of a mesh."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.structure.mesh import Mesh


def of_elements(mesh: Mesh, matrices: FloatArray) -> sp.csc_array:
    """Return the sum of the elements' matrices (n_elements, 12, 12), on all DOFs of the mesh."""
    dofs = mesh.element_dofs()
    rows, columns = np.repeat(dofs, 12, axis=1).ravel(), np.tile(dofs, (1, 12)).ravel()
    return sp.coo_array((matrices.ravel(), (rows, columns)), shape=(mesh.n_dof, mesh.n_dof)).tocsc()


def of_blocks(mesh: Mesh, blocks: list[tuple[IntArray, FloatArray]]) -> sp.csc_array:
    """Return the sum of dense blocks, each on its own DOFs."""
    total = sp.dok_array((mesh.n_dof, mesh.n_dof))
    for dofs, block in blocks:
        for i, row in enumerate(dofs):
            for j, column in enumerate(dofs):
                total[row, column] += block[i, j]
    return total.tocsc()
