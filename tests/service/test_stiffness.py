"""The stiffness on each day as the service keeps it: that of ``follow``, in whatever order days come."""

from __future__ import annotations

import json
from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.service.conftest import NOON
from tests.support.observations import estimate, observation

from jackettwin.service.workers import engine, stiffness
from jackettwin.study.follow import follow_observations
from jackettwin.study.follow_result import Followed
from jackettwin.twin import OBSERVATION, Observation
from jackettwin.updating import Problem

TWIN = """structure: jacket15
gravity: true
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.183}}
update: {laws: [kelvin-voigt], particles: 20, starts: 2, damping_of: all}
"""
DAYS = 6


@pytest.fixture(scope="module", autouse=True)
def posterior() -> Iterator[None]:
    """Stand in for the sampler: what all records together say is known, and no matter of these tests."""
    patch = pytest.MonkeyPatch()

    def drawn(_: object, problem: Problem, progress: object) -> tuple[np.ndarray, str]:
        middle = np.log([np.sqrt(p.low * p.high) for p in problem.parameters])
        return middle + 0.1 * np.random.default_rng(1).standard_normal((40, middle.size)), "ok"

    patch.setattr("jackettwin.study.in_time.question._draws", drawn)
    yield
    patch.undo()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("twin")
    (made / engine.TWIN_FILE).write_text(TWIN)
    return made


def seen(folder: Path, day: int, hour: int = 0, moved: float = 0.0) -> Observation:
    """Return what a record shows: three modes, scattered, all frequencies moved."""
    rng = np.random.default_rng((day, hour))
    model = engine.load_twin(folder).model
    f = np.array([0.1755, 0.1785, 0.74]) * np.exp(moved + 1e-3 * rng.standard_normal(3))
    modes = {m: estimate(x, 0.012, 1e-3, 0.1) for m, x in zip((1, 2, 4), f, strict=True)}
    made = observation(modes, NOON + timedelta(days=day, hours=hour), name=f"d{day}h{hour}")
    return type(made)(**{**vars(made), "model_hash": model.model_hash})


def documents(folder: Path, records: list[Observation]) -> dict[str, str]:
    """Return the states of the days as the store has them."""
    model, by_day = engine.load_twin(folder).model, {}
    for one in records:
        assert one.start_utc is not None
        by_day.setdefault(f"{one.start_utc:%Y-%m-%d}", []).append(json.dumps(OBSERVATION.dump(one)))
    return {day: engine.advance_day(model, day, None, by_day[day]).document for day in sorted(by_day)}


def asked(folder: Path, days: dict[str, str], kept: Any) -> tuple[Followed, Any]:
    """Ask as the service does: what is kept goes through JSON, only the days that are needed are sent."""
    identities = {day: engine.digest(document) for day, document in days.items()}
    kept = json.loads(json.dumps(kept))
    after = stiffness.days_needed(kept, identities)
    sent = days if after is None else {day: text for day, text in days.items() if day > after}
    return stiffness.followed(engine.load_twin(folder), kept, identities, sent)


@pytest.fixture(scope="module")
def records(folder: Path) -> list[Observation]:
    return [seen(folder, day, hour) for day in range(DAYS) for hour in (0, 2)]


@pytest.fixture(scope="module")
def by_command(folder: Path, records: list[Observation]) -> Followed:
    twin = engine.load_twin(folder)
    return follow_observations(twin.config, twin.model, records)


def test_record_after_record_is_what_follow_says(
    folder: Path, records: list[Observation], by_command: Followed
) -> None:
    """Bit for bit, though every question but the last was of a day that still grew."""
    kept = None
    for n in range(1, len(records) + 1):
        now, kept = asked(folder, documents(folder, records[:n]), kept)
        assert now.days[-1].records == 2 - n % 2
    assert [d.relative for d in now.days] == [d.relative for d in by_command.days]
    assert [d.median for d in now.days] == [d.median for d in by_command.days]
    assert now.smoothed == by_command.smoothed and now.ahead == by_command.ahead
    again, _ = asked(folder, documents(folder, records), None)
    assert (again.days, again.smoothed) == (now.days, now.smoothed)


def test_a_late_record_is_taken_in_and_what_is_kept_is_that_of_its_days(
    folder: Path, records: list[Observation], by_command: Followed
) -> None:
    """A record of the day before yesterday, and one of the first day: the answer is that of all records."""
    for late in (2 * DAYS - 5, 1):
        before = [one for i, one in enumerate(records) if i != late]
        _, kept = asked(folder, documents(folder, before), None)
        now, _ = asked(folder, documents(folder, records), kept)
        assert now.days == by_command.days and now.smoothed == by_command.smoothed


def test_a_day_that_was_taken_back_is_forgotten(folder: Path, records: list[Observation]) -> None:
    _, kept = asked(folder, documents(folder, records), None)
    for gone in (2 * DAYS - 2, 4):  # the last day, and one in the middle
        left = documents(folder, [one for i, one in enumerate(records) if i not in (gone, gone + 1)])
        now, _ = asked(folder, left, kept)
        assert [d.date for d in now.days] == list(left)
        assert now.days == asked(folder, left, None)[0].days


def test_days_without_modes_or_of_no_use_are_passed(folder: Path, records: list[Observation]) -> None:
    """A day on which nothing was seen is no day of the stiffness, and costs no going on."""
    model = engine.load_twin(folder).model
    blank = observation({}, NOON + timedelta(days=DAYS), name="blank")
    blank = type(blank)(**{**vars(blank), "model_hash": model.model_hash})
    more, kept = [blank, seen(folder, DAYS + 1), seen(folder, DAYS + 2)], None
    for n in range(4):
        now, kept = asked(folder, documents(folder, [*records, *more[:n]]), kept)
    whole, _ = asked(folder, documents(folder, [*records, *more]), None)
    assert now.days == whole.days
    assert datetime.fromisoformat(now.days[-1].date).date() == (NOON + timedelta(days=DAYS + 2)).date()
