"""Alarms: a change with its causes, as it looks on a day."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.change.causes import SeenCauses
from jackettwin.change.next_measurements import Circumstances, Measurement, next_measurements
from jackettwin.change.reversals import EarlierAlarm, Recurrence, answer_of, known_causes, known_changes
from jackettwin.watching import (
    CLEAR,
    Cause,
    CauseVerdict,
    Change,
    Diagnosis,
    History,
    Watch,
    diagnose,
    general_causes,
    typical,
)

_PATTERNS, _UNLIKELY = 3, 0.001
"""Number of causes whose patterns are kept, and their smallest probability."""
_WITH = 0.05
"""Smallest probability of a cause that is named with one from which the data do not distinguish it."""


@dataclass(frozen=True)
class Alarm:
    """A change and its causes, as they look on a day.

    Attributes
    ----------
    patterns : {cause: (m,)} what each likely cause would have done to all quantities, at the size it would
        have; NaN where that is not known
    answer : what it is to an earlier one, if it takes that back or is the same once more
    """

    change: Change
    diagnosis: Diagnosis
    next_measurements: tuple[Measurement, ...] = ()
    patterns: Mapping[str, FloatArray] = field(default_factory=dict)
    answer: Recurrence | None = None


def explained_alarm(
    change: Change,
    watch: Watch,
    baseline: History,
    seen: SeenCauses | None,
    past: Sequence[EarlierAlarm] = (),
) -> Alarm:
    """Return a change with its causes: the structure's or patterns over modes, and earlier changes."""
    kinds = [kind for kind, _ in watch.quantities]
    known = known_changes(past) if change.kind != "scatter" else {}
    chosen = np.ones(len(kinds), dtype=np.bool_) if seen is None else seen.known
    if seen is None:
        causes = general_causes(watch.quantities, watch.labels, typical(baseline.frequency))
    else:
        causes = seen.causes
    causes = (*causes, *known_causes(known, chosen))
    own = [kind for kind, good in zip(kinds, chosen, strict=True) if good]
    # patterns over modes are no causes of which two could be told
    alone = known if seen is not None else {cause.name for cause in causes}
    found = diagnose(change.restricted(chosen), causes, own, alone)
    # what a change is to an earlier one is no alternative to the causes of either
    groups = (tuple(name for name in group if name not in known) for group in found.inseparable)
    found = replace(found, inseparable=tuple(group for group in groups if len(group) > 1))
    answer = answer_of(likeliest_of(found), known)
    further: tuple[Measurement, ...] = ()
    if seen is not None and answer is None:
        further = next_measurements(seen, found, Circumstances.of(watch, baseline, seen.model.labels))
    patterns = _patterns(found, causes, chosen)
    sizeless = (
        replace(v, size=np.nan, interval_90=(np.nan, np.nan)) if v.cause in known else v
        for v in found.verdicts
    )
    return Alarm(change, replace(found, verdicts=tuple(sizeless)), further, patterns, answer=answer)


def likeliest_of(diagnosis: Diagnosis) -> tuple[CauseVerdict, ...]:
    """Return the likeliest cause, with those that the data do not distinguish from it unless it is clear.

    Softer soil at 41 % is no verdict where scour of all feet has 29 % and of one 18 %.
    """
    best, *others = diagnosis.verdicts
    if best.probability >= CLEAR:
        return (best,)
    group = next((group for group in diagnosis.inseparable if best.cause in group), ())
    return (best, *(one for one in others if one.cause in group and one.probability >= _WITH))


def _patterns(diagnosis: Diagnosis, causes: Sequence[Cause], known: BoolArray) -> dict[str, FloatArray]:
    """Return the effects of likely causes on all quantities, NaN where unknown."""
    by_name = {cause.name: cause for cause in causes}
    found: dict[str, FloatArray] = {}
    for verdict in diagnosis.verdicts[:_PATTERNS]:
        if verdict.probability > _UNLIKELY and np.isfinite(verdict.size):
            step = np.full(known.size, np.nan)
            step[known] = by_name[verdict.cause].steps(np.array([verdict.size]))[0]
            found[verdict.cause] = step
    return found
