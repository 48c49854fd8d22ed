"""Comparison of all identification methods on one record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.optimize is loaded where it is used

from jackettwin.errors import InputError
from jackettwin.identification.automatic import identify
from jackettwin.identification.methods import method_names
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.settings import IdentificationSettings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Record

FREQUENCY_SCALE = 0.03
"""Relative change of frequency that counts as much as orthogonal shapes."""
SAME_MODE = 1.0
"""Largest distance of one mode by two methods, frequency and shape combined."""


@dataclass(frozen=True)
class Comparison:
    """Modes of one record by several methods.

    Attributes
    ----------
    reference : Identification
    modes : mapping of str to tuple
        By method, its estimate of each mode of the reference, or None.
    refused : mapping of str to str
        Methods that refused the record, and their reasons.
    """

    reference: Identification
    modes: Mapping[str, tuple[ModalEstimate | None, ...]]
    refused: Mapping[str, str]


def compare_methods(
    record: Record, reference: Identification, settings: IdentificationSettings | None = None
) -> Comparison:
    """Identify a record by every method in the band of the reference, unrefined.

    Parameters
    ----------
    record : Record
        Record from which the reference was identified.
    """
    band = reference.settings
    plain = (settings or IdentificationSettings()).model_copy(
        update={
            "lowest_frequency_hz": band.lowest_frequency_hz,
            "highest_frequency_hz": band.highest_frequency_hz,
            "weighting": "br",
            "state_matrix": "shift",
            "refine": False,
            "real_poles": False,
        }
    )
    modes, refused = {}, {}
    for method in method_names():
        try:
            modes[method] = paired(reference.modes, identify(record, plain.with_method(method)).modes)
        except InputError as error:
            refused[method] = str(error)
    return Comparison(reference, modes, refused)


def paired(
    wanted: Sequence[ModalEstimate], found: Sequence[ModalEstimate]
) -> tuple[ModalEstimate | None, ...]:
    """Return for each wanted mode the mode nearest in frequency and shape, each used once."""
    out: list[ModalEstimate | None] = [None] * len(wanted)
    if not wanted or not found:
        return tuple(out)
    f = np.log([mode.frequency_hz for mode in wanted])
    g = np.log([mode.frequency_hz for mode in found])
    shapes = np.array([mode.mode_shape for mode in wanted])
    apart = np.abs(np.subtract.outer(f, g)) / FREQUENCY_SCALE
    apart += 1.0 - mac(shapes, np.array([mode.mode_shape for mode in found]))
    for i, j in zip(*scipy.optimize.linear_sum_assignment(np.minimum(apart, SAME_MODE)), strict=True):
        if apart[i, j] < SAME_MODE:
            out[int(i)] = found[int(j)]
    return tuple(out)
