"""Stiffness and loss of the ground averaged over the laws that the data do not distinguish."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from jackettwin.answers.result import AveragedGround, Span
from jackettwin.arrays import ComplexArray
from jackettwin.intervals import interval_90
from jackettwin.soil import law_stiffness
from jackettwin.updating import PREFERRED, Update, laplace_draws

_DRAWS = 4000
"""Draws of all laws together: the ends of their interval are then known to a twentieth of a σ."""


def averaged_ground(updates: Sequence[Update], probability: dict[str, float]) -> tuple[AveragedGround, ...]:
    r"""Return D(iω) of each group of feet, averaged over laws (Hoeting et al. 1999, eq. (1)).

    The laws' parameters differ, their complex stiffness at one frequency does not: storage stiffness Re D
    and loss factor Im D/Re D at the first pinned frequency. A law counts by its probability if that is at
    least a tenth of the largest; the result is empty unless two laws count.

    Parameters
    ----------
    probability : {law: probability} of those laws that lock no damper
    """
    least = PREFERRED * max(probability.values(), default=0.0)
    near = [u for u in updates if probability.get(u.law, 0.0) >= max(least, 1e-9)]
    if len(near) < 2:
        return ()
    weight = np.array([probability[u.law] for u in near])
    counts = np.maximum(np.round(_DRAWS * weight / weight.sum()).astype(int), 1)
    drawn = np.concatenate([_stiffness(u, n) for u, n in zip(near, counts, strict=True)])
    laws, hertz = tuple(u.law for u in near), near[0].model.reference_hz
    found = []
    for g, suffix in enumerate(near[0].model.tie_groups.suffixes):
        for kind, unit, values in (
            ("k", "N/m", drawn[:, g].real),
            ("loss_factor", "-", drawn[:, g].imag / drawn[:, g].real),
        ):
            ends = interval_90(values)
            if ends is not None:
                low, middle, high = ends
                found.append(AveragedGround(kind + suffix, unit, hertz, Span(middle, low, high), laws))
    return tuple(found)


def _stiffness(u: Update, n: int) -> ComplexArray:
    """Return n draws of D(iω₁) [N/m] of each group of feet, (n, n_groups), complex."""
    known = u.uncertainty
    z = laplace_draws(u.problem, u.best.theta) if known is None else known.log_theta
    z = z[np.linspace(0, len(z) - 1, n).round().astype(int)]
    theta = u.problem.vectors(z, u.problem.states[0])
    rows = u.model.points(theta).plain().rows[:, : len(u.model.tie_groups.suffixes)]
    return np.asarray(law_stiffness(rows, 2j * pi * u.model.reference_hz))
