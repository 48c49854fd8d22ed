"""Say which mode is which: fore-aft, side-side, torsion, heave, or local."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.structure.assemble import Assembly

KINDS = ("fore_aft", "side_side", "heave", "torsion")
LOCAL = "local"
"""Braces swing, the structure's axis rests: no sensor on the tower sees such a mode."""
_TORSION_RADIUS_M = 10.0
"""A yaw rotation counts as the sway it causes this far from the axis: about a jacket top's half width."""
_LOCAL_SHARE = 0.1
"""An axis that moves less than this share of the largest motion rests: local modes stay below 0.04 (braces of
two jackets) and 0.08 (panels), their global ones above 0.8."""


def mode_kinds(assembly: Assembly, shapes: npt.NDArray[Any]) -> tuple[str, ...]:
    """Return the kind of each mode by how the structure's axis moves, level by level.

    The axis is the nodes above and below the highest one; without a tower, the mean of the interface nodes.

    Parameters
    ----------
    shapes : (assembly.n_dof, n_modes)
    """
    u = (assembly.expand @ shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
    axis = np.abs(np.tensordot(_levels(assembly), u, 1)[:, [0, 1, 2, 5]])
    axis *= np.array([1.0, 1.0, 1.0, _TORSION_RADIUS_M])[:, None]
    kinds = np.argmax((axis**2).sum(axis=0), axis=0)
    rests = axis.max(axis=(0, 1)) < _LOCAL_SHARE * np.abs(u[:, :3]).max(axis=(0, 1))
    return tuple(LOCAL if still else KINDS[k] for k, still in zip(kinds, rests, strict=True))


def _levels(assembly: Assembly) -> npt.NDArray[np.float64]:
    """Return (n_levels, n_nodes): the mean over the nodes of the axis at each height."""
    mesh, structure = assembly.mesh, assembly.structure
    x, y, _ = structure.nodes[structure.top_node]
    size = max(1.0, float(np.ptp(mesh.coordinates[:, 2])))
    every: npt.NDArray[np.float64] = np.eye(len(mesh.coordinates))
    axis = np.flatnonzero((np.abs(mesh.coordinates[:, :2] - [x, y]) < 1e-6 * size).all(axis=1))
    if axis.size > 1 or not structure.interface_nodes:
        return every[axis]
    interface = [mesh.node_names.index(name) for name in structure.interface_nodes]
    mean: npt.NDArray[np.float64] = every[interface].mean(axis=0, keepdims=True)
    return mean


def mode_labels(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return ``fore_aft_1``, ``side_side_1``, … counting each kind in the order given."""
    count: Counter[str] = Counter()
    labels = []
    for kind in kinds:
        count[kind] += 1
        labels.append(f"{kind}_{count[kind]}")
    return tuple(labels)
