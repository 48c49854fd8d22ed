"""What workers do: read a file into the store, observe a stored record. Plain values in, plain values out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jackettwin.errors import InputError, JackettwinError
from jackettwin.service.workers.failures import problem_of
from jackettwin.service.workers.question import Question

if TYPE_CHECKING:
    from jackettwin.records import Record, Unsaid


@dataclass(frozen=True)
class Task:
    """A stored record to observe, by a version of an asset's twin."""

    waveform: str
    twin_folder: str
    asset: str
    version: int
    conditions: Mapping[str, Any]
    picks: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Outcome:
    """What came of a task: a document, or a problem (field, value, remedy) of the record itself.

    With both, the record was observed and is of another structure.

    ``page`` is the report on a turbine's state, and ``of`` the identity of that state; ``same_page`` tells
    that the report there is stays.
    """

    document: str | None
    modes: tuple[dict[str, Any], ...] = ()
    findings: tuple[dict[str, Any], ...] = ()
    problem: dict[str, Any] | None = None
    page: bytes | None = None
    of: str = ""
    same_page: bool = False


@dataclass(frozen=True)
class File:
    """A file to read, and what bounds it.

    Attributes
    ----------
    samples_limit : most samples, over all channels, that it may expand to
    memory_bytes : of the process that reads it, meanwhile
    latest_utc : when a record may begin at the latest
    unsaid : what holds for a file that does not say so, by the twin of its asset
    """

    path: str
    asset: str
    store: str
    samples_limit: int
    memory_bytes: int
    latest_utc: datetime
    unsaid: Unsaid | None = None


EARLIEST = datetime(2001, 1, 1, tzinfo=UTC)
"""Clocks that were never set begin in 1970, 1980 or 2000."""


@dataclass(frozen=True)
class Parsed:
    """A record that is now a waveform in the store, or the problem with its file."""

    record_id: str
    waveform: str | None = None
    size_bytes: int = 0
    about: dict[str, Any] = field(default_factory=dict)
    problem: dict[str, Any] | None = None


def about(record: Record) -> dict[str, Any]:
    """Return what is searched of a record."""
    assert record.start_utc is not None
    return {
        "start_utc": record.start_utc.isoformat(),
        "duration_s": record.duration_s,
        "sample_rate_hz": record.sample_rate_hz,
        "channels": [
            {"name": c.name, "quantity": c.quantity, "unit": c.unit, "height_m": c.height_m, "node": c.node}
            for c in record.channels
        ],
        "conditions": json.loads(json.dumps(dict(record.conditions), default=str)),
    }


def read_file(file: File) -> tuple[Parsed, ...]:
    """Read a file of any known format and keep its samples in the store.

    A file of more than an hour becomes records of ten minutes, as ``jackettwin identify`` reads it. What
    another store keeps of a record is a known format too.
    """
    from jackettwin.records import read_record, read_record_pieces
    from jackettwin.service.workers.memory import at_most
    from jackettwin.store import is_waveform, read_waveform
    from jackettwin.study import LONG, PIECE_S

    source = Path(file.path)
    try:
        with at_most(file.memory_bytes):
            record = read_waveform(source) if is_waveform(source) else read_record(source, file.unsaid)
            _check(record, file)
            long = record.duration_s > LONG * PIECE_S
            records = list(read_record_pieces(source, PIECE_S, file.unsaid)) if long else [record]
        return tuple(stored(record, file.asset, Path(file.store)) for record in records)
    except InputError as error:
        return (Parsed("", problem=problem_of(error)),)
    except MemoryError:
        return (Parsed("", problem=_TOO_LARGE),)


_TOO_LARGE = {
    "detail": "the file expands to more than the memory of a worker",
    "field": "file",
    "remedy": "send it in pieces of an hour",
}


def _check(record: Record, file: File) -> None:
    """Refuse a record that expands too far, or of which it is not known when it was."""
    if record.data.size > file.samples_limit:
        raise InputError(
            "the file expands to too many samples",
            field="file",
            value=record.data.size,
            allowed=f"up to {file.samples_limit}",
            remedy="send it in pieces of an hour",
        )
    if record.start_utc is None:
        raise InputError(
            "a record without a start cannot be placed in time",
            field="start_utc",
            remedy="give start_utc in the description beside it, or a time column with a date",
        )
    if not EARLIEST <= record.start_utc <= file.latest_utc:
        raise InputError(
            "the clock of the record was wrong",
            field="start_utc",
            value=record.start_utc.isoformat(),
            allowed=f"{EARLIEST:%Y-%m-%d} to {file.latest_utc:%Y-%m-%d}",
            remedy="set the logger's clock, and give start_utc in the description beside the record",
        )


def stored(record: Record, asset: str, store: Path) -> Parsed:
    """Keep the samples of a record in the store, by their content."""
    from jackettwin.records import record_id
    from jackettwin.store import waveform_path, write_waveform

    assert record.start_utc is not None
    number = record_id(record)
    place = waveform_path(asset, record.start_utc, number)
    size = write_waveform(record, store / place)
    return Parsed(number, place, size, about(record))


def examine_twin(folder: str, most_freedoms: int, memory_bytes: int) -> Any:
    """Return the profile of a twin that a client sent, as a document; what is wrong with it comes back."""
    from jackettwin.service.workers import engine
    from jackettwin.service.workers.file_access import only_files_in
    from jackettwin.service.workers.memory import at_most

    try:
        with at_most(memory_bytes), only_files_in(Path(folder)):
            return engine.PROFILE.dump(engine.examine(Path(folder), most_freedoms))
    except InputError as error:
        error.file = engine.TWIN_FILE
        return error
    except (MemoryError, RecursionError):
        return InputError(
            "evaluating it takes more memory than a worker has", field="twin", remedy="send a smaller model"
        )


def read_conditions(path: str, *, asset: str, zone: str, end_stamped: bool) -> Any:
    """Read a table of conditions; an error of its input comes back, without our path."""
    from jackettwin.service.workers.condition_tables import read_table

    try:
        return read_table(Path(path), asset=asset, zone=zone, end_stamped=end_stamped)
    except InputError as error:
        error.file = None
        return error


def know(question: Question) -> Outcome | None:
    """Answer a question about what a turbine's records showed, and write the page on it.

    None if it takes days that were not sent: after a change, and once a baseline is whole.
    """
    from jackettwin.service.workers import engine, verdict

    if not question.identities:  # all its records were taken back
        nothing = {"known": {"status": verdict.NO_MODE, "parameters": {}}}
        return Outcome(json.dumps(nothing), of=question.of)
    twin = engine.load_twin(Path(question.twin_folder))
    try:
        judged, findings = verdict.watched(
            twin, question.identities, question.days, question.kept.get("judged")
        )
        followed, gone_on_from = verdict.through_time(twin, question)
        sums, past = engine.summed(twin, question.kept.get("past"), question.identities, question.days)
    except KeyError:
        return None
    changes, together = 0 if followed is None else len(followed.changes), question.kept.get("together")
    page, asked = None, verdict.due(together, question, changes)
    if asked or together is None:
        try:
            known, sections = verdict.known(twin, sums, question.newest, question.in_all)
            if sections is not None:
                about = f"version {question.version}"
                page = verdict.report(sections, followed, title=question.asset, subtitle=about)
        except JackettwinError as error:
            known = {"status": str(error), "parameters": {}}
        together = verdict.asked_together(known, question, changes)
    document = {
        "known": verdict.of_today(together["known"], followed), "supports": verdict.supports(followed),
        "judged": judged, "past": past, "followed": gone_on_from, "together": together,
    }  # fmt: skip
    return Outcome(json.dumps(document), findings=findings, page=page, of=question.of, same_page=not asked)


def observe_stored(task: Task) -> Outcome:
    """Observe a stored record. Input that is wrong comes back as a problem, faults of ours are raised."""
    from jackettwin.service.workers import engine

    try:
        twin, folder = engine.load_twin(Path(task.twin_folder)), Path(task.twin_folder)
        if not engine.profile_path(folder).exists():  # of an older version of the program, or restored
            engine.keep_profile(folder, engine.profile_of(twin))
        poles = (task.picks or {}).get("poles", ())
        return Outcome(*engine.observed(twin.model, Path(task.waveform), task.conditions, poles))
    except InputError as error:
        return Outcome(None, problem=problem_of(error))
    except JackettwinError as error:
        return Outcome(None, problem={"detail": str(error)})
