r"""Changes that take back an earlier one: a repair, or a mass that comes and goes, such as ice.

The sizes :math:`s_i` of an earlier change and :math:`s_j` of a later one of the same kind cancel if

.. math:: \chi^2 = \sum_q \frac{(s_{iq}+s_{jq})^2}{\sigma_{iq}^2+\sigma_{jq}^2}

over the quantities that either changed is no larger than chance makes it, and if they point against each
other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scipy.stats import chi2

if TYPE_CHECKING:
    from jackettwin.watching import Change

_CHANCE = 0.01
"""Probability below which the remainder of two changes is more than their uncertainty."""
_AGAINST = -0.7
"""Largest cosine of two changes that take back each other, in standard deviations."""


def taken_back(changes: Sequence[Change]) -> tuple[int | None, ...]:
    """Return for each change, in order of time, the index of the earlier one that it takes back, or None.

    A change is taken back once, the latest first; scatter has no size and takes back nothing.
    """
    found: list[int | None] = []
    for j, later in enumerate(changes):
        spent = {i for pair in enumerate(found) if pair[1] is not None for i in pair}
        free = (i for i in reversed(range(j)) if i not in spent and _cancel(changes[i], later))
        found.append(next(free, None))
    return tuple(found)


def _cancel(one: Change, other: Change) -> bool:
    """Tell whether two changes leave nothing."""
    if one.kind == "scatter" or one.kind != other.kind or one.size.size != other.size.size:
        return False
    over = one.members | other.members
    std = (one.size_std[over] ** 2 + other.size_std[over] ** 2) ** 0.5
    a, b = one.size[over] / std, other.size[over] / std
    against = float(a @ b) <= _AGAINST * float((a @ a) * (b @ b)) ** 0.5
    return against and bool(chi2.sf(float((a + b) @ (a + b)), int(over.sum())) > _CHANCE)
