"""The numbered modes on feet of decreasing stiffness: the candidates that measured modes are compared with.

Modes are numbered on pinned feet. Springs under the feet lower some of them far more than others (the second
bending pair of a jacket by a third) and change their shapes, so that a measured mode may resemble its
counterpart only on softer feet. At each stiffness a mode is recognised by its shape on pinned feet, as in a
fit. Followed from one stiffness to the next instead, two modes that mix as they cross (second bending and
torsion, where the nacelle's mass sits beside the axis) would swap their numbers.
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
"""Stiffness of a foot on each translation [N/m]: beyond the first it is as good as pinned; softer feet than
the second carry no wind turbine."""
PER_DECADE = 4
"""Steps of the stiffness: from one to the next no frequency of the first pairs moves by more than a
fourteenth, half of what pairing allows."""
LOWEST_SHARE = 0.5
"""The stiffness is lowered until the first mode has lost half of its frequency: no foundation is softer."""
EXTRA = 6
"""Further modes computed at every step, among which the numbered ones are looked for."""


@dataclass(frozen=True)
class Feet:
    """The numbered modes on feet of one stiffness.

    Attributes
    ----------
    stiffness_n_m : float
        Of each translation of each foot; inf for the feet that modes are numbered on.
    frequency_hz : (n_modes,)
        In the order of the numbers, not of frequency; NaN where a mode was not recognised.
    shapes : (n_dof, n_modes)
    """

    stiffness_n_m: float
    frequency_hz: FloatArray
    shapes: FloatArray


def modes_by_foot_stiffness(assembly: Assembly, numbered: UndampedModes) -> tuple[Feet, ...]:
    """Return the numbered modes on pinned feet, then on springs of decreasing stiffness.

    A structure whose modes are numbered on a clamped foot (a monopile) has these alone: springs on the
    translations do not hold it.
    """
    path = [Feet(np.inf, numbered.frequency_hz, numbered.shapes)]
    on_pins = all(len(dofs) == len("xyz") for _, dofs in standing(assembly.structure).fixed)
    decades = np.log10(STIFFEST_N_M / SOFTEST_N_M)
    for stiffness in (
        np.geomspace(STIFFEST_N_M, SOFTEST_N_M, int(PER_DECADE * decades) + 1) if on_pins else ()
    ):
        try:
            found = _on_springs(assembly, float(stiffness), numbered)
        except InputError:  # it falls over under its own weight
            break
        if not found.frequency_hz[0] >= LOWEST_SHARE * numbered.frequency_hz[0]:
            break
        path.append(found)
    return tuple(path)


def _on_springs(assembly: Assembly, stiffness: float, numbered: UndampedModes) -> Feet:
    """Return the numbered modes on springs; one not recognised has its pinned shape and no frequency."""
    system = build_system(assembly, on_translations(assembly.structure, Prony(k0=stiffness)))
    modes = undamped_modes(system, len(numbered.frequency_hz) + EXTRA)
    successor = track_modes(assembly.mass, numbered.frequency_hz, numbered.shapes, modes.shapes)
    lost = successor < 0
    return Feet(
        stiffness,
        np.where(lost, np.nan, modes.frequency_hz[successor]),
        np.where(lost, numbered.shapes, modes.shapes[:, successor]),
    )
