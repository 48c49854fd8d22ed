"""Width of the interval of a fused mode as records are added."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.identification.many_records.fusion import FusedMode, average


@dataclass(frozen=True)
class Step:
    """A fused mode after its first ``n_records`` records."""

    n_records: int
    frequency_hz: float
    frequency_interval_90: tuple[float, float]
    damping_ratio: float
    damping_ratio_interval_90: tuple[float, float]


def convergence(mode: FusedMode) -> tuple[Step, ...]:
    """Return a fused mode after 1, 2, 4, … and all of the records that contain it, in order."""
    steps = []
    for n in _doublings(len(mode.sightings)):
        mean = average(mode.sightings.at(slice(n)))
        steps.append(
            Step(
                n,
                mean.frequency_hz,
                mean.frequency_interval_90,
                mean.damping_ratio,
                mean.damping_ratio_interval_90,
            )
        )
    return tuple(steps)


def _doublings(last: int) -> list[int]:
    """Return 1, 2, 4, … below ``last``, and ``last``.

    >>> _doublings(6)
    [1, 2, 4, 6]
    """
    return [n for n in (2**k for k in range(last.bit_length())) if n < last] + [last]
