"""Monitoring of the days of a twin's state.

The judgement of a day depends only on the days up to it: whatever the order in which records arrived
or the division of the work, equal states give equal judgements, bit for bit. What is stored between two
calls only saves time: if a late record changes a day, judgement is repeated from the end of the baseline.
The content of a day is loaded only when needed: after a quiet day, only that day.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, timedelta
from functools import cache
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.alarms import explained_alarm
from jackettwin.change.causes import ModelCauses, seen_causes
from jackettwin.change.following import Alarms, followed
from jackettwin.change.ground import UNDESCRIBED, Ground
from jackettwin.change.reversals import EarlierAlarm
from jackettwin.change.smallest_changes import (
    smallest_changes,
    smallest_documents,
    smallest_sentence,
)
from jackettwin.change.table_monitoring import structure_causes, watch_after_baseline
from jackettwin.change.watch_document import (
    alarm_document,
    likeliest,
    sizes_by_mode,
    verdict_words,
)
from jackettwin.change.working_rotor import WorkingRotor
from jackettwin.errors import InputError
from jackettwin.files import StoredSchema, digest, null_for_nan
from jackettwin.findings import Finding
from jackettwin.twin import UNDATED, UNIT, Day, TwinModel, TwinState, WaterConfig
from jackettwin.twin.config import WatchSettings
from jackettwin.twin.exact_sums import ModeSums
from jackettwin.twin.state import Operation
from jackettwin.watching import Change, History, PendingChange, Watch
from jackettwin.watching.watch import FEWEST_DAYS

EPOCH = date(1970, 1, 1)
_USUAL = WatchSettings()


@dataclass(frozen=True)
class JudgedDay:
    """Result of monitoring one day.

    Attributes
    ----------
    date : str
    ln_evidence : ln of the detection statistic
    rest, rest_std : (n_quantities,) daily means minus the part explained by conditions as believed before the
        day, and their standard deviations without a change, to seven decimals; NaN where the day has none
    """

    date: str
    ln_evidence: float
    rest: FloatArray
    rest_std: FloatArray


@dataclass(frozen=True)
class StoredMonitoring:
    """Stored monitoring results from one call to the next.

    Attributes
    ----------
    baseline_days, arl_years, relearn : the promise it was made with
    baseline, judged : fingerprints of the days of the baseline, and of those after it up to ``through``
    through : the last day that was judged; empty before the first one
    learnt, watch : at the end of the baseline, and after ``through``
    alarms : as documents, in the order of time
    columns : of the baseline
    pending : the last alarm's change, while it is looked at again
    looked : how it looked each time, as documents
    smallest : changes that would be found, as documents
    looks : what each day showed that was judged
    """

    baseline_days: float
    arl_years: float
    baseline: str = ""
    judged: str = ""
    through: str = UNDATED
    learnt: Watch | None = None
    watch: Watch | None = None
    alarms: tuple[Mapping[str, Any], ...] = ()
    relearn: str = UNDATED
    columns: Columns | None = None
    pending: PendingChange | None = None
    looked: tuple[Mapping[str, Any], ...] = ()
    smallest: tuple[Mapping[str, Any], ...] = ()
    looks: tuple[JudgedDay, ...] = ()

    @property
    def promise(self) -> tuple[float, float, str]:
        """Settings that must be unchanged to continue."""
        return self.baseline_days, self.arl_years, self.relearn


JUDGED = StoredSchema("twin_judged", StoredMonitoring)
"""Stored form of judgements."""


@dataclass(frozen=True)
class Days:
    """The days of a state.

    Attributes
    ----------
    identities : {date: identity of its content}
        Sorted.
    load : callable
        Returns the content of a day.
    """

    identities: Mapping[str, str]
    load: Callable[[str], Day]

    @classmethod
    def of(cls, state: TwinState) -> Days:
        """Return the days of a state held completely in memory."""
        return cls(_Identities(state.days), state.days.__getitem__)


@dataclass(frozen=True)
class _Identities(Mapping[str, str]):
    """Identities of days, made when they are asked for."""

    days: Mapping[str, Day]

    def __getitem__(self, date: str) -> str:
        return digest(self.days[date])

    def __iter__(self) -> Iterator[str]:
        return iter(self.days)

    def __len__(self) -> int:
        return len(self.days)


def judge(
    model: TwinModel,
    every: Days,
    kept: StoredMonitoring | None = None,
    settings: WatchSettings = _USUAL,
    ground: Ground = UNDESCRIBED,
    rotor: Callable[[], WorkingRotor | None] = lambda: None,
    water: WaterConfig | None = None,
) -> tuple[StoredMonitoring, tuple[Finding, ...]]:
    """Return the judgement of the days of a state, and new findings.

    The last day is omitted until a later one has begun, since it may be incomplete.

    Parameters
    ----------
    kept : what an earlier call returned; any of the same promise, it need not be of the same days
    settings : the promise; days before ``settings.relearn`` are left out
    ground : what is known of it, for the causes of a change
    rotor : returns the rotor at work, if the twin's records are of operation; called when causes are needed
    water : whose mass moves with the structure, if the structure's own has none of it
    """
    first = settings.relearn.isoformat() if settings.relearn else UNDATED
    fresh = StoredMonitoring(settings.baseline_days, settings.arl_years, relearn=first)
    kept = kept or fresh
    dates = [d for d in every.identities if d != UNDATED and d >= first][:-1]
    if not dates:
        return fresh if kept.promise != fresh.promise else kept, ()
    end = (date.fromisoformat(dates[0]) + timedelta(days=settings.baseline_days)).isoformat()
    before, after = [d for d in dates if d < end], [d for d in dates if d >= end]
    if not after or len(before) < FEWEST_DAYS:
        days = float(_number(dates[-1]) - _number(dates[0]) + 1)
        return fresh, (Finding("watch_learning", None, {"days": days, "needed": settings.baseline_days}),)
    known = _known(kept, fresh, every, before, after)
    findings = []
    columns = known.columns or Columns.of(model, every, before)
    baseline = cache(lambda: history_of(columns, every, before))  # a year of days, rarely needed
    causes = cache(lambda: _causes(model, baseline(), ground, rotor, water))  # takes seconds, rarely needed
    if known.learnt is None:
        watch = watch_after_baseline(baseline(), settings.arl_years, causes())
        known = replace(
            known, baseline=_fingerprint(every, before), learnt=watch, watch=watch, columns=columns,
            smallest=tuple(smallest_documents(smallest_changes(watch, baseline(), causes()))),
        )  # fmt: skip
        findings.append(Finding("watch_begins", None, {"from": end, "arl_years": settings.arl_years}))
    for day in (d for d in after if d > known.through):
        known = _day(known, baseline, history_of(columns, every, [day]), day, causes)
    known = replace(known, judged=_fingerprint(every, after))
    told = {alarm["time_utc"]: len(alarm.get("verdicts", ())) for alarm in kept.alarms}
    for alarm in known.alarms:
        findings += [finding_of(alarm)] if alarm["time_utc"] not in told else []
        findings += [f for _, f in corrections(alarm)[max(told.get(alarm["time_utc"], 1), 1) - 1 :]]
    return known, tuple(findings)


def _known(
    kept: StoredMonitoring, fresh: StoredMonitoring, every: Days, before: Sequence[str], after: Sequence[str]
) -> StoredMonitoring:
    """Return the stored results that are still valid."""
    if kept.promise != fresh.promise:
        return fresh
    if kept.learnt is None or kept.baseline != _fingerprint(every, before):
        return fresh
    if kept.judged != _fingerprint(every, [d for d in after if d <= kept.through]):
        return replace(kept, judged="", through=UNDATED, watch=kept.learnt, alarms=(), pending=None,
                       looked=(), looks=())  # fmt: skip
    return kept


def _causes(
    model: TwinModel,
    baseline: History,
    ground: Ground,
    rotor: Callable[[], WorkingRotor | None],
    water: WaterConfig | None,
) -> ModelCauses | None:
    """Return the possible causes; None without a structure or if its modes were not seen."""
    if model.assembly is None:
        return None
    try:
        return structure_causes(model.structure.structure, True, baseline, ground, rotor(), water)
    except InputError:
        return None


def _day(
    known: StoredMonitoring,
    baseline: Callable[[], History],
    day: History,
    name: str,
    causes: Callable[[], ModelCauses | None],
) -> StoredMonitoring:
    """Return the results after one more day."""
    if known.watch is None or not day.days.size:
        return replace(known, through=name)

    def told(watch: Watch, change: Change, past: Sequence[EarlierAlarm]) -> Mapping[str, Any]:
        of = causes()
        seen = None if of is None else seen_causes(of, watch.quantities, watch.labels)
        return alarm_document(watch, _time, explained_alarm(change, watch, baseline(), seen, past))

    before = Alarms(known.alarms, known.pending, known.looked)
    watch, alarms, look = followed(known.watch, before, day, told, _time)
    shown = JudgedDay(name, round(look.log_r, 4), np.round(look.rest, 7), np.round(look.rest_std, 7))
    return replace(
        known, watch=watch, through=name, alarms=alarms.documents, pending=alarms.pending,
        looked=alarms.looked, looks=(*known.looks, shown),
    )  # fmt: skip


def monitoring_document(judged: StoredMonitoring) -> dict[str, Any]:
    """Return what the judged days showed as plain data, quantity by quantity; empty before the first.

    ``rest`` is what conditions do not explain, ``rest_std`` its standard deviation while nothing changes;
    ``smallest`` are changes that would be found, and the step of each quantity by them.
    """
    if judged.watch is None:
        return {}
    rest, std = (np.array([getattr(one, name) for one in judged.looks]) for name in ("rest", "rest_std"))
    return {
        "arl_years": judged.arl_years,
        "threshold_ln": judged.watch.log_threshold,
        "days": [one.date for one in judged.looks],
        "ln_evidence": [one.ln_evidence for one in judged.looks],
        "quantities": [
            {
                "label": judged.watch.labels[mode],
                "kind": kind,
                "rest": null_for_nan(rest[:, i].tolist()),
                "rest_std": null_for_nan(std[:, i].tolist()),
            }
            for i, (kind, mode) in enumerate(judged.watch.quantities)
            if judged.looks
        ],
        "smallest": [dict(one) for one in judged.smallest],
    }


_NAMED = 0.01
"""Smallest probability of a cause that a finding names."""


def finding_of(alarm: Mapping[str, Any]) -> Finding:
    """Return the finding on an alarm: one that is known already asks for less than a new one."""
    low, high = alarm["size_interval_90"]
    began_low, began_high = (text[:10] for text in alarm["began_interval_90"])
    params = {
        "time_utc": alarm["time_utc"], "began": alarm["began_utc"][:10], "began_low": began_low,
        "began_high": began_high, "size": alarm["size"], "low": low, "high": high,
        "cause": alarm["verdicts"][-1]["cause"], "probability": alarm["verdicts"][-1]["probability"],
        "said": likeliest(alarm), "by_mode": sizes_by_mode(alarm),
        "causes": {of["cause"]: of["probability"] for of in alarm["causes"] if of["probability"] >= _NAMED},
    }  # fmt: skip
    return Finding(_code(alarm), ", ".join(alarm["quantities"]), params)


def _code(alarm: Mapping[str, Any]) -> str:
    """Return the code of an alarm: that of a known change if it was taken for one from the first day on."""
    if alarm["verdicts"][-1]["cause"].startswith("sensor") or alarm["kind"] == "scatter":
        return "sensor_changed"
    for way, code in (("takes_back_utc", "change_taken_back"), ("again_utc", "change_again")):
        if alarm.get(way) and (alarm["at_alarm"] or alarm).get(way):
            return code
    return "structure_turned" if alarm.get("unit") == "deg" else "structure_changed"


def sight_of(judged: StoredMonitoring) -> Finding | None:
    """Return the finding on the smallest changes that would be found, if they are known."""
    said = smallest_sentence([dict(one) for one in judged.smallest])
    return Finding("watch_sees", None, {"said": said}) if said else None


def corrections(alarm: Mapping[str, Any]) -> tuple[tuple[str, Finding], ...]:
    """Return when the change of an alarm was given another cause than before, and the finding on it."""
    found = []
    for was, now in itertools.pairwise(alarm.get("verdicts", ())):
        params = {
            "alarm": alarm["time_utc"][:10], "was": verdict_words(was), "now": verdict_words(now),
        }  # fmt: skip
        found.append((now["time_utc"], Finding("cause_corrected", ", ".join(alarm["quantities"]), params)))
    return tuple(found)


def _fingerprint(every: Days, dates: Sequence[str]) -> str:
    """Return the identity of some days."""
    return digest([(day, every.identities[day]) for day in dates])


def _number(day: str) -> int:
    return (date.fromisoformat(day) - EPOCH).days


def _time(day: float) -> datetime:
    return datetime(1970, 1, 1, tzinfo=UTC) + timedelta(days=day)


@dataclass(frozen=True)
class Columns:
    """Columns of a history as in the baseline, so that later days are arranged alike.

    ``numbers`` are those of the modes that were seen, in the order of ``labels``.
    """

    numbers: tuple[int, ...]
    labels: tuple[str, ...]
    conditions: tuple[str, ...]
    kinds: tuple[str, ...]

    @classmethod
    def of(cls, model: TwinModel, every: Days, dates: Sequence[str]) -> Columns:
        """Return the modes, conditions and states of operation of some days."""
        operations = [item for d in dates for item in every.load(d).operations.items()]
        numbers = sorted({n for _, o in operations for n, sums in o.modes.items() if sums.known})
        named = dict(enumerate(model.labels, start=1))
        return cls(
            tuple(numbers),
            tuple(named.get(n, f"mode_{n}") for n in numbers),
            ("wind_m_s", "wave_height_m", *sorted({name for _, o in operations for name in o.beside})),
            tuple(sorted({_kind(name) for name, _ in operations})),
        )


def history_of(columns: Columns, every: Days, dates: Sequence[str]) -> History:
    """Return days as rows of modes: one for each day and state of operation."""
    rows = [
        (_noon(_number(d), day), _kind(name), operation)
        for d, day in ((d, every.load(d)) for d in dates)
        for name, operation in day.operations.items()
        if any(sums.known for sums in operation.modes.values())
    ]
    values = np.full((6, len(rows), len(columns.labels)), np.nan)
    beside = np.full((len(rows), len(columns.conditions)), np.nan)
    for i, (_, _, operation) in enumerate(rows):
        for number, sums in operation.modes.items():
            if sums.known and number in columns.numbers:
                values[:4, i, columns.numbers.index(number)] = _means(sums)
        for number, angle in operation.angles.items():
            if angle.w and number in columns.numbers:
                values[4:, i, columns.numbers.index(number)] = angle.mean
        beside[i] = [_condition(operation, name) for name in columns.conditions]
    new = len(columns.kinds)
    states = [columns.kinds.index(kind) if kind in columns.kinds else new for _, kind, _ in rows]
    return History(
        np.array([at for at, *_ in rows]), columns.labels, values[0], values[1], values[2], values[3],
        beside, columns.conditions,
        np.array(states, dtype=np.intp), columns.kinds, values[4], values[5],
    )  # fmt: skip


def _noon(number: int, day: Day) -> float:
    """Return the middle of a day's records [days]."""
    middle = day.time_utc
    return number + 0.5 if middle is None else (middle.timestamp() / 86400.0)


def _kind(operation: str) -> str:
    """Return a state of operation without its bin of wind speed, which is a condition."""
    words = [word for word in operation.split(", ") if not word.endswith(" m/s")]
    return ", ".join(words) or "unknown"


def _means(s: ModeSums) -> tuple[float, float, float, float]:
    """Return frequency, its standard deviation, damping ratio and its own, as the records state them."""
    zeta = s.qz / s.q
    typical = np.exp(s.log_ratio / UNIT / s.known)
    f = float(np.exp(s.px / s.p))
    return f, f * np.sqrt(zeta * UNIT / s.p), zeta, zeta * np.sqrt(typical * UNIT / (zeta * s.q))


def _condition(operation: Operation, name: str) -> float:
    known = operation.conditions
    if name == "wind_m_s":
        return np.nan if known.wind_m_s is None else known.wind_m_s
    if name == "wave_height_m":
        return np.nan if known.waves is None else known.waves[0]
    n, total = operation.beside.get(name, (0, 0))
    return total / UNIT / n if n else np.nan
