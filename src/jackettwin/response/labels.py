"""Say which mode is which: fore-aft, side-side, torsion, heave."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.structure.assemble import Assembly

KINDS = ("fore_aft", "side_side", "heave", "torsion")
_TORSION_RADIUS_M = 10.0
"""A yaw rotation counts as the sway it causes this far from the axis: about a jacket top's half width."""


def mode_kinds(assembly: Assembly, shapes: npt.NDArray[Any]) -> tuple[str, ...]:
    """Return the kind of each mode by how the highest node on the structure's axis moves.

    Parameters
    ----------
    shapes : (assembly.n_dof, n_modes)
    """
    rows = assembly.expand[assembly.mesh.node_dofs(assembly.structure.top_node)]
    motion = np.abs(rows @ shapes)
    amounts = np.vstack([motion[:3], _TORSION_RADIUS_M * motion[5]])
    return tuple(KINDS[k] for k in np.argmax(amounts, axis=0))


def mode_labels(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return ``fore_aft_1``, ``side_side_1``, … counting each kind in the order given."""
    count: Counter[str] = Counter()
    labels = []
    for kind in kinds:
        count[kind] += 1
        labels.append(f"{kind}_{count[kind]}")
    return tuple(labels)
