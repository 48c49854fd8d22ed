"""Estimates of one mode in many records, as columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.identification.status import STATUSES, ModeStatus

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate


UNKNOWN = np.full((2, 2), np.nan)


@dataclass(frozen=True)
class Sightings:
    """Estimates of a mode in the records that contain it.

    Attributes
    ----------
    record : (n,) int
        Index of each record among all.
    mode : (n,) int
        Index of the mode among those of its record.
    frequency_hz, damping_ratio, duration_s : (n,)
    log_covariance : (n, 2, 2)
        Covariance of (ln f, ln ζ); NaN where unknown.
    severity : (n,) int
        Severity of the mode's status in each record.
    damping_log_likelihood : (n, 1 + NOISE_RANGES, n_nodes)
        At ``LOG_ZETA`` of ``line_likelihood.py``, by ranges of the noise; NaN where the record has none.
    """

    record: Int64Array
    mode: Int64Array
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    duration_s: FloatArray
    log_covariance: FloatArray
    severity: Int64Array
    damping_log_likelihood: FloatArray

    def __len__(self) -> int:
        return len(self.record)

    @property
    def status(self) -> ModeStatus:
        """Median status over the records; of two in the middle, the milder one."""
        return STATUSES[int(np.sort(self.severity)[(len(self) - 1) // 2])]

    def no_worse_than(self, status: ModeStatus) -> Sightings:
        """Return the estimates whose status is at most as severe; all of them if there is none."""
        rows = self.severity <= status.severity
        return self.at(rows) if rows.any() else self

    def at(self, rows: BoolArray | slice) -> Sightings:
        """Return the estimates of some rows."""
        return Sightings(*(column[rows] for column in vars(self).values()))


def log_covariance(mode: ModalEstimate) -> FloatArray:
    """Return the covariance (2, 2) of (ln f, ln ζ), NaN where it is not known."""
    return UNKNOWN if mode.log_covariance is None else mode.log_covariance
