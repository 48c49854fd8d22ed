"""One mode through many records, as columns: what a mean over the records needs of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, Int64Array

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate


UNKNOWN = np.full((2, 2), np.nan)


@dataclass(frozen=True)
class Sightings:
    """A mode over records.

    Attributes
    ----------
    record : (n,) int
        Position of each record among all.
    mode : (n,) int
        Position of the mode among those of its record.
    frequency_hz, damping_ratio, duration_s : (n,)
    log_covariance : (n, 2, 2)
        Of (ln f, ln ζ); NaN where it is not known.
    """

    record: Int64Array
    mode: Int64Array
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    duration_s: FloatArray
    log_covariance: FloatArray

    def __len__(self) -> int:
        return len(self.record)

    def at(self, rows: BoolArray | slice) -> Sightings:
        """Return some of the sightings."""
        return Sightings(*(column[rows] for column in vars(self).values()))


def log_covariance(mode: ModalEstimate) -> FloatArray:
    """Return the covariance (2, 2) of (ln f, ln ζ), NaN where it is not known."""
    return UNKNOWN if mode.log_covariance is None else mode.log_covariance
