"""Exactly once.

Whatever order records come in, however often, and wherever a server dies, the states are the same.
"""

import json
import random
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from threading import Event

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from sqlalchemy import Connection, select
from sqlalchemy.exc import OperationalError
from tests.service.conftest import NOON, Done, description, hour, make_service, record_file, turn
from tests.store.conftest import fresh

from jackettwin.findings import Finding
from jackettwin.service.context import Service
from jackettwin.service.web import catalogue, uploads
from jackettwin.service.work import consequences, dispatch
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.service.workers.tasks import Outcome, observe_stored
from jackettwin.store import assets, reading, results, tables, work, writing
from jackettwin.twin import OBSERVATION

RECORDS = 6


class Killed(BaseException):
    """The server ends here; what was not committed is gone."""


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    patch = pytest.MonkeyPatch()
    yield from make_service(tmp_path_factory.mktemp("kept"), None, patch)
    patch.undo()


def send(service: Service, k: int) -> None:
    import io

    # hours 18 to 30: two UTC days
    start = hour(6 + 2 * k)
    uploads.take(service, "wtg", f"r{k}.parquet", io.BytesIO(record_file(k)), description(start), by="agent")


def hashes(service: Service) -> dict[str, str]:
    with reading(service.database) as connection:
        version = assets.found_version(connection, "wtg")
        return results.state_hashes(connection, "wtg", version.model_hash)


def forget(service: Service) -> None:
    """Empty the store but for the asset."""
    with writing(service.database) as connection:
        for name in ("modes", "observations", "states", "findings", "events", "work", "records", "servers"):
            connection.execute(tables.metadata.tables[name].delete())


def undisturbed(service: Service) -> dict[str, str]:
    forget(service)
    for k in range(RECORDS):
        send(service, k)
        turn(service, 2)
    return hashes(service)


@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    order=st.permutations(range(RECORDS)),
    doubled=st.lists(st.integers(0, RECORDS - 1), max_size=4),
    kills=st.lists(st.integers(0, 14), max_size=4, unique=True),
    seed=st.integers(0, 1000),
)
def test_orders_doubles_and_deaths_do_not_show(kept: Service, order, doubled, kills, seed) -> None:
    expected = undisturbed(kept)
    assert len(expected) == 2
    forget(kept)
    rng = random.Random(seed)
    steps = 0
    original = consequences.journal.tell

    def deadly(*arguments, **more):
        """Die in the middle of a transaction, at steps that were drawn."""
        nonlocal steps
        steps += 1
        if steps - 1 in kills:
            raise Killed
        original(*arguments, **more)

    consequences.journal.tell = deadly
    try:
        for k in [*order, *doubled]:
            for attempt in ("send", "turn"):
                try:
                    send(kept, k) if attempt == "send" else turn(kept, rng.randint(1, 3))
                except Killed:
                    continue
    finally:
        consequences.journal.tell = original
    for k in order:  # what was on its way when a server died is sent again
        send(kept, k)
        turn(kept, 3)
    assert hashes(kept) == expected
    with reading(kept.database) as connection:
        observed = connection.execute(select(tables.observations.c.record_id)).all()
        rows = connection.execute(select(tables.modes.c.record_id)).all()
        statuses = set(connection.scalars(select(tables.records.c.status)))
    assert len(observed) == len(set(observed)) == RECORDS
    assert len(rows) == 2 * RECORDS
    assert statuses == {"observed"}


@pytest.fixture(params=["sqlite", "postgresql"])
def anywhere(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Service]:
    """A service on a database of each kind."""
    url = None if request.param == "sqlite" else fresh(request.getfixturevalue("postgresql_url"))
    yield from make_service(tmp_path / "store", url, monkeypatch)


def another(service: Service, name: str) -> Service:
    """Return another server of the same store, which may hold leases."""
    with writing(service.database) as connection:
        work.join(connection, name, {}, service.now())
    return Service(service.settings, service.database, service.cluster, name)


def leased(server: Service) -> tuple[work.Job, Outcome]:
    """Return a piece of work that a server leased, and what its worker found."""
    with writing(server.database) as connection:
        job = work.lease(connection, server.server_id, 1, server.now())[0]
        task = consequences.task_of(connection, server, job)
    return job, observe_stored(task)


def keep(server: Service, found: tuple[work.Job, Outcome]) -> None:
    with writing(server.database) as connection:
        consequences.keep(connection, server, *found)


def test_a_result_that_comes_after_the_lease_was_lost_changes_nothing(anywhere: Service) -> None:
    send(anywhere, 0)
    slow = another(anywhere, "slow")
    late = leased(slow)
    with writing(anywhere.database) as connection:
        work.remove_server(connection, "slow")
    turn(anywhere)
    before = hashes(anywhere)
    keep(slow, late)
    assert hashes(anywhere) == before
    with reading(anywhere.database) as connection:
        assert len(connection.execute(select(tables.modes)).all()) == 2


def test_a_result_that_comes_while_another_server_holds_the_lease_changes_nothing(anywhere: Service) -> None:
    """The one that was taken for dead is refused, the one that took over is not."""
    send(anywhere, 0)
    slow, quick = another(anywhere, "slow"), another(anywhere, "quick")
    late = leased(slow)
    with writing(anywhere.database) as connection:
        work.remove_server(connection, "slow")
    current = leased(quick)
    keep(slow, late)
    with reading(anywhere.database) as connection:
        assert connection.execute(select(tables.observations)).all() == []
        assert [(j.state, j.owner) for j in work.list_jobs(connection)] == [("leased", "quick")]
    assert hashes(anywhere) == {}
    keep(quick, current)
    assert len(hashes(anywhere)) == 1


def test_two_servers_that_fold_into_one_day_at_once_lose_no_record(anywhere: Service) -> None:
    """The second waits until the first has committed, and adds to what it finds then."""
    for k in range(3):  # all of one day
        send(anywhere, k)
    zero, one, two = another(anywhere, "zero"), another(anywhere, "one"), another(anywhere, "two")
    keep(zero, leased(zero))
    first, second = leased(one), leased(two)
    folded, commit = Event(), Event()

    def slowly() -> None:
        with writing(one.database) as connection:
            consequences.keep(connection, one, *first)
            folded.set()
            commit.wait(10.0)

    with ThreadPoolExecutor(2) as pool:
        ends = [pool.submit(slowly)]
        assert folded.wait(10.0)
        ends.append(pool.submit(keep, two, second))
        with suppress(TimeoutError):
            ends[1].result(timeout=1.0)  # it would be through by now if it did not wait
        commit.set()
        for end in ends:
            end.result(timeout=60.0)
    with reading(anywhere.database) as connection:
        assert list(connection.scalars(select(tables.states.c.n_records))) == [3]


def poison(task: object) -> None:
    raise RuntimeError("segmentation fault, as it were")


def test_a_record_whose_worker_dies_is_tried_three_times_and_set_aside(service: Service, monkeypatch) -> None:
    monkeypatch.setattr(dispatch, "observe_stored", poison)
    send(service, 0)
    turn(service, 12)
    with reading(service.database) as connection:
        job = work.list_jobs(connection)[0]
        status = connection.scalar(select(tables.records.c.status))
    assert (job.state, job.tries, status) == ("set_aside", work.MOST_TRIES, "set_aside")
    monkeypatch.undo()


@pytest.mark.parametrize("wrong", [{"label": None}, {"label": "x", "frequency_hz": object()}])
def test_a_result_that_cannot_be_stored_is_its_own_records_fault(
    service: Service, monkeypatch, wrong
) -> None:
    """Otherwise the dispatcher would try it for ever, and everything behind it would wait."""
    for k in range(3):
        send(service, k)
    keep, bad = consequences.keep, []

    def spoiled(connection: Connection, at: Service, job: work.Job, outcome: Outcome) -> None:
        bad[:] = bad or [job.record_id]
        mode = {**outcome.modes[0], **wrong}
        keep(connection, at, job, replace(outcome, modes=(mode,)) if job.record_id in bad else outcome)

    monkeypatch.setattr(consequences, "keep", spoiled)
    turn(service, 12)
    with reading(service.database) as connection:
        statuses = dict(connection.execute(select(tables.records.c.record_id, tables.records.c.status)).all())
        (tries,) = connection.scalars(select(tables.work.c.tries).where(tables.work.c.record_id == bad[0]))
    assert (statuses.pop(bad[0]), tries) == ("set_aside", work.MOST_TRIES)
    assert set(statuses.values()) == {"observed"} and len(statuses) == 2


def test_a_channel_named_by_a_stranger_fits_into_a_finding() -> None:
    """PostgreSQL refuses a NUL and 256 characters, whatever SQLite takes."""
    finding = {"code": "dead", "severity": "warning", "subject": "a\0" + "x" * 300, "params": {}}
    finding["text"] = f"{finding['subject']} is dead"
    row = consequences._finding_row(finding, {}, hour(0), "2025-03-01", "observe")
    assert len(row["subject"]) == 255 and "\0" not in row["subject"] + row["text"]
    assert consequences._finding_row({**finding, "subject": None}, {}, hour(0), "", "")["subject"] is None


def test_a_record_that_waited_at_a_worker_that_died_was_not_tried(service: Service, monkeypatch) -> None:
    """Dask gives back whatever a worker held when it died of something else."""
    send(service, 0)
    with monkeypatch.context() as patch:
        patch.setattr(dispatch, "observe_stored", poison)
        patch.setattr(service.cluster, "has_begun", lambda *_: False)
        turn(service, 12)
    with reading(service.database) as connection:
        assert work.list_jobs(connection)[0].tries <= 1
    turn(service, 12)
    with reading(service.database) as connection:
        assert {job.state for job in work.list_jobs(connection)} == {"done"}


def test_work_on_samples_that_are_gone_ends_and_holds_nothing_up(service: Service) -> None:
    """Pruned by policy after a new version had asked for them."""
    send(service, 0)
    with writing(service.database) as connection:
        connection.execute(tables.records.update().values(waveform=None))
    send(service, 1)
    turn(service, 6)
    with reading(service.database) as connection:
        jobs = {job.id: job for job in work.list_jobs(connection) if job.kind == work.OBSERVE}
    assert [jobs[k].state for k in sorted(jobs)] == ["failed", "done"]
    assert "no samples" in jobs[min(jobs)].reason["detail"]


def test_a_lease_that_was_taken_when_the_database_went_away_is_taken_back(
    service: Service, monkeypatch
) -> None:
    send(service, 0)

    def away(*_: object) -> None:
        raise OperationalError("select", {}, Exception("gone"))

    server = dispatch.Dispatcher(service)
    with monkeypatch.context() as patch:
        patch.setattr(consequences, "task_of", away)
        with pytest.raises(OperationalError):
            server._turn()
    with reading(service.database) as connection:
        assert work.list_jobs(connection, state="leased")
    for _ in range(3):
        server._last_beat = -60.0
        server._turn()
    with reading(service.database) as connection:
        assert not work.list_jobs(connection, state="leased")


def test_states_are_made_again_from_stored_observations(service: Service) -> None:
    from jackettwin.service import rebuild

    for k in range(3):
        send(service, k)
    turn(service, 5)
    before = hashes(service)
    with writing(service.database) as connection:
        connection.execute(tables.states.delete())
    done = rebuild(service.database, Path(service.settings.store), None, None)
    assert done["days"] == len(before)
    assert hashes(service) == before


def test_two_servers_share_one_queue(service: Service) -> None:
    other = type(service)(service.settings, service.database, service.cluster, "other")
    for k in range(RECORDS):
        send(service, k)
    one, two = Dispatcher(service), Dispatcher(other)
    for _ in range(4):
        one._turn()
        two._turn()
    with reading(service.database) as connection:
        done = [job for job in work.list_jobs(connection, state="done") if job.kind == "observe"]
        assert len(done) == RECORDS
        assert len(connection.execute(select(tables.observations)).all()) == RECORDS


def test_a_record_of_another_turbine_is_said_and_counts_nowhere(service: Service) -> None:
    """The asset is not ok, its dates are those of its own records, and the record has a remark."""
    send(service, 0)
    turn(service, 2)
    before = hashes(service)
    send(service, 5)
    job, outcome = leased(service)
    seen = OBSERVATION.load(json.loads(outcome.document or ""))
    finding = Finding("no_mode_of_the_model", params={"modes": len(seen.recognised)})
    other = replace(seen, recognised=(None,) * len(seen.recognised), findings=(finding,))
    problem = {"detail": "none of its modes is one of this twin's", "field": "record"}
    document = json.dumps(OBSERVATION.dump(other))
    keep(service, (job, Outcome(document, problem=problem)))
    with reading(service.database) as connection:
        version = assets.found_version(connection, "wtg")
        (asset,) = catalogue.overview(connection)
        newest = connection.execute(
            select(tables.records.c.status, tables.records.c.problem).order_by(
                tables.records.c.start_utc.desc()
            )
        ).first()
        said = results.count_findings(connection, "wtg")["wtg"]
        number, _ = results.observed_time(connection, "wtg", version.model_hash)
    assert hashes(service) == before
    assert asset.status == "warning" and asset.records == {"observed": 1, "mismatched": 1}
    assert asset.last_record_utc is not None and asset.last_record_utc.hour == hour(6).hour
    assert (
        newest is not None
        and newest.status == "mismatched"
        and "none of its modes" in newest.problem["detail"]
    )
    assert said["warning"] >= 1 and number == 1


def test_a_study_may_take_longer_than_a_record(kept: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two that began 700 s ago the record is tried again, with its reason; the study goes on."""
    monkeypatch.setattr(kept.cluster, "has_begun", lambda future, ago_s=0.0: ago_s <= 700.0)
    monkeypatch.setattr(Done, "done", lambda self: False)
    dispatcher = Dispatcher(kept)
    with writing(kept.database) as connection:
        version = assets.found_version(connection, "wtg")
        for kind in (work.OBSERVE, work.KNOW):
            work.enqueue(connection, version, "longest", NOON, kind=kind)
            (job,) = work.lease(connection, kept.server_id, 1, NOON, kind=kind)
            dispatcher._running[job.id] = dispatch._Running(job, Done(), 0.0)
    dispatcher._end_overrun()
    assert [running.job.kind for running in dispatcher._running.values()] == [work.KNOW]
    with reading(kept.database) as connection:
        study, record = work.list_jobs(connection, limit=2)
    assert (study.state, record.state) == ("leased", "queued")
    assert record.reason and record.reason["detail"] == "took longer than 600 s"
    forget(kept)


def test_the_first_estimate_of_a_model_waits_for_no_rest(kept: Service) -> None:
    """After another turbine's long estimate a new one would wait three times as long."""
    dispatcher = Dispatcher(kept)
    dispatcher._rest_until = float("inf")
    with writing(kept.database) as connection:
        number = work.enqueue(connection, assets.found_version(connection, "wtg"), "", NOON, kind=work.KNOW)
    assert dispatcher._next_kind() == work.KNOW
    with writing(kept.database) as connection:
        work.lease(connection, kept.server_id, 1, NOON, kind=work.KNOW)
        work.cancel(connection, number, NOON)
        assert work.try_again(connection, number, NOON)
    assert dispatcher._next_kind() is None
    dispatcher._rest_until = 0.0
    assert dispatcher._next_kind() == work.KNOW
    forget(kept)
