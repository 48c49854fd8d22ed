"""How the interval of a fused mode shrinks as records are added."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jackettwin.identification.fusion import FusedMode, fuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Identification


@dataclass(frozen=True)
class Step:
    """A fused mode after its first ``n_records`` records."""

    n_records: int
    frequency_hz: float
    frequency_interval_95: tuple[float, float]
    damping_ratio: float
    damping_ratio_interval_95: tuple[float, float]


def convergence(identifications: Sequence[Identification], mode: FusedMode) -> tuple[Step, ...]:
    """Return a fused mode after 1, 2, 4, … and all of the records that hold it, in their order."""
    alone = [
        replace(identifications[r], modes=(member,))
        for r, member in zip(mode.records, mode.members, strict=True)
    ]
    steps = []
    for n in _doublings(len(alone)):
        fused = max(fuse(alone[:n]).modes, key=lambda m: len(m.records))
        steps.append(
            Step(
                n,
                fused.frequency_hz,
                fused.frequency_interval_95,
                fused.damping_ratio,
                fused.damping_ratio_interval_95,
            )
        )
    return tuple(steps)


def _doublings(last: int) -> list[int]:
    """Return 1, 2, 4, … below ``last``, and ``last``.

    >>> _doublings(6)
    [1, 2, 4, 6]
    """
    return [n for n in (2**k for k in range(last.bit_length())) if n < last] + [last]
