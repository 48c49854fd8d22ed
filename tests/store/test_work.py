"""The queue: once for each key, leases that outlive no server, tries that are counted."""

from collections import Counter
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, text

from jackettwin.store import assets, work, writing

NOW = datetime(2025, 3, 1, 12, tzinfo=UTC)


def asked(connection: Connection, record: str, model_hash: str = "m", **how: Any) -> int:
    version = assets.Version("wtg", 1, model_hash, "s", NOW, "me", "", "")
    return work.enqueue(connection, version, record, NOW, **how)


def with_asset(database: Engine) -> None:
    with writing(database) as c:
        assets.add_version(c, "wtg", {"twin.yaml": b""}, model_hash="m", settings_hash="s", by="me", now=NOW)


def test_the_files_of_a_model_are_laid_out_by_two_at_once(tmp_path: Path) -> None:
    """Who comes second finds a folder that is not empty, and leaves what is in it."""
    for _ in range(2):
        assets.lay_out(assets.pack({"twin.yaml": b"1", "soil/a.csv": b"2"}), tmp_path / "twin")
    found = {path.name: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert found == {"twin.yaml": b"1", "a.csv": b"2"}


def test_the_same_key_is_the_same_work(database: Engine) -> None:
    with_asset(database)
    with writing(database) as c:
        first, again, other = asked(c, "a"), asked(c, "a"), asked(c, "a", model_hash="n")
        assert first == again != other
        assert work.queue_sizes(c) == {"queued": 2}


def work_of_database(c: Connection) -> Callable[[], int]:
    """Return what counts a transaction's work from now on: instructions of SQLite, rows of PostgreSQL."""
    if c.dialect.name == "sqlite":
        ticks = Counter[str]()
        c.connection.driver_connection.set_progress_handler(lambda: ticks.update("t"), 10)  # type: ignore[union-attr]
        return lambda: ticks["t"]
    read = text("SELECT sum(seq_tup_read + coalesce(idx_tup_fetch, 0)) FROM pg_stat_xact_user_tables")
    before = c.execute(read).scalar_one()
    return lambda: int(c.execute(read).scalar_one() - before)


def test_a_long_queue_costs_what_a_short_one_does(database: Engine) -> None:
    """Leasing and ending find their rows by an index: a scan of twenty times the rows costs twenty times."""
    with_asset(database)
    with writing(database) as c:
        work.join(c, "one", {}, NOW)
    costs = []
    for first, last in ((0, 100), (100, 2000)):
        with writing(database) as c:
            for k in range(first, last):
                asked(c, f"r{k}")
        with writing(database) as c:
            c.execute(text("ANALYZE"))
            counted = work_of_database(c)
            jobs = work.lease(c, "one", 4, NOW)
            assert [work.finish(c, job, "one", "done", NOW) for job in jobs] == [True] * 4
            costs.append(counted())
    assert 0 < costs[1] < 2 * costs[0], costs


def test_urgent_work_is_leased_first_and_only_once(database: Engine) -> None:
    with_asset(database)
    with writing(database) as c:
        asked(c, "old")
        asked(c, "urgent", priority=5)
        work.join(c, "one", {}, NOW)
        work.join(c, "two", {}, NOW)
    with writing(database) as c:
        assert [j.record_id for j in work.lease(c, "one", 1, NOW)] == ["urgent"]
    with writing(database) as c:
        assert [j.record_id for j in work.lease(c, "two", 5, NOW)] == ["old"]


def test_a_result_counts_only_while_the_lease_is_held(database: Engine) -> None:
    with_asset(database)
    with writing(database) as c:
        asked(c, "a")
        work.join(c, "one", {}, NOW)
        job = work.lease(c, "one", 1, NOW)[0]
    with writing(database) as c:
        assert work.remove_server(c, "one", at_beat=7) == []  # it beat meanwhile
        assert list(work.remove_server(c, "one", at_beat=0)) == [job.id]
    with writing(database) as c:
        assert not work.finish(c, job, "one", "done", NOW)
        again = work.lease(c, "two", 1, NOW)[0]
        assert again.id == job.id
        assert again.tries == 0  # a dead server is not the record's fault
        assert work.finish(c, again, "two", "done", NOW)
        assert not work.finish(c, again, "two", "done", NOW)


def test_a_server_whose_lease_another_one_took_over_ends_nothing(database: Engine) -> None:
    """The work is leased, but not to the server that was taken for dead: whatever it says comes too late."""
    with_asset(database)
    with writing(database) as c:
        asked(c, "a")
        work.join(c, "late", {}, NOW)
        late = work.lease(c, "late", 1, NOW)[0]
        work.remove_server(c, "late")
    with writing(database) as c:
        current = work.lease(c, "next", 1, NOW)[0]
    with writing(database) as c:
        assert not work.finish(c, late, "late", "done", NOW)
        assert work.put_back(c, late, "late", {"detail": "died"}) is None
        work.release(c, late, "late")
        held = work.find_job(c, current.id)
        assert held is not None
        assert (held.state, held.owner, held.tries, held.reason) == ("leased", "next", 1, None)
        assert work.finish(c, current, "next", "done", NOW)


def test_after_three_tries_a_record_is_set_aside_and_may_be_tried_again(database: Engine) -> None:
    with_asset(database)
    with writing(database) as c:
        asked(c, "poison")
    states = []
    for _ in range(work.MOST_TRIES):
        with writing(database) as c:
            job = work.lease(c, "one", 1, NOW)[0]
            states.append(work.put_back(c, job, "one", {"detail": "died"}))
    assert states == ["queued", "queued", "set_aside"]
    with writing(database) as c:
        assert work.lease(c, "one", 1, NOW) == []
        assert work.try_again(c, job.id, NOW)
        assert work.lease(c, "one", 1, NOW)[0].tries == 0


def test_leases_of_servers_nobody_knows_are_taken_back(database: Engine) -> None:
    """As after the restore of a backup that was taken while work was under way."""
    with_asset(database)
    with writing(database) as c:
        asked(c, "a")
        work.lease(c, "gone", 1, NOW)
        assert work.take_back_orphans(c, "me", ()) == 1
        assert work.queue_sizes(c) == {"queued": 1}


def test_nobodys_backlog_holds_up_another_one(database: Engine) -> None:
    """A thousand records of one turbine wait; of three others one each, which came later."""
    names = ("a", "b", "c", "flood")
    with writing(database) as c:
        for name in names:
            about = {"model_hash": "m", "settings_hash": "s", "by": "me", "now": NOW}
            assets.add_version(c, name, {"twin.yaml": b""}, **about)
        work.join(c, "one", {}, NOW)
        for name, count in (("flood", 200), ("c", 1), ("a", 1), ("b", 2)):
            version = assets.Version(name, 1, "m", "s", NOW, "me", "", "")
            for k in range(count):
                work.enqueue(c, version, f"{name}{k}", NOW)
    served: Counter[str] = Counter()
    taken = []
    for _ in range(8):  # one at a time, as one worker takes them
        with writing(database) as c:
            jobs = work.lease(c, "one", 1, NOW, served=served)
        served.update(job.asset for job in jobs)
        taken += [job.record_id for job in jobs]
    assert sorted(taken[:4]) == ["a0", "b0", "c0", "flood0"]
    assert sorted(taken[4:6]) == ["b1", "flood1"]
    assert taken[6:] == ["flood2", "flood3"]
    with writing(database) as c:
        assert len(work.lease(c, "one", 6, NOW, served=served)) == 6  # alone it has everything


def test_one_server_has_a_post_until_it_leaves_or_is_dead(database: Engine) -> None:
    with writing(database) as c:
        for server in ("one", "two"):
            work.join(c, server, {}, NOW)
    for _ in range(2):  # and keeps it
        with writing(database) as c:
            assert work.hold_duty(c, "intake", "one")
            assert not work.hold_duty(c, "intake", "two")
            assert work.hold_duty(c, "other", "two")
    with writing(database) as c:
        work.remove_server(c, "one")
        assert work.hold_duty(c, "intake", "two")
        work.join(c, "one", {}, NOW)  # it was not dead after all
        assert not work.hold_duty(c, "intake", "one")
