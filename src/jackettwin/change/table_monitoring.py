"""Monitoring of a table of modes: baseline, daily evaluation, changes and their causes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.change.alarms import Alarm, explained_alarm
from jackettwin.change.causes import ModelCauses, model_causes, seen_causes
from jackettwin.change.following import Alarms, followed
from jackettwin.change.ground import UNDESCRIBED, Ground
from jackettwin.change.modal_table import ModalTable
from jackettwin.change.reversals import EarlierAlarm
from jackettwin.change.smallest_changes import SmallestChange, smallest_changes, smallest_documents
from jackettwin.change.watch_document import alarm_document, alarm_sentence, chains, quantity_name
from jackettwin.change.working_rotor import WorkingRotor
from jackettwin.errors import InputError
from jackettwin.structure import Structure
from jackettwin.twin import WaterConfig
from jackettwin.watching import (
    Change,
    History,
    Look,
    Watch,
    fresh,
    regressors,
    start,
    typical,
    unexplained_std,
    unseen_share,
)
from jackettwin.watching.condition_effects import shares, slopes
from jackettwin.watching.design import WHOLE_YEAR_DAYS
from jackettwin.watching.history import deviations
from jackettwin.watching.watch import columns_to_watch

_MISSING = 0.1
"""Share of missing values of a condition above which a remark is given."""


@dataclass(frozen=True)
class MonitoredTable:
    """A monitored table of modes.

    Attributes
    ----------
    baseline_days : (first, last) day of the baseline
    watch : the state after the last day
    looks : of each day with records after the baseline
    alarms, documents : each as it looks at last, and as plain data
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
    documents: tuple[Mapping[str, Any], ...]
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
    water: WaterConfig | None = None,
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
    water : whose mass moves with the structure, if the structure's own has none of it
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
    causes = (
        None if structure is None else structure_causes(structure, gravity, baseline, ground, rotor, water)
    )
    progress("baseline")
    watch = watch_after_baseline(baseline, arl_years, causes)
    smallest = smallest_changes(watch, baseline, causes)
    limits += _limits(watch, baseline, rest)
    explained, unexplained = _explained(watch, baseline)
    seen = None if causes is None else seen_causes(causes, watch.quantities, watch.labels)
    limits += [] if causes is None else _unseen(causes, watch.labels)
    looks: list[Look] = []
    alarms, seen_then = Alarms(), dict[tuple[int, str], Alarm]()

    def tell(watch: Watch, change: Change, past: Sequence[EarlierAlarm]) -> Mapping[str, Any]:
        alarm = explained_alarm(change, watch, baseline, seen, past)
        document = alarm_document(watch, table.time, alarm)
        seen_then[len(past), document["looked_utc"]] = alarm
        return document

    for day in rest.by_day():
        progress(f"{table.time(float(day.days[0])):%Y-%m}")
        watch, alarms, look = followed(watch, alarms, day, tell, table.time)
        looks.append(look)
    found = [one for block in watch.blocks for one in slopes(block, watch.design)]
    per_unit: dict[tuple[str, int], dict[str, float]] = dict(zip(watch.quantities, found, strict=True))
    return MonitoredTable(
        table,
        (first, end),
        watch,
        tuple(looks),
        tuple(seen_then[number, one["looked_utc"]] for number, one in enumerate(alarms.documents)),
        alarms.documents,
        explained,
        unexplained,
        tuple(limits),
        per_unit,
        smallest,
    )


def watched_document(watched: MonitoredTable) -> dict[str, Any]:
    """Return a judged table as plain data; sizes are relative changes, times UTC."""
    table = watched.table
    first, end = watched.baseline_days
    return {
        "name": table.name,
        "statement": statement(watched),
        "alarms": list(watched.documents),
        "reversals": [
            {key: alarm[key] for key in ("time_utc", "takes_back_utc")}
            for alarm in watched.documents
            if alarm["takes_back_utc"]
        ],
        "quantities": {
            quantity_name(watched.watch, key): {
                "explained_by": dict(watched.explained[key]),
                "per_unit": dict(watched.slopes[key]),
                "unexplained_std": watched.unexplained_std[key],
            }
            for key in watched.watch.quantities
        },
        "windows": int(table.history.days.size),
        "days_watched": len(watched.looks),
        "arl_years": watched.watch.arl_years,
        "baseline_utc": [table.time(first).isoformat(), table.time(end).isoformat()],
        "threshold_ln": watched.watch.log_threshold,
        "evidence": [
            {"time_utc": table.time(look.day).isoformat(), "ln_evidence": look.log_r}
            for look in watched.looks
        ],
        "smallest_found": smallest_documents(watched.smallest),
        "limits": list(watched.limits),
    }


def statement(watched: MonitoredTable) -> str:
    """Return the outcome in a sentence."""
    table = watched.table
    if not watched.looks:
        return "Nothing is watched yet: the table ends with its baseline."
    if not watched.documents:
        last = table.time(watched.looks[-1].day)
        return (
            f"No change found in {len(watched.looks)} days with records up to {last:%Y-%m-%d}; a false alarm "
            f"is expected once in {watched.watch.arl_years:g} years or more rarely."
        )
    return " ".join(alarm_sentence(chain) for chain in chains(watched.documents))


def structure_causes(
    structure: Structure,
    gravity: bool,
    baseline: History,
    ground: Ground,
    rotor: WorkingRotor | None,
    water: WaterConfig | None,
) -> ModelCauses:
    """Return the possible causes for a structure with these modes."""
    f, zeta = typical(baseline.frequency), typical(baseline.damping)
    return model_causes(
        structure, baseline.labels, f, zeta, gravity=gravity, ground=ground, rotor=rotor, water=water
    )


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
            f"the baseline covers {span:.0f} days: what another season does may count as a change, as far as "
            "air temperature, storms and growth do not explain it"
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
    limit = np.full(rest.conditions.shape[1], np.inf) if watch.usual is None else watch.usual.still_after
    unseen = unseen_share(rest, limit)
    share = {c.name: unseen[c.source] for c in watch.design.columns if c.source >= 0}
    said = [
        f"{name} is missing or always the same in {100.0 * x:.0f} % of the rows watched: there its effect is "
        "unknown, and a change takes longer to be found"
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
