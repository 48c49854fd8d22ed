"""The smallest changes that a watch would find: what an owner asks first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.causes import ModelCauses, seen_causes
from jackettwin.watching import CHANCE, Cause, History, Sight, Watch, general_causes, sight, typical

HORIZONS_DAYS = (30.0, 90.0, 365.0)
_RANGE = (0.05, 5.0)
"""Sizes that are tried, in usual sizes of the cause."""
_LARGEST = {"scour at all feet": 5.0, "soil softening": 0.9}
"""Largest size that makes sense, [m] and as a share."""
_ALL_OR_NONE = " lost"
_EVERY = "all modes alike"


@dataclass(frozen=True)
class SmallestChange:
    """Smallest change that is found with 95 % probability within some days of its onset.

    Attributes
    ----------
    change : name of the cause
    days : within which it is found
    size : the smallest that is, in ``unit``; None if none is. For a lost brace None
    found, of : number of braces whose loss would be found, and of all; None for what has a size
    step : change of each monitored quantity by this size: of logarithms, angles [rad]; empty without a size
    projected : whether the baseline is shorter, so that its records are taken to come again and again
    """

    change: str
    days: float
    size: float | None
    unit: str
    found: int | None = None
    of: int | None = None
    step: tuple[float, ...] = ()
    projected: bool = False


def smallest_changes(
    watch: Watch, baseline: History, causes: ModelCauses | None
) -> tuple[SmallestChange, ...]:
    """Return what would be found within ``HORIZONS_DAYS``; none after a baseline of less than some weeks.

    Parameters
    ----------
    watch : at the end of the baseline
    causes : of the structure; without, all modes are taken to change alike
    """
    out: list[SmallestChange] = []
    for days in HORIZONS_DAYS:
        seen = sight(watch, baseline, days)
        if seen is not None:
            now = _general(watch, baseline, seen) if causes is None else _of_structure(watch, seen, causes)
            sooner = {one.change: one for one in out}
            now = (replace(one, projected=seen.projected) for one in now)
            out += [_with_sooner(one, sooner.get(one.change)) for one in now]
    return tuple(out)


def _with_sooner(one: SmallestChange, sooner: SmallestChange | None) -> SmallestChange:
    """Return a horizon's change with what a shorter one finds, for this is found within more days, too."""
    if sooner is None:
        return one
    if one.found is not None and sooner.found is not None:
        return replace(one, found=max(one.found, sooner.found))
    if sooner.size is not None and (one.size is None or sooner.size < one.size):
        return replace(one, size=sooner.size, step=sooner.step)
    return one


def _general(watch: Watch, baseline: History, seen: Sight) -> Iterator[SmallestChange]:
    f = typical(baseline.frequency)
    named = [c for c in general_causes(watch.quantities, watch.labels, f) if c.name == _EVERY]
    for cause in named:
        size = seen.smallest(lambda x, c=cause: c.steps(np.array([-x])), 1e-4, 0.2)  # type: ignore[misc]
        yield SmallestChange(cause.name, seen.days, size, "-")


def _of_structure(watch: Watch, seen: Sight, causes: ModelCauses) -> Iterator[SmallestChange]:
    over = seen_causes(causes, watch.quantities, watch.labels)

    def steps(cause: Cause, size: float) -> FloatArray:
        """Return the changes by a cause as the structure's model draws them, (n_draws, m)."""
        every = np.zeros((len(cause.draws), over.known.size))
        apart = size * (cause.draws - cause.draws.mean(axis=0))
        every[:, over.known] = cause.steps(np.array([size])) + apart
        return every

    for cause in over.causes:
        if cause.name in _LARGEST:
            high = min(_RANGE[1] * cause.usual, _LARGEST[cause.name])
            size = seen.smallest(lambda x, c=cause: steps(c, x), _RANGE[0] * cause.usual, high)  # type: ignore[misc]
            moved = () if size is None else tuple(np.round(steps(cause, size).mean(axis=0), 7).tolist())
            yield SmallestChange(cause.name, seen.days, size, cause.unit, step=moved)
    lost = [c for c in over.causes if c.name.split(" (or ")[0].endswith(_ALL_OR_NONE)]
    number = [1 + len(c.alike) for c in lost]
    found = [n for c, n in zip(lost, number, strict=True) if seen.chance(steps(c, 1.0)) >= CHANCE]
    if lost:
        yield SmallestChange("a brace lost", seen.days, None, "-", sum(found), sum(number))


def smallest_documents(found: Sequence[SmallestChange]) -> list[dict[str, Any]]:
    """Return the smallest changes as plain data."""
    return [{**asdict(one), "step": list(one.step)} for one in found]


def smallest_sentence(found: Sequence[dict[str, Any]]) -> str:
    """Return what would be found with 95 %, horizon by horizon; empty if nothing is known."""
    parts = []
    for days in dict.fromkeys(one["days"] for one in found):
        named = [one for one in found if one["days"] == days]
        own = ", ".join(map(_words, named))
        beyond = " (projected from a shorter baseline)" if any(one.get("projected") for one in named) else ""
        parts.append(f"within {days:.0f} days{beyond} {own}")
    return f"Would be found with {CHANCE:.0%} at this noise and promise: {'; '.join(parts)}." if parts else ""


def _words(one: dict[str, Any]) -> str:
    if one["of"] is not None:
        return f"{one['found']} of {one['of']} braces if lost"
    if one["size"] is None:
        return f"no {one['change']}"
    size = f"{one['size']:.2g} m" if one["unit"] == "m" else f"{100.0 * one['size']:.2g} %"
    return f"{one['change']} by {size}"
