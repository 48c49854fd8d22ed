"""Say which mode is which: fore-aft, side-side, torsion, heave, or local."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import FloatArray
from jackettwin.response.modes.multiple import axis_levels, seen_from
from jackettwin.response.modes.tracking import NEAR_DEGENERATE
from jackettwin.structure import Assembly

KINDS = ("fore_aft", "side_side", "heave", "torsion")
LOCAL = "local"
"""Braces swing, the structure's axis rests: no sensor on the tower sees such a mode."""
_TORSION_RADIUS_M = 10.0
"""A yaw rotation counts as the sway it causes this far from the axis: about a jacket top's half width."""
_LOCAL_SHARE = 0.1
"""An axis that moves less than this share of the largest motion rests: local modes stay below 0.04 (braces of
two jackets) and 0.08 (panels), their global ones above 0.8."""
_EVEN = 1e-3
"""Shares of motion along x that differ by less are the same; the lower of the two modes is then fore-aft."""


def mode_kinds(
    assembly: Assembly, shapes: npt.NDArray[Any], frequency_hz: FloatArray, *, heading_rad: float = 0.0
) -> tuple[str, ...]:
    """Return the kind of each mode by how the structure's axis moves, level by level.

    The axis is the nodes above and below the highest one; without a tower, the mean of the interface nodes.
    The two modes of a nearly symmetric structure that sway across each other may both lie between the global
    axes; the one nearer to x is then the fore-aft one of the two. Fore-aft is along the nacelle's heading.

    Parameters
    ----------
    shapes : (assembly.n_dof, n_modes)
    frequency_hz : (n_modes,) ascending
    heading_rad : of the nacelle, anticlockwise from x seen from above
    """
    u = (assembly.expand @ shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
    axis = np.abs(seen_from(heading_rad, np.tensordot(axis_levels(assembly), u, 1)[:, [0, 1, 2, 5]]))
    axis *= np.array([1.0, 1.0, 1.0, _TORSION_RADIUS_M])[:, None]
    energy = (axis**2).sum(axis=0)
    kinds = np.argmax(energy, axis=0)
    rests = axis.max(axis=(0, 1)) < _LOCAL_SHARE * np.abs(u[:, :3]).max(axis=(0, 1))
    sways = np.flatnonzero((kinds < 2) & ~rests)
    along_x = energy[0] / np.maximum(energy[0] + energy[1], np.finfo(float).tiny)
    for one, other in zip(sways[:-1], sways[1:], strict=True):
        near = frequency_hz[other] - frequency_hz[one] <= NEAR_DEGENERATE * frequency_hz[other]
        if near and kinds[one] == kinds[other] and _across(along_x[one], along_x[other]):
            kinds[one] = 0 if along_x[one] > along_x[other] - _EVEN else 1
            kinds[other] = 1 - kinds[one]
    return tuple(LOCAL if still else KINDS[k] for k, still in zip(kinds, rests, strict=True))


def _across(one: float, other: float) -> bool:
    """Tell whether two shares of motion along x are those of sways across each other: their sum is one."""
    return 0.5 <= one + other <= 1.5


def mode_labels(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return ``fore_aft_1``, ``side_side_1``, … counting each kind in the order given."""
    count: Counter[str] = Counter()
    labels = []
    for kind in kinds:
        count[kind] += 1
        labels.append(f"{kind}_{count[kind]}")
    return tuple(labels)
