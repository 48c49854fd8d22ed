"""Tower damping tuned so that the first modes of the whole asset have a given ratio (thesis section 5.3).

A ratio set on the tower alone says little of the coupled modes, which bend jacket and piles too. Here the
tower's stiffness-proportional damping has one factor for bending in each vertical plane; both are found
together from the coupled poles.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import InputError, NumericalError
from jackettwin.response.labels import mode_kinds
from jackettwin.response.reduced import Reduced
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Group
from jackettwin.soil.viscoelastic import Prony
from jackettwin.structure import Assembly, assemble

FloatArray = npt.NDArray[np.float64]

_PLANES = {"fore_aft": (0, 4), "side_side": (1, 3)}
"""DOFs of a node that bend the tower in each plane."""
_TOLERANCE = 1e-7


def tuned_tower(assembly: Assembly, small: Reduced, ratio: float) -> FloatArray:
    """Return the damping matrix (n, n) of the tower that gives both first modes the damping ``ratio``.

    Raises
    ------
    InputError
        If there is no tower, or the rest of the asset damps more than ``ratio`` already.
    NumericalError
        If the ratio is not met.
    """
    shapes = _tower_stiffness(assembly, small)
    factors = np.zeros(2)
    first = first_ratios(assembly, small, np.zeros((small.n, small.n)))
    if first.max() > ratio:
        raise InputError(
            "the asset without its tower's damping has more already",
            field="damping.coupled",
            value=ratio,
            allowed=f"> {first.max():.4f}",
            remedy="lower damping.rayleigh or the soil's damping",
        )
    size = 2.0 * (ratio - first) / np.array([_first_omega(small)] * 2)
    for _ in range(20):
        error = first_ratios(assembly, small, _mix(shapes, factors)) - ratio
        if np.abs(error).max() < _TOLERANCE:
            return _mix(shapes, factors)
        slopes = np.empty((2, 2))
        for j in range(2):
            moved = factors.copy()
            moved[j] += 0.1 * size[j]
            change = first_ratios(assembly, small, _mix(shapes, moved)) - ratio - error
            slopes[:, j] = change / (0.1 * size[j])
        factors = np.maximum(factors - np.linalg.solve(slopes, error), 0.0)
    raise NumericalError(f"the tower's damping could not be tuned to {ratio}")


def first_ratios(assembly: Assembly, small: Reduced, damping: FloatArray) -> FloatArray:
    """Return the damping ratios of the first fore-aft and side-side modes, with ``damping`` (n, n) added."""
    group = Group(Prony(c=1.0), damping, np.arange(small.n))
    pencil = replace(small.pencil, groups=(*small.pencil.groups, group))
    values, states = np.linalg.eig(state_matrix(pencil))
    oscillating = np.flatnonzero(values.imag > 0.0)
    lowest = oscillating[np.argsort(np.abs(values[oscillating]))[:8]]
    kinds = mode_kinds(assembly, small.basis @ states[: small.n, lowest])
    ratios = []
    for kind in _PLANES:
        if kind not in kinds:
            raise InputError(f"the asset has no {kind.replace('_', '-')} mode", field="damping.coupled")
        value = values[lowest[kinds.index(kind)]]
        ratios.append(-value.real / abs(value))
    return np.array(ratios)


def _first_omega(small: Reduced) -> float:
    values = np.linalg.eigvals(np.linalg.solve(small.pencil.M, small.pencil.static_stiffness()))
    return float(np.sqrt(values.real.min()))


def _mix(shapes: tuple[FloatArray, FloatArray], factors: FloatArray) -> FloatArray:
    return np.asarray(factors[0] * shapes[0] + factors[1] * shapes[1])


def _tower_stiffness(assembly: Assembly, small: Reduced) -> tuple[FloatArray, FloatArray]:
    """Return the tower's stiffness in the fore-aft and the side-side plane, on the coordinates."""
    structure, mesh = assembly.structure, assembly.mesh
    if not any(member.part == "tower" for member in structure.members):
        raise InputError(
            "the structure has no tower to tune",
            field="damping.coupled",
            remedy="give its members part: tower, or use damping.rayleigh",
        )
    n = mesh.start.size // len(structure.members)
    plain = assemble(structure, subdivide=n)
    stiffer = assemble(structure.with_material("tower", youngs_modulus=2.0), subdivide=n)
    tower = stiffer.stiffness - plain.stiffness
    kind = assembly.independent % DOFS_PER_NODE
    both = []
    for plane in _PLANES.values():
        # axial and torsional stiffness, half to each plane
        share = np.isin(kind, plane) + np.sqrt(0.5) * np.isin(kind, (2, 5))
        x = share[:, None] * small.basis
        both.append(np.asarray(x.T @ (tower @ x)))
    return both[0], both[1]
