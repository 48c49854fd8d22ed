"""Damping of elements with their own loss, instead of the steel's: flexible blades."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from jackettwin.soil import Law, Prony
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.structure.mesh import sum_of_blocks


def own_damping(assembly: Assembly, rayleigh: Rayleigh) -> tuple[tuple[Any, Law], ...]:
    """Return the argument ``spread`` of ``build_system`` that replaces Rayleigh damping by the elements' own.

    It is empty if no element has damping of its own.
    """
    mesh, blocks = assembly.mesh, []
    for element in assembly.structure.elements:
        if element.damping is not None:
            matrix = np.array(element.damping)
            matrix -= rayleigh.alpha * np.array(element.mass) + rayleigh.beta * np.array(element.stiffness)
            blocks.append(
                (np.concatenate([mesh.node_dofs(element.start), mesh.node_dofs(element.end)]), matrix)
            )
    if not blocks:
        return ()
    T = assembly.expand
    return ((sp.csc_array(T.T @ sum_of_blocks(mesh, blocks) @ T), Prony(c=1.0)),)
