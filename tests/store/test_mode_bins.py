"""Extremes and medians of modes in bins, against those of all rows at once."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest
from sqlalchemy import Engine, event, func, select

from jackettwin.store import mode_bins as module, reading, tables, writing
from jackettwin.store.mode_bins import Extremes, ModeBins, forget_day, keep_days, modes_in_bins
from jackettwin.store.results import list_modes

BEGIN = datetime(2015, 3, 1, tzinfo=UTC)
LABELS = ("fore_aft_1", "side_side_1")
N = 700


def rows() -> list[dict[str, Any]]:
    """Return two modes of one record an hour, stored out of order, one of them often without damping."""
    random = np.random.default_rng(7)
    made = [
        {
            "asset": "wtg",
            "model_hash": "m",
            "model_version": 1,
            "record_id": f"{k:08x}",
            "time_utc": BEGIN + timedelta(hours=k + (500 if k > 400 else 0)),
            "label": label,
            "frequency_hz": float(random.normal(0.3, 0.01)),
            "frequency_std_hz": None if k % 5 == 0 else float(random.uniform(0.001, 0.002)),
            "damping_ratio": None
            if k % 3 == 0 and label == "side_side_1"
            else float(random.uniform(0.01, 0.02)),
            "status": "simulated" if k < 10 else "ok",
        }
        for k in range(N)
        for label in LABELS
    ]
    return [made[k] for k in random.permutation(len(made))]


ROWS = rows()


@pytest.fixture
def filled(database: Engine, monkeypatch: pytest.MonkeyPatch) -> Engine:
    """Of two models and two assets; read in batches that end within bins."""
    monkeypatch.setattr(module, "_BATCH", 37)
    with writing(database) as connection:
        for name in ("wtg", "other"):
            connection.execute(tables.assets.insert().values(name=name, created_utc=BEGIN, adopted_version=1))
        connection.execute(tables.modes.insert(), ROWS)
        strange = [{**ROWS[0], "model_hash": "old"}, {**ROWS[0], "asset": "other"}]
        connection.execute(tables.modes.insert(), [{**row, "frequency_hz": 9.0} for row in strange])
    return database


@pytest.mark.parametrize("limit", [9, 2000])
def test_the_least_known_come_first_as_an_index_has_them(filled: Engine, limit: int) -> None:
    """Those that tell of no uncertainty last; of ten years no row is read that is not asked for."""
    since = BEGIN + timedelta(days=9)
    ratio = [(r["frequency_std_hz"] or 0.0) / r["frequency_hz"] for r in ROWS if r["time_utc"] >= since]
    asked: list[tuple[str, Any]] = []
    event.listen(
        filled, "before_cursor_execute", lambda _c, _k, text, values, *_: asked.append((text, values))
    )
    with reading(filled) as connection:
        found = list_modes(connection, "wtg", "m", since=since, limit=limit, least_known=True)
        assert [(r["frequency_std_hz"] or 0.0) / r["frequency_hz"] for r in found] == pytest.approx(
            sorted(ratio, reverse=True)[:limit]
        )
        if connection.dialect.name == "sqlite":
            plan = connection.exec_driver_sql("explain query plan " + asked[-2][0], asked[-2][1]).all()
            assert any("ix_modes_least_known" in row[-1] for row in plan), plan


def expected(values: list[float | None]) -> tuple[float | None, ...]:
    known = [v for v in values if v is not None]
    return (min(known), float(np.median(known)), max(known)) if known else (None,) * 3


def of_bin(extremes: Extremes, k: int) -> tuple[float | None, ...]:
    return extremes.min[k], extremes.median[k], extremes.max[k]


def check(found: ModeBins, rows: list[dict[str, Any]], start: datetime, end: datetime, points: int) -> None:
    """Compare each bin with all rows between its two times; the last one has its end as well."""
    assert sum(found.count) == len(rows)
    assert found.start_utc == start
    assert found.bin_s == pytest.approx((end - start).total_seconds() / points, abs=1e-6)
    for k, at in enumerate(found.time_s):
        number = round(at / found.bin_s)
        low = start + timedelta(seconds=number * found.bin_s)
        high = end + timedelta(1) if number == points - 1 else low + timedelta(seconds=found.bin_s)
        inside = [row for row in rows if low <= row["time_utc"] < high]
        assert found.count[k] == len(inside) > 0
        for name in ("frequency_hz", "damping_ratio"):
            assert of_bin(getattr(found, name), k) == pytest.approx(expected([row[name] for row in inside]))
    assert found.simulated == sum(row["status"] == "simulated" for row in rows)


@pytest.mark.parametrize("points", [1, 8, 100, 10_000])
@pytest.mark.parametrize("window", [(None, None), (40, 300), (None, 300), (650, None)])
def test_bins_have_the_extremes_medians_and_counts_of_all_rows(
    filled: Engine, points: int, window: tuple[int | None, int | None]
) -> None:
    since, until = (None if h is None else BEGIN + timedelta(hours=h) for h in window)
    chosen = [
        row
        for row in ROWS
        if (since is None or row["time_utc"] >= since) and (until is None or row["time_utc"] < until)
    ]
    times = [row["time_utc"] for row in chosen]
    statements: list[str] = []
    event.listen(filled, "before_cursor_execute", lambda *told: statements.append(told[2]))
    with reading(filled) as connection:
        found = list(modes_in_bins(connection, "wtg", "m", points, since=since, until=until))
    steps = len(LABELS) + 1  # to the labels that there are; each has two ends, at most of two stretches
    assert sum("modes" in statement for statement in statements) <= 5 * steps
    assert [one.label for one in found] == list(LABELS)
    for one in found:
        own = [row for row in chosen if row["label"] == one.label]
        check(one, own, since or min(times), until or max(times), points)
        assert len(one.time_s) <= points


def test_a_bin_without_damping_says_so(filled: Engine) -> None:
    with reading(filled) as connection:
        (found,) = modes_in_bins(
            connection, "wtg", "m", 5, label="side_side_1", until=BEGIN + timedelta(hours=1)
        )
    assert (found.count, of_bin(found.damping_ratio, 0)) == ([1], (None, None, None))


@pytest.mark.parametrize(
    "asked", [{"label": "nobody"}, {"since": BEGIN + timedelta(days=999)}, {"since": BEGIN, "until": BEGIN}]
)
def test_what_is_not_there_is_nothing(filled: Engine, asked: dict[str, Any]) -> None:
    with reading(filled) as connection:
        assert list(modes_in_bins(connection, "wtg", "m", 5, **asked)) == []
        assert list(modes_in_bins(connection, "nobody", "m", 5)) == []


def test_rows_of_one_time_are_one_bin(filled: Engine) -> None:
    """Their span is zero long, which no length of a bin may be."""
    until = BEGIN + timedelta(minutes=1)
    with reading(filled) as connection:
        found = list(modes_in_bins(connection, "wtg", "m", 5, label="fore_aft_1", since=BEGIN, until=until))
        assert [(one.time_s, one.count) for one in found] == [([0.0], [1])]
        (found_alone,) = modes_in_bins(connection, "wtg", "m", 5, label="fore_aft_1", until=until)
        assert (found_alone.time_s, found_alone.count) == ([0.0], [1])


def test_kept_days_say_what_their_rows_say(filled: Engine) -> None:
    """Whole days in each bin: counts and extremes are exact, and the median of a day's bins is its own."""
    end = BEGIN + timedelta(days=50)
    bounds = {"since": BEGIN, "until": end}
    with writing(filled) as connection:
        before = {n: list(modes_in_bins(connection, "wtg", "m", n, **bounds)) for n in (5, 50)}
        for _ in range(3):  # a month at once
            keep_days(connection, "wtg", "m", end)
        days = connection.execute(tables.mode_days.select()).all()
        rows = connection.scalar(select(func.count()).select_from(tables.modes))
        connection.execute(
            tables.modes.update().where(tables.modes.c.asset == "wtg").values(frequency_hz=5.0)
        )
        kept = {n: list(modes_in_bins(connection, "wtg", "m", n, **bounds)) for n in (5, 50)}
        assert kept[50] == before[50]
        assert [(b.count, b.frequency_hz.min, b.frequency_hz.max, b.simulated) for b in kept[5]] == [
            (b.count, b.frequency_hz.min, b.frequency_hz.max, b.simulated) for b in before[5]
        ]
        forget_day(connection, "wtg", "m", BEGIN + timedelta(days=3, hours=5))
        found = list(modes_in_bins(connection, "wtg", "m", 50, **bounds))
        assert all(
            b.frequency_hz.max[3] == 5.0 and b.count == a.count for a, b in zip(kept[50], found, strict=True)
        )
        assert all(b.frequency_hz.max[4] < 1.0 for b in found)
        hours = list(modes_in_bins(connection, "wtg", "m", 100, **bounds))  # of less than a day: every row
        assert all(set(b.frequency_hz.min) == {5.0} for b in hours)
    assert rows == 2 * N + 2 and sum(day.count for day in days) == 2 * N
