"""Damping ratios stated mode by mode, thesis (2.1), as a matrix on the structure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from jackettwin.errors import require
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import Matrix, build_system
from jackettwin.soil import standing
from jackettwin.structure import Assembly, Rayleigh


def modal_damping(
    assembly: Assembly, ratios: Mapping[int, float], rayleigh: Rayleigh | None = None
) -> Matrix:
    r"""Return the damping matrix that, added to Rayleigh damping, gives numbered modes their damping ratios.

    .. math:: C = \sum_i 2 (ζ_i - ζ_R(ω_i)) ω_i \, M φ_i φ_i^T M, \quad φ_i^T M φ_i = 1

    with the modes on pinned feet (a monopile's clamped). On other supports the structure's contribution to
    the damping follows from the motion. A mode that is not given has the Rayleigh ratio.

    Parameters
    ----------
    ratios : {mode number: ζ}

    Returns
    -------
    (assembly.n_dof, assembly.n_dof) [N·s/m]

    Raises
    ------
    InputError
        If a ratio is out of range or below the Rayleigh ratio, or the structure has no such mode.
    """
    for mode, ratio in ratios.items():
        require(
            mode >= 1 and 0.0 <= ratio < 1.0,
            "a modal damping ratio is out of range",
            field=f"damping.modes.{mode}",
            value=ratio,
            allowed="modes from 1 on, 0 ≤ ratio < 1",
        )
    if not ratios:
        return sp.csc_array((assembly.n_dof, assembly.n_dof))
    found = undamped_modes(build_system(assembly, standing(assembly.structure)), max(ratios))
    require(
        max(ratios) <= found.omega.size,
        "the structure has fewer modes",
        field="damping.modes",
        value=max(ratios),
        allowed=f"1 to {found.omega.size}",
    )
    rows = np.array(sorted(ratios), dtype=np.intp) - 1
    omega, zeta = found.omega[rows], np.array([ratios[int(row) + 1] for row in rows])
    own = np.zeros(rows.size) if rayleigh is None else rayleigh.ratio(omega / (2.0 * np.pi))
    for mode, ratio, least in zip(rows + 1, zeta, np.atleast_1d(own), strict=True):
        require(
            ratio >= least * (1.0 - 1e-9),
            "is less than the Rayleigh damping of this mode: the difference would add energy",
            field=f"damping.modes.{mode}",
            value=float(ratio),
            allowed=f"{least:.4g} or more beside this damping.rayleigh",
            remedy="state less Rayleigh damping, or leave it out",
        )
    moved = assembly.mass @ found.shapes[:, rows]
    norm = np.sum(found.shapes[:, rows] * moved, axis=0)
    return sp.csc_array((moved * (2.0 * (zeta - own) * omega / norm)) @ moved.T)
