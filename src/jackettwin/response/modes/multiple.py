"""Modes of equal frequency: symmetric structures have pairs, whose linear combinations are modes too.

Which combinations a solver returns depends on rounding. They are rotated here to the global axes, or to those
of a nacelle with a given heading, so that the first of a pair is along x (fore-aft), independently of mesh
and solver.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg as la

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.structure import Assembly

INSEPARABLE = 1e-5
"""Relative difference below which frequencies are equal: coordinates rounded to the millimetre and rounding
errors cause smaller differences, and no measurement resolves them."""
_ELSEWHERE = 1e-6
"""Weight of the motion of all other nodes relative to that of the axis; it matters only where the axis does
not move."""


def axis_levels(assembly: Assembly) -> FloatArray:
    """Return the matrix (n_levels, n_nodes) that averages the nodes of the structure's axis at each height.

    The axis consists of the nodes on the vertical through the highest one; without a tower, of the mean of
    the interface nodes.
    """
    mesh, structure = assembly.mesh, assembly.structure
    x, y, _ = structure.nodes[structure.top_node]
    size = max(1.0, float(np.ptp(mesh.coordinates[:, 2])))
    every: FloatArray = np.eye(len(mesh.coordinates))
    axis = np.flatnonzero((np.abs(mesh.coordinates[:, :2] - [x, y]) < 1e-6 * size).all(axis=1))
    if axis.size > 1 or not structure.interface_nodes:
        return every[axis]
    interface = [mesh.node_names.index(name) for name in structure.interface_nodes]
    mean: FloatArray = every[interface].mean(axis=0, keepdims=True)
    return mean


def inseparable(values: npt.NDArray[Any]) -> list[IntArray]:
    """Return groups of two or more neighbours in the list whose relative differences are below a limit."""
    if values.size < 2:
        return []
    cuts = np.flatnonzero(~(np.abs(np.diff(values)) <= INSEPARABLE * np.abs(values[1:]))) + 1
    return [group for group in np.split(np.arange(values.size), cuts) if group.size > 1]


def seen_from(heading_rad: float, motion: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return motion along the axes of a nacelle of this heading, anticlockwise from x seen from above.

    Parameters
    ----------
    motion : (n_points, 2 or more, n_modes) components along the global x and y, and further ones, not changed
    """
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    turned = motion.copy()
    turned[:, 0] = c * motion[:, 0] + s * motion[:, 1]
    turned[:, 1] = c * motion[:, 1] - s * motion[:, 0]
    return turned


def aligned(
    assembly: Assembly, values: npt.NDArray[Any], shapes: npt.NDArray[Any], *, heading_rad: float = 0.0
) -> npt.NDArray[Any]:
    """Return the shapes, with those of equal values rotated to the axes, the one along x first.

    Parameters
    ----------
    values : (n_modes,) natural frequencies or poles, sorted
    shapes : (assembly.n_dof, n_modes)
    heading_rad : heading of the nacelle that defines the axes; zero for the global ones
    """
    groups = inseparable(values)
    if not groups:
        return shapes
    turned, levels = shapes.copy(), axis_levels(assembly)
    for group in groups:
        x = shapes[:, group]
        gram = x.conj().T @ (assembly.mass @ x)
        turned[:, group] = x @ turning(assembly, levels, x, gram, heading_rad=heading_rad)
    return turned


def aligned_coordinates(
    assembly: Assembly, basis: FloatArray, omega: FloatArray, x: FloatArray
) -> FloatArray:
    """Return mass-normalised modes in coordinates of a basis, rotated as by :func:`aligned`.

    Parameters
    ----------
    basis : (assembly.n_dof, n)
    omega : (n_modes,) ascending
    x : (n, n_modes)
    """
    groups = inseparable(omega)
    if not groups:
        return x
    turned, levels = x.copy(), axis_levels(assembly)
    for group in groups:
        mixtures = turning(assembly, levels, basis @ x[:, group], np.eye(group.size))
        turned[:, group] = x[:, group] @ mixtures
    return turned


def turning(
    assembly: Assembly,
    levels: FloatArray,
    shapes: npt.NDArray[Any],
    gram: npt.NDArray[Any],
    *,
    heading_rad: float = 0.0,
) -> npt.NDArray[Any]:
    """Return the combinations (n_modes, n_modes) of shapes that separate motion along x and y, along x first.

    They are the extremes of the difference between the energy of motion along x and along y at equal kinetic
    energy, scaled to the mean norm of the shapes.

    Parameters
    ----------
    shapes : (assembly.n_dof, n_modes)
    gram : (n_modes, n_modes) products xᴴMx
    """
    u = (assembly.expand @ shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
    motion = np.concatenate([np.tensordot(levels, u[:, :2], 1), np.sqrt(_ELSEWHERE) * u[:, :2]])
    motion = seen_from(heading_rad, motion)
    along_x, along_y = (part.conj().T @ part for part in (motion[:, 0], motion[:, 1]))
    difference, gram = (0.5 * (part + part.conj().T) for part in (along_x - along_y, gram))
    _, mixtures = la.eigh(difference, gram)
    return np.asarray(mixtures[:, ::-1] * np.sqrt(np.trace(gram).real / len(gram)))
