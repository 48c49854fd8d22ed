"""The numbered modes on feet of decreasing stiffness, with which measured modes are compared.

Modes are numbered on pinned feet. Springs under the feet lower some of them far more than others (the second
bending pair of a jacket by a third) and change their shapes, so that a measured mode may resemble its
counterpart only on feet of lower stiffness. At each stiffness a mode is recognised by its shape on pinned
feet, as in a fit. If modes were tracked from one stiffness to the next, two modes that mix as they cross
(second bending and torsion, if the nacelle's mass is eccentric) would exchange their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.response import UndampedModes, build_system, track_modes, undamped_modes
from jackettwin.soil import Prony, on_translations, standing
from jackettwin.structure import Assembly

STIFFEST_N_M, SOFTEST_N_M = 1e11, 1e7
"""Range of the stiffness of a foot on each translation [N/m]: with the first the feet are practically pinned;
with less than the second they cannot carry a wind turbine."""
PER_DECADE = 4
"""Steps of the stiffness per decade, in which no frequency of the first pairs changes by more than 7 %, half
of the tolerance of pairing."""
LOWEST_SHARE = 0.5
"""Share of the first mode's frequency down to which the stiffness is reduced; no foundation is softer."""
EXTRA = 6
"""Number of additional modes computed at every step, to find the numbered ones."""


@dataclass(frozen=True)
class Feet:
    """The numbered modes on feet of one stiffness.

    Attributes
    ----------
    stiffness_n_m : float
        Stiffness of each translation of each foot; inf for the feet on which modes are numbered.
    frequency_hz : (n_modes,)
        In the order of the mode numbers, not of frequency; NaN where a mode was not recognised.
    shapes : (n_dof, n_modes)
    """

    stiffness_n_m: float
    frequency_hz: FloatArray
    shapes: FloatArray


def modes_by_foot_stiffness(assembly: Assembly, numbered: UndampedModes) -> tuple[Feet, ...]:
    """Return the numbered modes on pinned feet, then on springs of decreasing stiffness.

    For a structure whose modes are numbered on a clamped foot (a monopile) only these are returned, since
    springs on the translations do not support it.
    """
    path, near = [Feet(np.inf, numbered.frequency_hz, numbered.shapes)], None
    on_pins = all(len(dofs) == len("xyz") for _, dofs in standing(assembly.structure).fixed)
    decades = np.log10(STIFFEST_N_M / SOFTEST_N_M)
    for stiffness in (
        np.geomspace(STIFFEST_N_M, SOFTEST_N_M, int(PER_DECADE * decades) + 1) if on_pins else ()
    ):
        try:
            found, near = _on_springs(assembly, float(stiffness), numbered, near)
        except InputError:  # unstable under its weight
            break
        if not found.frequency_hz[0] >= LOWEST_SHARE * numbered.frequency_hz[0]:
            break
        path.append(found)
    return tuple(path)


def _on_springs(
    assembly: Assembly, stiffness: float, numbered: UndampedModes, near: UndampedModes | None
) -> tuple[Feet, UndampedModes]:
    """Return the numbered modes on springs, and all that were computed, from those ``near`` them if any.

    An unrecognised mode has its pinned shape and no frequency.
    """
    system = build_system(assembly, on_translations(assembly.structure, Prony(k0=stiffness)))
    modes = undamped_modes(system, len(numbered.frequency_hz) + EXTRA, near=near)
    successor = track_modes(assembly.mass, numbered.frequency_hz, numbered.shapes, modes.shapes)
    lost = successor < 0
    feet = Feet(
        stiffness,
        np.where(lost, np.nan, modes.frequency_hz[successor]),
        np.where(lost, numbered.shapes, modes.shapes[:, successor]),
    )
    return feet, modes
