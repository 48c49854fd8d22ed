"""The days of a state watched: the same judgement in whatever order, kept and resumed, and changes found."""

from __future__ import annotations

import json
from datetime import UTC, date, datetime, timedelta

import numpy as np
import pytest
from observations import BEGUN, seen

from jackettwin.change.judge import JUDGED, Days, StoredMonitoring, judge
from jackettwin.twin import Observation, TwinModel, TwinState, advance_all
from jackettwin.twin.config import WatchSettings

MODEL = TwinModel("asset")
SIXTY = WatchSettings(baseline_days=60)
CHANGED = seen(100, step=-0.008)


def state_of(observations: list[Observation]) -> TwinState:
    return advance_all(TwinState("model", by_wind=True), observations)[0]


def days_of(observations: list[Observation]) -> Days:
    return Days.of(state_of(observations))


@pytest.fixture(scope="module")
def judged() -> StoredMonitoring:
    return judge(MODEL, days_of(CHANGED), settings=SIXTY)[0]


def test_levels_and_temperatures_are_kept_with_their_days() -> None:
    ((_, operation),) = [item for item in state_of(CHANGED[:1]).days["2025-01-01"].operations.items()]
    assert list(operation.beside) == ["air_temperature_c"]


def test_nothing_is_said_before_a_baseline_is_whole() -> None:
    kept, (finding,) = judge(MODEL, days_of(CHANGED[:100]), settings=SIXTY)
    assert finding.code == "watch_learning" and kept.watch is None
    assert "24 of 60 days" in str(finding)


def test_a_change_is_an_alarm_and_quiet_days_are_none(judged: StoredMonitoring) -> None:
    (alarm,) = judged.alarms
    assert alarm["kind"] == "frequency" and alarm["size"] == pytest.approx(-0.008, abs=0.002)
    low, high = alarm["began_interval_90"]
    assert low <= (datetime(2025, 1, 1, tzinfo=UTC) + timedelta(days=BEGUN)).isoformat() <= high
    assert judge(MODEL, days_of(seen(100)), settings=SIXTY)[0].alarms == ()


def test_an_alarm_is_said_once_and_says_what_changed() -> None:
    until = [o for o in CHANGED if o.start_utc and o.start_utc < datetime(2025, 3, 10, tzinfo=UTC)]
    kept, found = judge(MODEL, days_of(until), settings=SIXTY)
    assert [f.code for f in found] == ["watch_begins"]
    kept, found = judge(MODEL, days_of(CHANGED), kept, settings=SIXTY)
    assert [(f.code, f.severity) for f in found] == [("structure_changed", "alarm")]
    assert "began 2025-03-1" in str(found[0])
    assert judge(MODEL, days_of(CHANGED), kept, settings=SIXTY)[1] == ()


def test_order_pieces_and_the_disk_make_no_difference(judged: StoredMonitoring) -> None:
    kept: StoredMonitoring | None = None
    some = list(CHANGED)
    np.random.default_rng(3).shuffle(some)
    late = some[:7]
    state = state_of(some[7:])
    for last in ("2025-03-05", "2025-03-20"):
        kept, _ = judge(MODEL, Days.of(state.until(last)), kept, settings=SIXTY)
        kept = JUDGED.load(json.loads(json.dumps(JUDGED.dump(kept))))
    state, _ = advance_all(state, late)
    kept, _ = judge(MODEL, Days.of(state), kept, settings=SIXTY)
    assert json.dumps(JUDGED.dump(kept)) == json.dumps(JUDGED.dump(judged))


def test_what_is_kept_does_not_grow() -> None:
    """A judgement of two quantities of each of two modes is some hundred kilobytes, however many days."""
    sizes = []
    for days in (100, 130):
        kept, _ = judge(MODEL, days_of(seen(days)), settings=SIXTY)
        sizes.append(len(json.dumps(JUDGED.dump(kept))))
    assert sizes[1] < 1.05 * sizes[0] < 1.5e6


def test_a_quiet_day_asks_for_that_day_alone() -> None:
    """So a day of year ten costs what one of the first week does, whatever lies before it."""
    state, asked = state_of(seen(100)), list[str]()
    kept, _ = judge(MODEL, Days.of(state.until("2025-04-01")), settings=SIXTY)
    days = Days.of(state.until("2025-04-02"))
    noted = Days(days.identities, lambda day: asked.append(day) or days.load(day))
    resumed, _ = judge(MODEL, noted, kept, settings=SIXTY)
    assert asked == ["2025-04-01"]  # the second may not be whole yet
    assert json.dumps(JUDGED.dump(resumed)) == json.dumps(JUDGED.dump(judge(MODEL, days, None, SIXTY)[0]))


def test_a_baseline_is_learnt_anew_on_a_persons_word(judged: StoredMonitoring) -> None:
    """From the day of the change on what changed is the baseline: nothing changes after it."""
    anew = WatchSettings(baseline_days=30, relearn=date(2025, 1, 2) + timedelta(days=BEGUN))
    days = days_of(seen(130, step=-0.008))
    kept, _ = judge(MODEL, days, judged, anew)
    assert judged.alarms and not kept.alarms and kept.relearn == "2025-03-18"
    assert json.dumps(JUDGED.dump(kept)) == json.dumps(JUDGED.dump(judge(MODEL, days, None, anew)[0]))
