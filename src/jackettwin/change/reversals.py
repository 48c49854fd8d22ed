r"""Changes that take back an earlier one: a repair, or a mass that comes and goes, such as ice.

The sizes :math:`s_i` of an earlier change and :math:`s_j` of a later one of the same kind cancel if

.. math:: \chi^2 = \sum_q \frac{(s_{iq}+s_{jq})^2}{\sigma_{iq}^2+\sigma_{jq}^2}

over the quantities that either changed is no larger than chance makes it, and if they point against each
other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import chi2

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90

_CHANCE = 0.01
"""Probability below which the remainder of two changes is more than their uncertainty."""
_AGAINST = -0.7
"""Largest cosine of two changes that take back each other, in standard deviations."""


def taken_back(alarms: Sequence[Mapping[str, Any]]) -> tuple[int | None, ...]:
    """Return for each alarm, in order of time, the index of the earlier one whose change it takes back.

    A change is taken back once, the latest first; scatter has no size and takes back nothing.

    Parameters
    ----------
    alarms : documents with their kind, quantities, and change by quantity
    """
    found: list[int | None] = []
    for j, later in enumerate(alarms):
        spent = {i for pair in enumerate(found) if pair[1] is not None for i in pair}
        free = (i for i in reversed(range(j)) if i not in spent and _cancel(alarms[i], later))
        found.append(next(free, None))
    return tuple(found)


def _cancel(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Tell whether two changes leave nothing."""
    if one["kind"] == "scatter" or one["kind"] != other["kind"]:
        return False
    over = sorted({*one["quantities"], *other["quantities"]})
    if not all(name in alarm["by_quantity"] for name in over for alarm in (one, other)):
        return False
    (a, a_std), (b, b_std) = (_sizes(alarm, over) for alarm in (one, other))
    a, b = a / np.hypot(a_std, b_std), b / np.hypot(a_std, b_std)
    against = float(a @ b) <= _AGAINST * float((a @ a) * (b @ b)) ** 0.5
    return against and bool(chi2.sf(float((a + b) @ (a + b)), len(over)) > _CHANCE)


def _sizes(alarm: Mapping[str, Any], names: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Return the changes of some quantities and their standard deviations, of logarithms or in degrees."""
    sized = [alarm["by_quantity"][name] for name in names]
    rows = np.array([[one["size"], *one["interval_90"]] for one in sized])
    turned = np.array([one["unit"] == "deg" for one in sized])
    size, low, high = np.where(turned[:, None], rows, np.log1p(np.where(turned[:, None], 0.0, rows))).T
    return size, (high - low) / (2.0 * NORMAL_90)
