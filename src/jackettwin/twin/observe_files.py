"""Records of files, observed: every core at work, nothing done twice, one that fails stops nothing.

Whoever observes files does it here: the main job, following in time, the identification of many. What is
kept is found by content, so that a file that changed is observed again; processes are started for what is
left only.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from jackettwin.errors import InputError, JackettwinError, NumericalError, located
from jackettwin.files import NOT_KEPT, Keep, digest
from jackettwin.processes import in_processes
from jackettwin.progress import SILENT, Progress
from jackettwin.records import Record, Unsaid, read_record, record_content, record_id
from jackettwin.twin.model import TwinModel
from jackettwin.twin.observation import OBSERVATION, Observation
from jackettwin.twin.observe import observe
from jackettwin.version import __version__

FEWEST_FOR_PROCESSES = 3
"""Fewer records are done sooner than other processes are started."""
DIED = "the process that worked on it ended abruptly, twice: out of memory?"


@dataclass(frozen=True)
class Failed:
    """A record that could not be observed, and why."""

    record: str
    problem: str


@dataclass(frozen=True)
class Seen:
    """What a file shows.

    Attributes
    ----------
    key : str
        What the observation is kept under.
    observation : Observation or None
        None if the record is known already, and was not asked for.
    """

    key: str
    observation: Observation | None


@dataclass(frozen=True)
class _Work:
    """What is done with every file."""

    model: TwinModel
    unsaid: Unsaid | None
    keep: Keep
    known: Collection[str]
    dated: bool

    def see(self, file: Path, *, make: bool = True) -> Seen | None:
        """Return what a file shows; unless ``make``, None if nothing is known of it yet."""
        record = read_record(file, self.unsaid)
        if self.dated and record.start_utc is None:
            raise undated(file)
        if record_id(record) in self.known:
            return Seen("", None)
        key = observation_key(record, self.model)
        seen = self.keep.get(OBSERVATION, key)
        if seen is None and not make:
            return None
        if seen is None:
            with located(file=file):
                seen = observe(record, self.model)
            self.keep.put(OBSERVATION, key, seen)
        return Seen(key, seen)


def observe_files(
    files: Sequence[Path],
    model: TwinModel,
    *,
    unsaid: Unsaid | None = None,
    known: Collection[str] = (),
    dated: bool = False,
    workers: int | None = None,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Iterator[tuple[int, Seen | Exception]]:
    """Yield the position of every file and what it shows, or why nothing, as they come.

    Parameters
    ----------
    unsaid : Unsaid, optional
        Rate and unit, for files that do not say them.
    known : collection of str
        Identities of records that are not observed again.
    dated : bool
        Whether a record without a start is an error: it is told before anything is identified in it.
    workers : int, optional
        Processes; default one a core. One works in this process.
    progress : Progress
        Told of every file.
    keep : Keep
        Keeps observations for the next time.
    """
    work = _Work(model, unsaid, keep, frozenset(known), dated)
    left: list[int] = []
    for i, file in enumerate(files):
        left = list(range(i, len(files)))
        wanted = min(workers or os.cpu_count() or 1, len(left))
        few = wanted < 2 or len(left) < FEWEST_FOR_PROCESSES
        progress(f"identify {file.name}")
        try:
            seen = work.see(file, make=few)
            if seen is None:
                break
            yield i, seen
        except Exception as error:  # of many records, one that fails must not stop the others
            yield i, error
    else:
        return
    for done, (k, result) in enumerate(in_processes(partial(_one, work), [files[i] for i in left], wanted)):
        if done:
            progress(f"identify records, {left[0] + done} of {len(files)} done")
        yield left[k], NumericalError(f"{files[left[k]]}: {DIED}") if result is None else result


def _one(work: _Work, file: Path) -> Seen | Exception | None:
    """Return what one file shows, or the error, which is for the other process to raise or to list."""
    try:
        return work.see(file)
    except Exception as error:
        return error


def undated(record: str | Path) -> InputError:
    """Return the error of a record that has no place in time."""
    return InputError(
        "a record without a start cannot be followed in time",
        file=record,
        field="start_utc",
        remedy="give start_utc in the description beside it (NAME.json), or a time column with a date",
    )


def observation_key(record: Record, model: TwinModel) -> str:
    """Return the identity of an observation before it is made: equal keys, equal observations."""
    settings = model.settings_hash(record.name)
    return digest([*record_content(record), model.model_hash, model.numbering, settings, __version__])


def sorted_out(
    files: Sequence[Path], results: Iterable[tuple[int, Seen | Exception]]
) -> tuple[tuple[Observation, ...], tuple[Failed, ...]]:
    """Return the observations in the order of their files, and the files that show nothing.

    Raises
    ------
    Exception
        Of a file that is not there, or the first one if no file shows anything.
    """
    found = dict(results)
    errors = {i: result for i, result in sorted(found.items()) if isinstance(result, Exception)}
    for i, error in errors.items():
        if not files[i].exists() or len(errors) == len(found):
            raise error
    failed = tuple(failure(files[i], error) for i, error in errors.items())
    seen = (result for _, result in sorted(found.items()) if isinstance(result, Seen))
    return tuple(one.observation for one in seen if one.observation is not None), failed


def failure(file: Path, error: Exception) -> Failed:
    """Return a record that could not be observed, with the reason: the input, or a fault of ours."""
    ours = f"{file}: a fault of jackettwin, {type(error).__name__}: "
    return Failed(str(file), f"{'' if isinstance(error, JackettwinError) else ours}{error}")
