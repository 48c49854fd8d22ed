"""Cycles of a stress series by rainflow counting, with a residue that is carried from record to record.

Rainflow counting of ASTM E1049-85 in its four-point form (pylife): a closed loop is a full cycle. What has
not closed is the residue. Ended, each of its ranges is half a cycle, as ASTM counts them; carried on, it
closes with the samples that follow, so that slow cycles are counted whatever the length of a record.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from math import isfinite
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import MissingExtra, require

_FEWEST = 3
"""Samples from which a whole series is counted by the loop alone."""


@dataclass(frozen=True)
class Cycles:
    """Counted ranges.

    Attributes
    ----------
    full : (n,) ranges of closed cycles, in the unit of the series
    half : (m,) ranges of the residue, each half a cycle
    """

    full: FloatArray
    half: FloatArray

    @property
    def ranges(self) -> FloatArray:
        """All ranges, (n + m,)."""
        return np.concatenate([self.full, self.half])

    @property
    def numbers(self) -> FloatArray:
        """Count of each range, (n + m,): 1 or ½."""
        return np.concatenate([np.ones(self.full.size), np.full(self.half.size, 0.5)])


class Counter:
    """Counts one series piece by piece.

    Closed cycles are taken out with :meth:`closed`; the residue stays and closes with later pieces.
    """

    def __init__(self, residue: FloatArray | None = None) -> None:
        rainflow = _pylife()
        self._recorder = rainflow.FullRecorder()
        self._detector = rainflow.FourPointDetector(recorder=self._recorder)
        self._taken = 0
        if residue is not None and residue.size:
            self._detector.process(np.asarray(residue, dtype=float))

    def add(self, samples: FloatArray) -> None:
        """Count the next samples (n,) of the series.

        Raises
        ------
        InputError
            If a sample is not a finite number.
        """
        values = _finite(samples)
        if values.size:
            self._detector.process(values.astype(float, copy=False))

    def closed(self) -> FloatArray:
        """Return the ranges (n,) of the cycles that closed since the last call."""
        first, last = (np.asarray(ends) for ends in (self._recorder.values_from, self._recorder.values_to))
        new = np.abs(last[self._taken :] - first[self._taken :])
        self._taken = first.size
        return np.asarray(new, dtype=float)

    def ended(self) -> Cycles:
        """Return what closed since the last call, and the residue as half cycles: the series ends here."""
        half = np.abs(np.diff(self.residue))
        return Cycles(self.closed(), half[half > 0.0])

    @property
    def residue(self) -> FloatArray:
        """Turning points (m,) that wait for the cycle that closes them; the last is the last sample."""
        return np.asarray(self._detector.residuals, dtype=float)


def count(samples: FloatArray) -> Cycles:
    """Return the cycles of a whole series (n,), its residue as half cycles.

    Examples
    --------
    The example of ASTM E1049-85, figure 6.

    >>> found = count(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    >>> found.full.tolist(), found.half.tolist()
    ([4.0], [3.0, 4.0, 8.0, 9.0, 8.0, 6.0])

    Raises
    ------
    InputError
        If a sample is not a finite number.
    MissingExtra
        If pylife is not installed.
    """
    values = _finite(samples)
    loop = _pylife_loop()
    if loop is None or values.size < _FEWEST:
        counter = Counter()
        counter.add(values)
        return counter.ended()
    turns = _turning_points(values).astype(float, copy=False)
    one, other, _, _, left = loop(turns, np.arange(turns.size, dtype=np.uintp))
    half = np.abs(np.diff(turns[left]))
    return Cycles(np.abs(np.asarray(other) - one), half[half > 0.0])


def _finite(samples: FloatArray) -> FloatArray:
    values = np.asarray(samples)
    if not isfinite(float(values.sum(dtype=float))):
        finite = np.isfinite(values)
        require(
            finite.all(),
            "a sample is not a finite number",
            field="samples",
            value=int((~finite).sum()),
            remedy="count the pieces between gaps each for itself",
        )
    return values


def _turning_points(values: FloatArray) -> FloatArray:
    """Return the first sample of a series (n,), the first of each peak and valley, and the last."""
    moving = values if (step := np.diff(values)).all() else values[np.concatenate([[True], step != 0.0])]
    rising = moving[1:] > moving[:-1]
    return np.concatenate([moving[:1], moving[1:-1][rising[1:] != rising[:-1]], values[-1:]])


def equivalent_range(cycles: Cycles, m: float, n_eq: float) -> float:
    r"""Return the range whose ``n_eq`` cycles do the damage of all: :math:`(Σ n_i Δ_i^m / N_{eq})^{1/m}`."""
    return float(((cycles.numbers * cycles.ranges**m).sum() / n_eq) ** (1.0 / m))


@cache
def _pylife_loop() -> Any:
    """Return pylife's loop alone, around which its detector costs ten times as much; None without it."""
    try:
        return import_module("pylife.rainflow_ext").fourpoint_loop
    except (ImportError, AttributeError):
        return None


def _pylife() -> Any:
    try:
        return import_module("pylife.stress.rainflow")
    except ImportError:
        raise MissingExtra(
            "counting cycles needs pylife", remedy="pip install 'jackettwin[fatigue]'"
        ) from None
