"""State-space model of a structure on its supports, with a name for every state, and its file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import require
from jackettwin.files import atomic_path
from jackettwin.response.motion.time import state_space
from jackettwin.response.state import maxwell_branches
from jackettwin.response.system import System

DISPLACEMENTS = ("ux_m", "uy_m", "uz_m", "rx_rad", "ry_rad", "rz_rad")
_FORCES = ("fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
_MOST_STATES = 12_000
"""Largest number of states; a larger dense matrix would need more than a gigabyte."""


@dataclass(frozen=True)
class StateModel:
    """ẋ = Ax + Bf, thesis (3.12), and (7.2), (7.5) with viscoelastic supports.

    Attributes
    ----------
    A : (n_states, n_states)
    B : (n_states, n_inputs)
    states : tuple of str
        ``NODE.ux_m`` … of the free degrees of freedom, their velocities ``NODE.ux_m/s`` …, then the internal
        variables of Maxwell branches, ``NODE.ux_m~1`` …: displacements between spring and dashpot. Motions of
        piles beside that of their heads are ``in_piles.q1`` ….
    inputs : tuple of str
        ``NODE.fx_n`` … of the same degrees of freedom.
    """

    A: FloatArray
    B: FloatArray
    states: tuple[str, ...]
    inputs: tuple[str, ...]


def state_model(system: System) -> StateModel:
    """Return the full state space of a structure on its supports.

    Raises
    ------
    InputError
        If a support's law has no finite number of states, a node has no mass, or there are too many states
        for a dense matrix.
    """
    pencil, assembly = system.pencil, system.assembly
    branches = maxwell_branches(pencil)
    size = 2 * pencil.n + sum(branch.dofs.size for branch in branches)
    require(
        size <= _MOST_STATES,
        "has too many states for a dense matrix",
        field="structure",
        value=size,
        allowed=f"up to {_MOST_STATES}",
        remedy="make a superelement of it, or subdivide it less",
    )
    free = assembly.independent[system.free]
    nodes = [assembly.mesh.node_names[dof // DOFS_PER_NODE] for dof in free]
    kinds = [int(dof % DOFS_PER_NODE) for dof in free]
    massless = np.flatnonzero(~(pencil.M.diagonal() > 0.0))
    require(
        massless.size == 0,
        "a degree of freedom without mass has no state",
        field="structure",
        value=", ".join(dict.fromkeys(nodes[dof] for dof in massless)),
        remedy="give its members a density or the node a body, or subdivide massless members less",
    )
    moved = [f"{node}.{DISPLACEMENTS[kind]}" for node, kind in zip(nodes, kinds, strict=True)]
    pushed = [f"{node}.{_FORCES[kind]}" for node, kind in zip(nodes, kinds, strict=True)]
    for k in range(1, 1 + pencil.n - free.size):
        moved.append(f"in_piles.q{k}")
        pushed.append(f"in_piles.p{k}")
    inner = [f"{moved[dof]}~{k}" for k, branch in enumerate(branches, start=1) for dof in branch.dofs]
    space = state_space(pencil)
    return StateModel(
        space.A,
        space.B,
        (*moved, *(f"{name}/s" for name in moved), *inner),
        tuple(pushed),
    )


def write_state_model(model: StateModel, path: Path) -> None:
    """Write A, B, states and inputs as a NumPy archive (``.npz``) that ``numpy.load`` reads."""
    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(
            stream, A=model.A, B=model.B, states=np.array(model.states), inputs=np.array(model.inputs)
        )
