"""A change that is looked at again: what it was called, and what it is called now."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from observations import BEGUN, seen
from tests.change.test_judge import CHANGED, MODEL, SIXTY, days_of

from jackettwin.change import corrections, following
from jackettwin.change.alarms import likeliest_of
from jackettwin.change.following import Alarms, followed
from jackettwin.change.judge import JUDGED, StoredMonitoring, judge
from jackettwin.change.watch_document import (
    corrected_sentence,
    likeliest,
    one_of,
    verdict_words,
    with_later_look,
)
from jackettwin.watching import CauseVerdict, Diagnosis, PendingChange


def document(
    time: str, cause: str, size: float, probability: float = 0.9, named: tuple[str, ...] = ()
) -> dict[str, object]:
    verdict = {"time_utc": time, "cause": cause, "probability": probability, "named": list(named or (cause,))}
    return {
        "time_utc": time, "verdicts": [verdict], "causes": [verdict], "size": size, "ln_evidence": size,
        "quantities": ["bending_1"], "at_alarm": None,
    }  # fmt: skip


def test_another_cause_corrects_the_first_and_the_same_does_not() -> None:
    looks = [
        document("2025-03-01", "sensor: more scatter", 1.0),
        document("2025-03-02", "sensor: more scatter", 2.0),
        document("2025-03-04", "brace_1 lost", 3.0),
        document("2025-03-09", "brace_1 lost", 4.0),
    ]
    found = looks[0]
    for later in looks[1:]:
        found = with_later_look(found, later)
    assert (found["time_utc"], found["ln_evidence"], found["size"]) == ("2025-03-01", 1.0, 4.0)
    assert {**found["at_alarm"], "at_alarm": None} == looks[0]
    ((at, finding),) = corrections(found)
    assert at == "2025-03-04" and finding.code == "cause_corrected"
    assert "was: sensor: more scatter (90 %); now: brace_1 lost (90 %)" in str(finding)
    said = corrected_sentence(found)
    assert said == "was: sensor: more scatter (90 %, 2025-03-01); now: brace_1 lost (90 %, 2025-03-04)"
    assert not corrected_sentence(looks[0]) and not corrections(looks[0])


def test_what_was_never_clear_or_is_not_distinguished_is_no_correction() -> None:
    """The demonstration said in turn one foot, a clock, a foot, growth and soil, at 15 to 44 % each."""
    soil = document("2025-03-09", "soil softening or scour", 4.0, 0.9, ("soil softening", "scour"))
    found = document("2025-03-01", "scour", 1.0, 0.2)
    for later in (document("2025-03-02", "sensor: clock", 2.0, 0.3), soil):
        found = with_later_look(found, later)
    (was, now) = found["verdicts"]
    assert (was["cause"], now["cause"]) == ("sensor: clock", "soil softening or scour")
    found = with_later_look(soil, document("2025-03-10", "scour", 5.0, 0.8))
    (one,) = found["verdicts"]
    assert (one["cause"], one["probability"], one["time_utc"]) == ("scour", 0.8, "2025-03-09")


def test_two_causes_that_stay_about_equal_do_not_correct_each_other() -> None:
    """Ice that came again was told as that, as a mass, as ice and as a mass within a month, at 50 to 56 %."""

    def look(time: str, again: float) -> dict[str, object]:
        named = sorted({"again": again, "mass": 1.0 - again}.items(), key=lambda one: -one[1])
        found = document(time, named[0][0], 1.0, named[0][1])
        return {**found, "causes": [{"cause": cause, "probability": p} for cause, p in named]}

    found = look("2025-03-01", 0.56)
    for time, again in (
        ("2025-03-02", 0.45),
        ("2025-03-03", 0.42),
        ("2025-03-04", 0.55),
        ("2025-03-06", 0.4),
    ):
        found = with_later_look(found, look(time, again))
        (one,) = found["verdicts"]
        assert (one["cause"], one["probability"]) == ("again", again)
    assert likeliest(found) == "cause not clear: mass (60 %), again (40 %)"
    one = look("2025-03-01", 0.86)
    assert likeliest({**one, "explained": 0.03}) == likeliest(one) == "most likely again (86 %)"
    assert likeliest({**one, "explained": 0.01}).endswith("perhaps more than one change")
    found = with_later_look(found, look("2025-03-09", 0.2))
    was, now = found["verdicts"]
    assert (was["cause"], now["cause"], now["time_utc"]) == ("again", "mass", "2025-03-09")


def test_causes_that_are_not_distinguished_are_named_together() -> None:
    verdict = partial(CauseVerdict, size=1.0, interval_90=(0.5, 2.0), unit="-")
    soil, all_feet, foot, growth = (
        verdict(name, p)
        for name, p in (
            ("soil softening", 0.41),
            ("scour", 0.29),
            ("scour at foot_1", 0.18),
            ("growth", 0.12),
        )
    )
    group = ("soil softening", "scour", "scour at foot_1")
    found = likeliest_of(Diagnosis((soil, all_feet, foot, growth), (group,)))
    assert [one.cause for one in found] == list(group)
    clear = replace(soil, probability=0.6)
    assert likeliest_of(Diagnosis((clear, all_feet), (group,))) == (clear,)
    assert one_of(["a"]) == "a" and one_of(["a", "b"]) == "one of a, b"
    assert one_of(list("abcdef")) == "one of a, b, c, 3 more" and one_of(list("abcd")) == "one of a, b, c, d"
    soft = {"named": list(group), "probability": 0.88}
    assert verdict_words(soft) == "one of soil softening, scour, scour at foot_1 (together 88 %)"


def test_a_later_look_knows_a_change_better() -> None:
    """The interval of its size shrinks as days come; the alarm stays where it was."""
    early = judge(MODEL, days_of(CHANGED[:-40]), settings=SIXTY)[0]
    late = judge(MODEL, days_of(CHANGED), settings=SIXTY)[0]
    widths = []
    for kept in (early, late):
        (alarm,) = kept.alarms
        widths.append(np.ptp(alarm["size_interval_90"]))
    assert early.alarms[0]["time_utc"] == late.alarms[0]["time_utc"] < late.alarms[0]["looked_utc"]
    assert early.alarms[0]["looked_utc"] < late.alarms[0]["looked_utc"]
    assert widths[1] < widths[0]
    low, high = late.alarms[0]["size_interval_90"]
    assert low < -0.008 < high


def test_looks_end_after_a_month_and_what_is_kept_is_small_again() -> None:
    kept = judge(MODEL, days_of(seen(130, step=-0.008)), settings=SIXTY)[0]
    assert kept.pending is None and len(kept.alarms) == 1
    assert len(json.dumps(JUDGED.dump(kept))) < 1.5e6


@pytest.mark.parametrize("last", [-30, -8])
def test_looks_go_on_from_what_was_stored(last: int) -> None:
    first: StoredMonitoring | None = judge(MODEL, days_of(CHANGED[:last]), settings=SIXTY)[0]
    stored = JUDGED.load(json.loads(json.dumps(JUDGED.dump(first))))
    resumed, _ = judge(MODEL, days_of(CHANGED), stored, SIXTY)
    whole, _ = judge(MODEL, days_of(CHANGED), None, SIXTY)
    assert json.dumps(JUDGED.dump(resumed)) == json.dumps(JUDGED.dump(whole))


def test_a_change_that_went_again_is_told_as_it_was_while_it_lasted() -> None:
    """Ice of six days: looks that took it for a step that lasts said −0.1 % (−0.15 to −0.06) later."""
    gone = datetime(2025, 1, 1, tzinfo=UTC) + timedelta(days=BEGUN + 6)
    begun = [o for o in seen(110, step=-0.003) if o.start_utc and o.start_utc < gone]
    both = [*begun, *(o for o in seen(110) if o.start_utc and o.start_utc >= gone)]
    before, after = (judge(MODEL, days_of(of), None, SIXTY)[0].alarms for of in (both[:-40], both))
    assert (len(before), len(after)) == (1, 2)
    assert before[0]["size_interval_90"][0] > -0.003  # nobody knows yet that it went
    ice, back = (alarm["size_interval_90"] for alarm in after)
    assert ice[0] < -0.003 < ice[1] and back[0] < 0.003 < back[1]
    assert after[0]["looked_utc"] < gone.isoformat() < before[0]["looked_utc"] < after[1]["time_utc"]


@pytest.mark.parametrize("same", [True, False])
def test_more_of_a_change_starts_its_looks_anew_and_is_no_alarm(
    same: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The alarm stays one, and is looked at again from the day on which more of it appeared."""
    later = SimpleNamespace(day=20.0, began=19.0, kind="frequency")
    look = SimpleNamespace(change=later, pending="of the later one")
    pending = PendingChange(cast(Any, "watch"), 10.0, 15.0)
    monkeypatch.setattr(following, "step", lambda *_: ("watch", look))
    monkeypatch.setattr(following, "look_again", lambda *_: (None, None))
    monkeypatch.setattr(following, "continues", lambda *_: same)
    monkeypatch.setattr(following, "past_of", lambda one: one)
    before = Alarms(({"looked_utc": "2025-01-01"},), pending, ({"looked_utc": "2025-01-01"},))
    time = partial(lambda start, day: start + timedelta(days=day), datetime(2025, 1, 1, tzinfo=UTC))
    tell = cast(Any, lambda *_: {"looked_utc": "2025-01-21"})
    _, after, _ = followed(cast(Any, "watch"), before, cast(Any, "day"), tell, time)
    if same:
        assert after == replace(before, pending=replace(pending, alarmed=20.0, looked=20.0))
    else:
        assert len(after.documents) == 2 and after.pending == "of the later one"
