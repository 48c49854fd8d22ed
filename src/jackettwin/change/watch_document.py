"""JSON output of ``jackettwin watch``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from functools import reduce
from typing import Any

import numpy as np

from jackettwin.change.reversals import taken_back
from jackettwin.change.smallest_changes import smallest_documents
from jackettwin.change.table_monitoring import Alarm, MonitoredTable
from jackettwin.intervals import NORMAL_90
from jackettwin.watching import CLEAR, CauseVerdict, Diagnosis, Watch

_NAMED, _LIKELY = 3, 0.001
"""Number of causes in a sentence if none is clear, and the smallest probability of a listed cause."""
_WITH = 0.05
"""Smallest probability of a cause that is named with one from which the data do not distinguish it."""


def watched_document(watched: MonitoredTable) -> dict[str, Any]:
    """Return a judged table as plain data; sizes are relative changes, times UTC."""
    table = watched.table
    first, end = watched.baseline_days
    alarms = [alarm_document(watched.watch, table.time, alarm) for alarm in watched.alarms]
    return {
        "name": table.name,
        "statement": statement(watched),
        "alarms": alarms,
        "reversals": [
            {"time_utc": alarms[j]["time_utc"], "takes_back_utc": alarms[i]["time_utc"]}
            for j, i in enumerate(taken_back(alarms))
            if i is not None
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


def alarm_document(watch: Watch, time: Callable[[float], datetime], alarm: Alarm) -> dict[str, Any]:
    """Return an alarm as plain data as it looks now; ``time`` gives the time of a day number."""
    looks = [_looked_document(watch, time, one) for one in (*alarm.earlier, alarm)]
    return reduce(with_later_look, looks)


def with_later_look(before: Mapping[str, Any], later: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document of an alarm that was looked at again.

    Its size, begin and causes are those of the later look; its time and evidence stay those of the alarm.
    ``verdicts`` holds what was called likeliest, from when on; the last is today's. A look corrects another
    if either was clear and they name no cause together. ``at_alarm`` is the document of the alarm's day.
    """
    *earlier, was = before["verdicts"]
    now = later["verdicts"][-1]
    same = not set(was["named"]).isdisjoint(now["named"])
    same |= max(was["probability"], now["probability"]) < CLEAR
    first = before["at_alarm"] or {key: value for key, value in before.items() if key != "at_alarm"}
    return {
        **later,
        "time_utc": before["time_utc"],
        "ln_evidence": before["ln_evidence"],
        "at_alarm": first,
        "verdicts": [*earlier, *([{**now, "time_utc": was["time_utc"]}] if same else [was, now])],
    }


def _looked_document(watch: Watch, time: Callable[[float], datetime], alarm: Alarm) -> dict[str, Any]:
    change, diagnosis = alarm.change, alarm.diagnosis
    named = likeliest_of(diagnosis)
    low, high = change.began_interval_90
    names = [quantity_name(watch, key) for key in watch.quantities]
    members = np.flatnonzero(change.members)
    moved = {
        name: _sized(change.size[i], change.size_std[i], _unit(change.kind, kind))
        for i, (name, (kind, _)) in enumerate(zip(names, watch.quantities, strict=True))
    }
    lead = members[np.argmax(change.by_mode[members])]
    return {
        "time_utc": time(change.day).isoformat(),
        "looked_utc": time(change.day).isoformat(),
        "began_utc": time(change.began).isoformat(),
        "began_interval_90": [time(low).isoformat(), time(high).isoformat()],
        "kind": change.kind,
        "quantities": [names[i] for i in members],
        "size": moved[names[lead]]["size"],
        "size_interval_90": moved[names[lead]]["interval_90"],
        "unit": moved[names[lead]]["unit"],
        "by_quantity": moved,
        "at_alarm": None,
        "verdicts": [
            {
                "time_utc": time(change.day if alarm.told is None else alarm.told).isoformat(),
                "cause": either([one.cause for one in named]),
                "probability": sum(one.probability for one in named),
                "named": [one.cause for one in named],
            }
        ],
        "causes": [_cause(v) for v in alarm.diagnosis.verdicts if v.probability > _LIKELY],
        "inseparable": [list(group) for group in alarm.diagnosis.inseparable],
        "next_measurements": [
            {key: value or None for key, value in asdict(m).items()}
            | {"gain_nats": m.gain_nats, "share_of_doubt": min(m.gain_nats / _doubt(alarm), 1.0)}
            for m in alarm.next_measurements
        ],
        "ln_evidence": change.log_r,
    }


def likeliest_of(diagnosis: Diagnosis) -> tuple[CauseVerdict, ...]:
    """Return the likeliest cause, with those that the data do not distinguish from it unless it is clear.

    Softer soil at 41 % is no verdict where scour of all feet has 29 % and of one 18 %.
    """
    best, *others = diagnosis.verdicts
    if best.probability >= CLEAR:
        return (best,)
    group = next((group for group in diagnosis.inseparable if best.cause in group), ())
    return (best, *(one for one in others if one.cause in group and one.probability >= _WITH))


def either(names: Sequence[str]) -> str:
    """Return names with "or" before the last one, of many the first."""
    told = [*names[:_NAMED], f"{len(names) - _NAMED} more"] if len(names) > _NAMED + 1 else list(names)
    return " or ".join([", ".join(told[:-1]), told[-1]]) if told[1:] else told[0]


def alike_sentence(alarm: Mapping[str, Any]) -> str:
    """Return which members an alarm's likeliest cause stands for beside the one it names; empty if none."""
    best = alarm["causes"][0]
    return f"{best['cause']}: does the same as {', '.join(best['alike'])}" if best["alike"] else ""


def corrected_sentence(alarm: Mapping[str, Any]) -> str:
    """Return what the change of an alarm was called before and is called now; empty if it is the same."""
    *was, now = alarm["verdicts"]
    if not was:
        return ""
    told = ", then ".join(f"{v['cause']} ({v['probability']:.0%}, {v['time_utc'][:10]})" for v in was)
    return f"was: {told}; now: {now['cause']} ({now['probability']:.0%}, {now['time_utc'][:10]})"


def _doubt(alarm: Alarm) -> float:
    """Return the entropy of the causes [nats]."""
    p = np.array([v.probability for v in alarm.diagnosis.verdicts if v.probability > 0.0])
    return max(float(-p @ np.log(p)), 1e-12)


def next_sentence(alarm: dict[str, Any]) -> str:
    """Return the sentence on the next measurement of an alarm's document, empty if there is none."""
    told = [f"{m['what']} ({100.0 * m['share_of_doubt']:.0f} %)" for m in alarm["next_measurements"]]
    if not told:
        return ""
    return f"Would tell the causes apart, by the share of the doubt that it settles: {'; '.join(told)}."


def _unit(change: str, kind: str) -> str:
    """Return the unit of the change of a quantity: degrees for pairs, a relative change for others."""
    return "deg" if kind == "angle" and change != "scatter" else "-"


def _sized(size: float, std: float, unit: str) -> dict[str, Any]:
    ends = np.array([size - NORMAL_90 * std, size, size + NORMAL_90 * std])
    low, mid, high = map(float, np.degrees(ends) if unit == "deg" else np.expm1(ends))
    return {"size": mid, "interval_90": [low, high], "unit": unit}


def sizes_by_mode(alarm: Mapping[str, Any]) -> str:
    """Return by how much each quantity of an alarm's document changed, with its interval, in words."""
    return ", ".join(f"{name} by {_sized_words(alarm['by_quantity'][name])}" for name in alarm["quantities"])


def _sized_words(sized: Mapping[str, Any]) -> str:
    """Return a size with its interval, in words."""
    low, high = sized["interval_90"]
    scale, unit = (1.0, "°") if sized["unit"] == "deg" else (100.0, " %")
    return f"{scale * sized['size']:+.2f}{unit} ({scale * low:+.2f} to {scale * high:+.2f}{unit})"


def _cause(verdict: CauseVerdict) -> dict[str, Any]:
    sized = not np.isnan(verdict.size)
    return asdict(verdict) | {
        "interval_90": list(verdict.interval_90) if sized else None, "alike": list(verdict.alike)
    }  # fmt: skip


def quantity_name(watch: Watch, key: tuple[str, int]) -> str:
    """Return the name of a monitored quantity."""
    kind, mode = key
    return watch.labels[mode] + {"frequency": "", "damping": " damping", "angle": " direction"}[kind]


def likeliest(alarm: Mapping[str, Any]) -> str:
    """Return the likeliest cause of an alarm's document in words, or the first few if none is clear."""
    now = alarm["verdicts"][-1]
    if now["probability"] >= CLEAR:
        return f"most likely {now['cause']} ({100.0 * now['probability']:.0f} %)"
    named = [f"{one['cause']} ({100.0 * one['probability']:.0f} %)" for one in alarm["causes"][:_NAMED]]
    return f"cause not clear: {', '.join(named)}"


def statement(watched: MonitoredTable) -> str:
    """Return the outcome in a sentence."""
    table = watched.table
    if not watched.looks:
        return "Nothing is watched yet: the table ends with its baseline."
    if not watched.alarms:
        last = table.time(watched.looks[-1].day)
        return (
            f"No change found in {len(watched.looks)} days with records up to {last:%Y-%m-%d}; a false alarm "
            f"is expected once in {watched.watch.arl_years:g} years or more rarely."
        )
    parts = []
    documents = [alarm_document(watched.watch, table.time, alarm) for alarm in watched.alarms]
    earlier = taken_back(documents)
    for alarm, doc, back in zip(watched.alarms, documents, earlier, strict=True):
        change = alarm.change
        what = "scatter of" if change.kind == "scatter" else "change of"
        began = [table.time(day) for day in (change.began, *change.began_interval_90)]
        parts.append(
            f"{table.time(alarm.day):%Y-%m-%d}: {what} {sizes_by_mode(doc)}, began "
            f"{began[0]:%Y-%m-%d} ({began[1]:%Y-%m-%d} to {began[2]:%Y-%m-%d}); {likeliest(doc)}"
            f"{f'; {corrected}' if (corrected := corrected_sentence(doc)) else ''}"
            f"{'' if back is None else f'; takes back the change of {_alarmed(watched, back)}'}."
        )
    times = sum(back is not None for back in earlier)
    if times > 1:
        parts.append(
            f"{times} changes came and went: a mass such as ice, or a state of operation without a column."
        )
    return " ".join(parts)


def _alarmed(watched: MonitoredTable, index: int) -> str:
    return f"{watched.table.time(watched.alarms[index].day):%Y-%m-%d}"
