"""Kinds of modes (fore-aft, side-side, torsion, heave, local) and their labels in usual spellings."""

from __future__ import annotations

import re
from collections import Counter
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.response.modes.multiple import axis_levels, seen_from
from jackettwin.response.modes.tracking import NEAR_DEGENERATE
from jackettwin.structure import Assembly

KINDS = ("fore_aft", "side_side", "heave", "torsion")
LOCAL = "local"
"""Braces vibrate while the structure's axis does not move: no sensor on the tower measures such a mode."""
_TORSION_RADIUS_M = 10.0
"""Distance from the axis at which the displacement due to yaw is compared with sway: about half a jacket's
top width [m]."""
_LOCAL_SHARE = 0.1
"""Ratio of the axis' motion to the largest motion below which a mode is local: local modes have at most 0.04
(braces of two jackets) or 0.08 (panels), global ones more than 0.8."""
_EVEN = 1e-3
"""Difference between shares of motion along x below which they are equal; the lower mode is then fore-aft."""

KIND_WORDS: tuple[tuple[str, str], ...] = (
    ("fore_aft", r"fa|fore[\s_\-]*aft(?:[\s_\-]*bending)?"),
    ("side_side", r"ss|sts|s2s|side[\s_\-]*(?:to[\s_\-]*)?side(?:[\s_\-]*bending)?"),
    ("torsion", r"t|to|tor|tors|torsion(?:al)?|yaw|twist"),
    ("heave", r"heave|vertical|vert|axial"),
    ("local", r"local"),
)
"""Kind of mode and the pattern of its names, without regard to case."""
_FORMS = (
    r"^(?:mode\s*)?(?P<number>\d{1,2})(?:st|nd|rd|th|\.)?[\s_\-.]*(?:KIND)(?:\s*mode)?$",
    r"^(?:KIND)[\s_\-.#]*(?P<number>\d{1,2})$",
    r"^(?P<number>)(?:KIND)$",
)
"""Number before or after the kind, or none."""


def mode_kinds(
    assembly: Assembly, shapes: npt.NDArray[Any], frequency_hz: FloatArray, *, heading_rad: float = 0.0
) -> tuple[str, ...]:
    """Return the kind of each mode by the motion of the structure's axis at each level.

    The axis consists of the nodes on the vertical through the highest one; without a tower, of the mean of
    the interface nodes. Two modes of a nearly symmetric structure that sway perpendicular to each other may
    both lie between the global axes; the one nearer to x is then fore-aft. Fore-aft is along the nacelle's
    heading.

    Parameters
    ----------
    shapes : (assembly.n_dof, n_modes)
    frequency_hz : (n_modes,) ascending
    heading_rad : heading of the nacelle, anticlockwise from x seen from above
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
    """Tell whether two shares of motion along x belong to perpendicular sway modes: their sum is one."""
    return 0.5 <= one + other <= 1.5


def mode_labels(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return ``fore_aft_1``, ``side_side_1``, … counting each kind in the order given."""
    count: Counter[str] = Counter()
    labels = []
    for kind in kinds:
        count[kind] += 1
        labels.append(f"{kind}_{count[kind]}")
    return tuple(labels)


def read_mode_label(text: str) -> str:
    """Return a mode's label as the program writes it.

    A kind without a number is the first of its kind.

    Raises
    ------
    InputError
        If it names no kind of mode.

    Examples
    --------
    >>> [read_mode_label(text) for text in ("1st FA", "SS1", "fore_aft_2", "2nd side-side", "torsion")]
    ['fore_aft_1', 'side_side_1', 'fore_aft_2', 'side_side_2', 'torsion_1']
    """
    lower = " ".join(text.strip().lower().split())
    for kind, words in KIND_WORDS:
        for form in _FORMS:
            match = re.match(form.replace("KIND", words), lower)
            if match is not None:
                return f"{kind}_{int(match['number'] or 1)}"
    raise InputError(
        "is not the name of a mode",
        field="mode",
        value=text,
        allowed="a number, or e.g. fore_aft_1, 1st FA, SS2, torsion",
        remedy="name direction and number",
    )
