"""Direction of the lower mode of each measured bending pair, as data for a check of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from jackettwin.response import Sensor, observation_matrix
from jackettwin.structure import Assembly
from jackettwin.study.measurements import MeasuredMode
from jackettwin.twin import AngleSums, TwinState, plus, stations
from jackettwin.updating import PairDirection


def measured_directions(
    state: TwinState | None, sensors: Sequence[Sensor], assembly: Assembly, measured: Sequence[MeasuredMode]
) -> tuple[PairDirection, ...]:
    """Return the direction of each pair in the records; none if the twin's modes are given as targets.

    Both modes need a frequency with its standard deviation, and one position needs two horizontal sensors.
    """
    places = stations(sensors)
    if state is None or not places:
        return ()
    matrix = np.asarray(observation_matrix(assembly, tuple(sensors)).toarray())
    motion = np.array([np.linalg.pinv(along) @ matrix[rows] for rows, along in places])
    by_label = {m.label: m for m in measured if m.frequency_hz is not None}
    found = []
    for number, sums in sorted(_angles(state).items()):
        pair = _pair(number, by_label)
        if pair is not None and sums.w:
            f = np.array([m.frequency_hz for m in pair], dtype=np.float64)
            apart, (angle, std) = float(abs(f[1] - f[0]) / f.mean()), sums.mean
            other = next(m.mode for m in pair if m.mode != number)
            found.append(PairDirection((number, other), angle, std, apart, motion))
    return tuple(found)


def _angles(state: TwinState) -> dict[int, AngleSums]:
    """Return the sums of all days for the direction of each lower mode, by its number."""
    found: dict[int, AngleSums] = {}
    for day in state.days.values():
        for operation in day.operations.values():
            for number, sums in operation.angles.items():
                found[number] = plus(found.get(number, AngleSums()), sums)
    return found


def _pair(number: int, by_label: Mapping[str, MeasuredMode]) -> tuple[MeasuredMode, MeasuredMode] | None:
    """Return both measured modes of the bending pair that a mode belongs to."""
    label = next((name for name, m in by_label.items() if m.mode == number), "")
    names = [label.replace("side_side_", "fore_aft_"), label.replace("fore_aft_", "side_side_")]
    if names[0] == names[1] or any(name not in by_label for name in names):
        return None
    return by_label[names[0]], by_label[names[1]]
