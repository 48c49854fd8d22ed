"""Root locus: how the poles of a mode move as a parameter of the support goes from one limit to the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response.condensation.condensed import Condensed
from jackettwin.response.condensation.numbered_modes import Points, numbered_poles
from jackettwin.soil.laws.viscoelastic import Law


def root_locus(
    condensed: Condensed, law_of: Callable[[float], Law], values: Sequence[float], *, n_modes: int
) -> ComplexArray:
    """Return the poles (n_values, n_modes) of the modes numbered on held supports (NaN: no successor).

    Parameters
    ----------
    condensed : Condensed
        Its every group takes the law ``law_of(value)``.
    values : sequence of float
        The parameter that is swept.
    """
    rows = np.stack([law_of(value).row for value in values])
    n_groups = len(condensed.pencil.groups)
    points = Points.fixed(np.repeat(rows[:, None], n_groups, axis=1), condensed.pencil.rayleigh)
    return numbered_poles(condensed, points, tuple(range(1, n_modes + 1))).poles


def frequency_hz(poles: ComplexArray) -> FloatArray:
    """Return |λ|/2π."""
    return np.abs(poles) / (2.0 * pi)


def damping_ratio(poles: ComplexArray) -> FloatArray:
    """Return −Re λ/|λ|."""
    return np.asarray(-poles.real / np.abs(poles))
