"""Alarms as plain data, and in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from typing import Any

import numpy as np

from jackettwin.change.alarms import Alarm, likeliest_of
from jackettwin.intervals import NORMAL_90
from jackettwin.watching import CLEAR, UNEXPLAINED, CauseVerdict, Watch

_TURNED = 3.0
"""Odds at which another cause corrects the one that was named: substantial evidence (Jeffreys 1961)."""
_NAMED, _LIKELY = 3, 0.001
"""Number of causes in a sentence if none is clear, and the smallest probability of a listed cause."""


def with_later_look(before: Mapping[str, Any], later: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document of an alarm that was looked at again.

    Its size, begin and causes are those of the later look; its time and evidence stay those of the alarm.
    ``verdicts`` holds what was called likeliest, from when on; the last is today's. A look corrects another
    if either was clear and they name no cause together, and what was named is now ``_TURNED`` times less
    likely: two causes that stay about equal would correct each other with every look. Until then what was
    named stays, as likely as it is now. ``at_alarm`` is the document of the alarm's day.
    """
    *earlier, was = before["verdicts"]
    now = later["verdicts"][-1]
    left = sum(one["probability"] for one in later["causes"] if one["cause"] in was["named"])
    apart = set(was["named"]).isdisjoint(now["named"])
    stays = apart and now["probability"] < _TURNED * left
    turned = apart and not stays and max(was["probability"], now["probability"]) >= CLEAR
    told = {**was, "probability": left} if stays else {**now, "time_utc": was["time_utc"]}
    first = before["at_alarm"] or {key: value for key, value in before.items() if key != "at_alarm"}
    return {
        **later,
        "time_utc": before["time_utc"],
        "ln_evidence": before["ln_evidence"],
        "at_alarm": first,
        "verdicts": [*earlier, *([was, now] if turned else [told])],
    }


def alarm_document(watch: Watch, time: Callable[[float], datetime], alarm: Alarm) -> dict[str, Any]:
    """Return an alarm as plain data as it looks on a day; ``time`` gives the time of a day number."""
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
    answered = {} if alarm.answer is None else {alarm.answer.way: alarm.answer.time_utc}
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
                "time_utc": time(change.day).isoformat(),
                "cause": one_of([one.cause for one in named]),
                "probability": sum(one.probability for one in named),
                "named": [one.cause for one in named],
            }
        ],
        "takes_back_utc": answered.get("takes_back"),
        "again_utc": answered.get("again"),
        "causes": [_cause(v) for v in alarm.diagnosis.verdicts if v.probability > _LIKELY],
        "inseparable": [list(group) for group in alarm.diagnosis.inseparable],
        "explained": None if np.isnan(diagnosis.explained) else diagnosis.explained,
        "next_measurements": [
            {key: value or None for key, value in asdict(m).items()}
            | {"gain_nats": m.gain_nats, "share_of_doubt": min(m.gain_nats / _doubt(alarm), 1.0)}
            for m in alarm.next_measurements
        ],
        "ln_evidence": change.log_r,
    }


def one_of(names: Sequence[str]) -> str:
    """Return a cause, or that it is one of several, of many the first."""
    told = [*names[:_NAMED], f"{len(names) - _NAMED} more"] if len(names) > _NAMED + 1 else list(names)
    return f"one of {', '.join(told)}" if told[1:] else told[0]


def verdict_words(verdict: Mapping[str, Any], day: str = "") -> str:
    """Return a verdict with its probability, that of all it names together, and the day it was given."""
    together = "together " if len(verdict["named"]) > 1 else ""
    since = f", {day}" if day else ""
    unclear = "" if verdict["probability"] >= CLEAR else "not clear, rather "
    return f"{unclear}{one_of(verdict['named'])} ({together}{100.0 * verdict['probability']:.0f} %{since})"


def alike_sentence(alarm: Mapping[str, Any]) -> str:
    """Return which members an alarm's likeliest cause stands for beside the one it names; empty if none."""
    best = alarm["causes"][0]
    return f"{best['cause']}: does the same as {', '.join(best['alike'])}" if best["alike"] else ""


def corrected_sentence(alarm: Mapping[str, Any]) -> str:
    """Return what the change of an alarm was called before and is called now; empty if it is the same."""
    *was, now = alarm["verdicts"]
    if not was:
        return ""
    told = ", then ".join(verdict_words(v, v["time_utc"][:10]) for v in was)
    return f"was: {told}; now: {verdict_words(now, now['time_utc'][:10])}"


def _doubt(alarm: Alarm) -> float:
    """Return the entropy of the causes [nats]."""
    p = np.array([v.probability for v in alarm.diagnosis.verdicts if v.probability > 0.0])
    return max(float(-p @ np.log(p)), 1e-12)


def next_sentence(alarm: Mapping[str, Any]) -> str:
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
    now, explained = alarm["verdicts"][-1], alarm.get("explained")
    if now["probability"] >= CLEAR:
        all_of_it = explained is None or explained >= UNEXPLAINED
        beyond = "" if all_of_it else ", which does not explain all of it: perhaps more than one change"
        return f"most likely {verdict_words(now)}{beyond}"
    named = [f"{one['cause']} ({100.0 * one['probability']:.0f} %)" for one in alarm["causes"][:_NAMED]]
    return f"cause not clear: {', '.join(named)}"


def chains(alarms: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """Return alarms of which nothing is known with the ones that take them back or are the same again."""
    of: dict[str, list[Mapping[str, Any]]] = {}
    for alarm in alarms:
        earlier = alarm.get("takes_back_utc") or alarm.get("again_utc")
        of[alarm["time_utc"]] = chain = of.get(earlier or "", [])
        chain.append(alarm)
    return list({id(chain): chain for chain in of.values()}.values())


def alarm_sentence(chain: Sequence[Mapping[str, Any]]) -> str:
    """Return the sentence on a change, and on when it was taken back and came again."""
    first, *more = chain
    what = "scatter of" if first["kind"] == "scatter" else "change of"
    low, high = (time[:10] for time in first["began_interval_90"])
    corrected = corrected_sentence(first)
    return (
        f"{first['time_utc'][:10]}: {what} {sizes_by_mode(first)}, began {first['began_utc'][:10]} "
        f"({low} to {high}); {likeliest(first)}{f'; {corrected}' if corrected else ''}{_went(more)}."
    )


def _went(more: Sequence[Mapping[str, Any]]) -> str:
    """Return when a change was taken back and came again, in words."""
    if not more:
        return ""
    told = [
        f"{'taken back' if one['takes_back_utc'] else 'again from'} {one['began_utc'][:10]}"
        f"{'' if one['takes_back_utc'] else ' on'} ({_sure(one)})"
        for one in more
    ]
    why = (
        "it comes and goes, like ice or a state of operation without a column"
        if len(more) > 1
        else "as by a repair, or a mass that comes and goes"
    )
    return f"; {', '.join(told)}: {why}"


def _sure(alarm: Mapping[str, Any]) -> str:
    return f"{100.0 * alarm['verdicts'][-1]['probability']:.0f} %"
