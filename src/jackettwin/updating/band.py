"""Frequency band of the condensed model, up to the last numbered mode and the fastest relaxation."""

from __future__ import annotations

from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.response import (
    Condensed,
    UndampedModes,
    build_system,
    condense,
    undamped_modes,
    widest_band_hz,
)
from jackettwin.soil import Law, Prony, standing
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.tie_groups import TieGroups

_ROOM = 1.2
"""Ratio of the band's limit to the highest mode on pinned supports, which supports can only lower."""
_BEYOND = 2.0
"""Ratio of the band's limit to the fastest measured relaxation."""


def numbered_modes(assembly: Assembly, number: int) -> UndampedModes:
    """Return the undamped modes that define the mode numbers: on pinned feet, a monopile's clamped."""
    return undamped_modes(build_system(assembly, standing(assembly.structure)), number)


def condensed_for(
    assembly: Assembly,
    groups: TieGroups,
    rayleigh: Rayleigh,
    nuisance: NuisanceParameters,
    pinned_hz: FloatArray,
    highest_mode: int,
    fastest_rate: float,
) -> Condensed:
    """Return a structure condensed to its feet, with one group for every tie group.

    Parameters
    ----------
    pinned_hz : (n,)
        Frequencies of its numbered modes, up to the highest requested or the last it has.

    Raises
    ------
    InputError
        If the structure has fewer modes, or its steel overdamps the highest mode or the fastest relaxation.
    """
    # distinct placeholder laws, so that tie groups are not merged
    stand_ins: list[Law] = [Prony(k0=1e9 + i) for i in range(len(groups.suffixes))]
    system = build_system(
        assembly,
        groups.support(stand_ins),
        rayleigh=rayleigh,
        dashpots=nuisance.springs(
            assembly.structure.top_node, np.array([1e3 + i for i in range(len(nuisance.dashpots))])
        ),
    )
    below_hz = max(_ROOM * float(pinned_hz[-1]), _BEYOND * fastest_rate / (2.0 * pi))
    _check_band(rayleigh, pinned_hz, highest_mode, fastest_rate)
    return condense(system, below_hz=below_hz, spread=(*nuisance.matrices.values(), *nuisance.given.values()))


def _check_band(rayleigh: Rayleigh, pinned_hz: FloatArray, highest_mode: int, fastest_rate: float) -> None:
    """Raise an error for modes that do not exist, and for modes and rates that the steel would overdamp."""
    if len(pinned_hz) < highest_mode:
        raise InputError(
            "the structure has fewer modes",
            field="mode",
            value=highest_mode,
            allowed=f"1 to {len(pinned_hz)}",
            remedy="leave out the higher ones, or divide its members (subdivide)",
        )
    widest = widest_band_hz(rayleigh.beta)
    reached = int(np.searchsorted(_ROOM * pinned_hz, widest))
    remedy = "leave them out, or state less damping (damping.rayleigh)"
    if reached < highest_mode:
        raise InputError(
            "the steel's damping increases with frequency and is too strong for so high a mode",
            field="mode",
            value=highest_mode,
            allowed=f"1 to {reached} with this damping",
            remedy=remedy,
        )
    fastest = 2.0 * pi * widest / _BEYOND
    if fastest_rate > fastest:
        raise InputError(
            "the steel's damping increases with frequency and is too strong for so fast a relaxation",
            field="rate_rad_s",
            value=fastest_rate,
            allowed=f"up to {fastest:.3g} rad/s with this damping",
            remedy=remedy,
        )
