"""Tasks of workers, with plain values as inputs and outputs: reading a file, observing a stored record."""

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
    from jackettwin.records import FileDefaults, Record


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
    """Result of a task: a document, or a problem (field, value, remedy) of the record itself.

    With both, the record was observed and is of another structure.

    ``page`` is the report on a turbine's state, and ``of`` the identity of that state; with ``same_page`` the
    present report is unchanged.
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
    """A file to read, and its limits.

    Attributes
    ----------
    samples_limit : largest number of samples over all channels
    memory_bytes : memory limit of the process that reads it
    latest_utc : latest time at which a record may begin
    defaults : properties of files that do not state them, from the twin
    """

    path: str
    asset: str
    store: str
    samples_limit: int
    memory_bytes: int
    latest_utc: datetime
    defaults: FileDefaults | None = None


EARLIEST = datetime(2001, 1, 1, tzinfo=UTC)
"""Earliest start of a record, as clocks that were never set start in 1970, 1980 or 2000."""


@dataclass(frozen=True)
class Parsed:
    """A record whose waveform is in the store, or the problem with its file."""

    record_id: str
    waveform: str | None = None
    size_bytes: int = 0
    about: dict[str, Any] = field(default_factory=dict)
    problem: dict[str, Any] | None = None


def about(record: Record) -> dict[str, Any]:
    """Return the searchable properties of a record."""
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
    """Read a file of any supported format and store its samples.

    A file longer than an hour is divided into records of ten minutes, as in ``jackettwin identify``. The
    waveform files of another store are also supported.
    """
    from jackettwin.records import read_record, read_record_pieces
    from jackettwin.service.workers.memory import at_most
    from jackettwin.store import is_waveform, read_waveform
    from jackettwin.study import LONG, PIECE_S

    source = Path(file.path)
    try:
        with at_most(file.memory_bytes):
            record = read_waveform(source) if is_waveform(source) else read_record(source, file.defaults)
            _check(record, file)
            long = record.duration_s > LONG * PIECE_S
            records = list(read_record_pieces(source, PIECE_S, file.defaults)) if long else [record]
        return tuple(stored(record, file.asset, Path(file.store)) for record in records)
    except InputError as error:
        return (Parsed("", problem=problem_of(error)),)
    except MemoryError:
        return (Parsed("", problem=_TOO_LARGE),)


_TOO_LARGE = {
    "detail": "reading the file needs more memory than a worker has",
    "field": "file",
    "remedy": "send it in pieces of an hour",
}


def _check(record: Record, file: File) -> None:
    """Raise an error on a record that is too large, or has no valid start time."""
    if record.data.size > file.samples_limit:
        raise InputError(
            "the file has too many samples",
            field="file",
            value=record.data.size,
            allowed=f"up to {file.samples_limit}",
            remedy="send it in pieces of an hour",
        )
    if record.start_utc is None:
        raise InputError(
            "the record has no start time",
            field="start_utc",
            remedy="give start_utc in its description, or a time column with a date",
        )
    if not EARLIEST <= record.start_utc <= file.latest_utc:
        raise InputError(
            "the clock of the record was wrong",
            field="start_utc",
            value=record.start_utc.isoformat(),
            allowed=f"{EARLIEST:%Y-%m-%d} to {file.latest_utc:%Y-%m-%d}",
            remedy="set the logger's clock, and give start_utc in the record's description",
        )


def stored(record: Record, asset: str, store: Path) -> Parsed:
    """Store the samples of a record, by their content."""
    from jackettwin.records import record_id
    from jackettwin.store import waveform_path, without_false_digits, write_waveform

    record = without_false_digits(record)
    assert record.start_utc is not None
    number = record_id(record)
    place = waveform_path(asset, record.start_utc, number)
    size = write_waveform(record, store / place)
    return Parsed(number, place, size, about(record))


def examine_twin(folder: str, most_freedoms: int, memory_bytes: int) -> Any:
    """Return the profile of a twin that a client sent, as a document, or the problem with it."""
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
    """Read a table of conditions, or return the problem with it, without the server's path."""
    from jackettwin.service.workers.condition_tables import read_table

    try:
        return read_table(Path(path), asset=asset, zone=zone, end_stamped=end_stamped)
    except InputError as error:
        error.file = None
        return error


def know(question: Question) -> Outcome | None:
    """Return the estimates from a turbine's records, and the report.

    None if they need days that were not sent, as after a change or when a baseline is complete.
    """
    from jackettwin.service.workers import engine, verdict

    if not question.identities:  # all its records were withdrawn
        nothing = {"known": {"status": verdict.NO_MODE, "parameters": {}}}
        return Outcome(json.dumps(nothing), of=question.of)
    twin = engine.load_twin(Path(question.twin_folder))
    try:
        judged, findings, monitoring = verdict.watched(
            twin, question.identities, question.days, question.kept.get("judged")
        )
        followed, gone_on_from = verdict.through_time(twin, question)
        life, past_life, of_life = verdict.lived(
            twin, question.identities, question.days, question.kept.get("lived")
        )
        sums, past = engine.summed(twin, question.kept.get("past"), question.identities, question.days)
    except KeyError:
        return None
    changes, together = 0 if followed is None else len(followed.changes), question.kept.get("together")
    page, asked = None, verdict.due(together, question, changes)
    if asked or together is None:
        try:
            known, sections = verdict.known(twin, sums, question.newest, question.in_all)
            if sections is not None:
                about = f"version {question.version} · {known['records']} records"
                about += f" up to {(known['until_utc'] or '')[:10]} · intervals are 90 %"
                page = verdict.report(sections, followed, title=question.asset, subtitle=about)
        except JackettwinError as error:
            known = {"status": str(error), "parameters": {}}
        together = verdict.asked_together(known, question, changes)
    document = {
        "known": verdict.of_today(together["known"], followed), "supports": verdict.supports(followed),
        "judged": judged, "past": past, "followed": gone_on_from, "together": together, "life": life,
        "lived": past_life, "watch": monitoring,
    }  # fmt: skip
    return Outcome(
        json.dumps(document), findings=(*findings, *of_life), page=page, of=question.of, same_page=not asked
    )


def observe_stored(task: Task) -> Outcome:
    """Observe a stored record; wrong input is returned as a problem, other faults are raised."""
    from jackettwin.service.workers import engine

    try:
        twin, folder = engine.load_twin(Path(task.twin_folder)), Path(task.twin_folder)
        if not engine.profile_path(folder).exists():  # the version is from an older program or a backup
            engine.keep_profile(folder, engine.profile_of(twin))
        poles = (task.picks or {}).get("poles", ())
        seen = engine.observed(twin.model, Path(task.waveform), task.conditions, poles)
        return Outcome(**seen._asdict())
    except InputError as error:
        return Outcome(None, problem=problem_of(error))
    except JackettwinError as error:
        return Outcome(None, problem={"detail": str(error)})
