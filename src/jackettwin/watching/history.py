"""What is watched: modes through time and the conditions they were seen in, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Kind = Literal["frequency", "damping"]


@dataclass(frozen=True)
class History:
    """Modes through time.

    Attributes
    ----------
    days : (n,) times in days from any origin, ascending; whole numbers are midnights
    labels : of the m modes
    frequency, damping : (n, m) in Hz and as ratios; NaN where a mode was not seen
    frequency_std, damping_std : (n, m) stated standard deviations; NaN where none is stated
    conditions : (n, k) what was measured beside; NaN where missing
    condition_names : of the k columns
    states : (n,) number of the operating state of each row
    state_names : of the operating states
    """

    days: FloatArray
    labels: tuple[str, ...]
    frequency: FloatArray
    frequency_std: FloatArray
    damping: FloatArray
    damping_std: FloatArray
    conditions: FloatArray
    condition_names: tuple[str, ...]
    states: npt.NDArray[np.intp]
    state_names: tuple[str, ...] = ("all",)

    def rows(self, chosen: npt.NDArray[np.bool_]) -> History:
        """Return some of the rows."""
        arrays = ("days", "frequency", "frequency_std", "damping", "damping_std", "conditions", "states")
        return replace(self, **{name: getattr(self, name)[chosen] for name in arrays})

    def between(self, first: float, last: float) -> History:
        """Return the rows with first ≤ days < last."""
        return self.rows((self.days >= first) & (self.days < last))

    def by_day(self) -> tuple[History, ...]:
        """Return the rows of each whole day that has any."""
        day = np.floor(self.days)
        return tuple(self.rows(day == d) for d in np.unique(day))


def logarithms(history: History, kind: Kind, typical: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ln of the values over typical ones, and relative standard deviations, both (n, m).

    Those of ζ are std/√(ζ·ζ_typical): a record whose ζ happens to be low must not claim to be sharp
    (CoV ζ = 1/√(2πζfT), Au 2014).

    Parameters
    ----------
    typical : (m,) values of the baseline
    """
    value, std = getattr(history, kind), getattr(history, f"{kind}_std")
    good = np.where(value > 0.0, value, np.nan)
    relative = std / good if kind == "frequency" else std / np.sqrt(good * typical)
    return np.log(good / typical), np.where(relative > 0.0, relative, np.nan)
