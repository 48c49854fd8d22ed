"""Monitoring of a table of modes: baseline, daily evaluation, changes and their causes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.change.causes import ModelCauses, SeenCauses, model_causes, seen_causes
from jackettwin.change.ground import UNDESCRIBED, Ground
from jackettwin.change.modal_table import ModalTable
from jackettwin.change.next_measurements import Circumstances, Measurement, next_measurements
from jackettwin.change.reversals import EarlierAlarm, Recurrence, answer_of, known_causes, known_changes
from jackettwin.change.smallest_changes import SmallestChange, smallest_changes
from jackettwin.change.working_rotor import WorkingRotor
from jackettwin.errors import InputError
from jackettwin.structure import Structure
from jackettwin.watching import (
    CLEAR,
    Cause,
    CauseVerdict,
    Change,
    Diagnosis,
    History,
    Look,
    PendingChange,
    Watch,
    diagnose,
    fresh,
    general_causes,
    look_again,
    regressors,
    start,
    step,
    typical,
    unexplained_std,
)
from jackettwin.watching.design import WHOLE_YEAR_DAYS
from jackettwin.watching.history import deviations
from jackettwin.watching.variance_shares import shares, slopes
from jackettwin.watching.watch import columns_to_watch

_PATTERNS, _UNLIKELY = 3, 0.001
"""Number of causes whose patterns are kept, and their smallest probability."""
_WITH = 0.05
"""Smallest probability of a cause that is named with one from which the data do not distinguish it."""
_MISSING = 0.1
"""Share of missing values of a condition above which a remark is given."""


@dataclass(frozen=True)
class Alarm:
    """A change and its causes.

    Attributes
    ----------
    patterns : {cause: (m,)} what each likely cause would have done to all quantities, at the size it would
        have; NaN where that is not known
    earlier : the same change as it looked before, first on the day of the alarm
    told : day on which it was stated again as it looked before another change; None on the day of the look
    answer : what it is to an earlier one, if it takes that back or is the same once more
    """

    change: Change
    diagnosis: Diagnosis
    next_measurements: tuple[Measurement, ...] = ()
    patterns: Mapping[str, FloatArray] = field(default_factory=dict)
    earlier: tuple[Alarm, ...] = ()
    told: float | None = None
    answer: Recurrence | None = None

    @property
    def day(self) -> float:
        """Day of the alarm, whenever it was looked at last."""
        return self.earlier[0].change.day if self.earlier else self.change.day


@dataclass(frozen=True)
class MonitoredTable:
    """A monitored table of modes.

    Attributes
    ----------
    baseline_days : (first, last) day of the baseline
    watch : the state after the last day
    looks : of each day with records after the baseline
    explained : {(kind, mode): {condition: share of variance over the baseline}}
    slopes : {(kind, mode): {condition: of the logarithm, by a unit of it}}
    unexplained_std : {(kind, mode): of the logarithm}
    limits : what could not be done, as sentences
    smallest : changes that would be found
    """

    table: ModalTable
    baseline_days: tuple[float, float]
    watch: Watch
    looks: tuple[Look, ...]
    alarms: tuple[Alarm, ...]
    explained: Mapping[tuple[str, int], Mapping[str, float]]
    unexplained_std: Mapping[tuple[str, int], float]
    limits: tuple[str, ...]
    slopes: Mapping[tuple[str, int], Mapping[str, float]]
    smallest: tuple[SmallestChange, ...] = ()


def watch_table(
    table: ModalTable,
    *,
    baseline_days: float = 365.0,
    arl_years: float = 10.0,
    from_day: float = 0.0,
    structure: Structure | None = None,
    gravity: bool = True,
    ground: Ground = UNDESCRIBED,
    rotor: WorkingRotor | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> MonitoredTable:
    """Monitor a table of modes; no row is used before its day.

    Parameters
    ----------
    baseline_days : from the first row on, or from ``from_day``
    from_day : earlier rows are left out: after a repair or a confirmed change the baseline is learnt anew
    structure, gravity : what stands there, and whether its weight softens it: causes are then its own. None
        for what patterns over modes tell by themselves
    ground : what is known of it
    rotor : at work, if the rows are of operation
    progress : told what is being done

    Raises
    ------
    InputError
        If there is too little to learn from.
    """
    for name, value in (("--baseline-days", baseline_days), ("--arl-years", arl_years)):
        if not value > 0.0:  # NaN, too
            raise InputError("not above zero", field=name, value=value, allowed="> 0")
    history = table.history.between(from_day, np.inf)
    if not history.days.size:
        raise InputError("no rows after the time to learn anew from", field="--relearn", value=from_day)
    first = float(np.floor(history.days[0]))
    end = first + baseline_days
    baseline = history.between(first, end)
    rest = history.between(end, np.inf)
    limits = list(table.remarks)
    if not rest.days.size:
        limits.append(
            f"all {history.days[-1] - first:.0f} days lie in the baseline of {baseline_days:g}: "
            "nothing is watched yet"
        )
    columns_to_watch(baseline)  # refuse before the causes are computed, which takes a while
    if structure is not None:
        progress("causes")
    causes = None if structure is None else structure_causes(structure, gravity, baseline, ground, rotor)
    progress("baseline")
    watch = watch_after_baseline(baseline, arl_years, causes)
    smallest = smallest_changes(watch, baseline, causes)
    limits += _limits(watch, baseline, rest)
    explained, unexplained = _explained(watch, baseline)
    seen = None if causes is None else seen_causes(causes, watch.quantities, watch.labels)
    limits += [] if causes is None else _unseen(causes, watch.labels)
    looks: list[Look] = []
    alarms: list[Alarm] = []
    pending: PendingChange | None = None
    for day in rest.by_day():
        progress(f"{table.time(float(day.days[0])):%Y-%m}")
        watch, look = step(watch, day)  # first, as for a living asset: both tell the same gains
        looks.append(look)
        if pending is not None:
            pending, change = look_again(pending, day)
            if change is not None:
                past = _past(table, alarms[:-1])
                alarms[-1] = _looked_again(alarms[-1], explained_alarm(change, watch, baseline, seen, past))
        if look.change is not None:
            alarms[-1:] = [_before(one, look.change) for one in alarms[-1:]]
            past = _past(table, alarms)
            alarms.append(explained_alarm(look.change, watch, baseline, seen, past))
            pending = look.pending
    found = [one for block in watch.blocks for one in slopes(block, watch.design)]
    per_unit: dict[tuple[str, int], dict[str, float]] = dict(zip(watch.quantities, found, strict=True))
    return MonitoredTable(
        table,
        (first, end),
        watch,
        tuple(looks),
        tuple(alarms),
        explained,
        unexplained,
        tuple(limits),
        per_unit,
        smallest,
    )


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
    found = diagnose(change.restricted(chosen), causes, own)
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


def _past(table: ModalTable, alarms: Sequence[Alarm]) -> tuple[EarlierAlarm, ...]:
    """Return earlier alarms as the next ones see them."""
    return tuple(
        EarlierAlarm(
            table.time(one.day).isoformat(), one.change.size, one.change.size_std,
            one.change.kind != "scatter", one.answer,
        )
        for one in alarms
    )  # fmt: skip


def likeliest_of(diagnosis: Diagnosis) -> tuple[CauseVerdict, ...]:
    """Return the likeliest cause, with those that the data do not distinguish from it unless it is clear.

    Softer soil at 41 % is no verdict where scour of all feet has 29 % and of one 18 %.
    """
    best, *others = diagnosis.verdicts
    if best.probability >= CLEAR:
        return (best,)
    group = next((group for group in diagnosis.inseparable if best.cause in group), ())
    return (best, *(one for one in others if one.cause in group and one.probability >= _WITH))


def _looked_again(before: Alarm, later: Alarm) -> Alarm:
    """Return an alarm as it looks later, with how it looked before."""
    return replace(later, earlier=(*before.earlier, replace(before, earlier=())))


def _before(alarm: Alarm, later: Change) -> Alarm:
    """Return an alarm as it last looked before another change began.

    Looks after that take both for one step: of ice that fell off after a week a month leaves a quarter.
    """
    looks = [*alarm.earlier, alarm]
    if later.kind == "scatter" or looks[-1].change.day <= later.began:
        return alarm
    sound = [one for one in looks if one.change.day <= later.began] or looks[:1]
    return _looked_again(alarm, replace(sound[-1], earlier=(), told=later.day))


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


def structure_causes(
    structure: Structure, gravity: bool, baseline: History, ground: Ground, rotor: WorkingRotor | None
) -> ModelCauses:
    """Return the possible causes for a structure with these modes."""
    f, zeta = typical(baseline.frequency), typical(baseline.damping)
    return model_causes(structure, baseline.labels, f, zeta, gravity=gravity, ground=ground, rotor=rotor)


def watch_after_baseline(baseline: History, arl_years: float, causes: ModelCauses | None) -> Watch:
    """Return the state at the end of a baseline, which also looks for a structure's causes."""
    if causes is None:
        return start(baseline, arl_years=arl_years)
    return start(
        baseline,
        arl_years=arl_years,
        patterns=causes.patterns(baseline.labels),
        slopes=causes.slopes(baseline.labels, baseline.condition_names),
    )


def _limits(watch: Watch, baseline: History, rest: History) -> list[str]:
    said = []
    kept = {mode for kind, mode in watch.quantities if kind == "frequency"}
    left = [label for q, label in enumerate(watch.labels) if q not in kept]
    if left:
        said.append(f"too few values in the baseline to be watched, or always the same: {', '.join(left)}")
    if len(kept) == 1:
        said.append("one mode only: what it shares with others cannot be told from a change of its own")
    used = {column.source for column in watch.design.columns}
    constant = [name for k, name in enumerate(baseline.condition_names) if k not in used]
    if constant:
        said.append(f"constant over the baseline or nearly empty, left out: {', '.join(constant)}")
    said += _gaps(watch, rest)
    span = float(np.ptp(baseline.days))
    if span < WHOLE_YEAR_DAYS:
        said.append(
            f"the baseline covers {span:.0f} days: what a season does and this time of the year did not show "
            "counts as a change"
        )
    return said


def _unseen(causes: ModelCauses, labels: Sequence[str]) -> list[str]:
    """Return the causes of a structure that these modes do not show."""
    said = [f"leaves no trace in these quantities: {', '.join(causes.traceless)}"]
    strange = [label for label in labels if label not in causes.labels]
    if strange:
        said.append(f"no mode of the structure, left out of the causes: {', '.join(strange)}")
    mixed = [label for label in labels if label in causes.mixed]
    if mixed:
        said.append(f"may mix with members' own modes, left out of the causes: {', '.join(mixed)}")
    return said


def _gaps(watch: Watch, rest: History) -> list[str]:
    """Return remarks on missing data of monitored rows."""
    if not rest.days.size:
        return []
    share = {c.name: np.mean(~np.isfinite(rest.conditions[:, c.source])) for c in watch.design.columns
             if c.source >= 0}  # fmt: skip
    said = [
        f"{name} is missing in {100.0 * x:.0f} % of the rows watched: there it counts as its mean"
        for name, x in share.items()
        if x > _MISSING
    ]
    unknown = ~np.isin(rest.states, watch.design.states)
    if unknown.any():
        names = ", ".join(rest.state_names[k] for k in np.unique(rest.states[unknown]))
        said.append(f"too little of it in the baseline, not judged: {names} ({int(unknown.sum())} rows)")
    return said


def _explained(
    watch: Watch, baseline: History
) -> tuple[dict[tuple[str, int], dict[str, float]], dict[tuple[str, int], float]]:
    rows, _ = regressors(watch.design, baseline, fresh(watch.design, baseline))
    explained: dict[tuple[str, int], dict[str, float]] = {}
    unexplained: dict[tuple[str, int], float] = {}
    for block in watch.blocks:
        values, _ = deviations(baseline, block.kind, block.kept, block.typical, block.std_power)
        keys = [(block.kind, int(q)) for q in block.kept]
        explained |= dict(zip(keys, shares(block, watch.design, rows, values), strict=True))
        unexplained |= dict(zip(keys, map(float, unexplained_std(block)), strict=True))
    return explained, unexplained
