"""Observation of record files in parallel, reusing stored observations and skipping failed files.

The run, the following in time and the identification of many records use this module. Stored observations are
found by content, so that a changed file is observed again; processes are started only for the other files.
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
from jackettwin.records import FileDefaults, Record, read_record, record_content, record_id
from jackettwin.twin.model import TwinModel
from jackettwin.twin.observation import OBSERVATION, Observation
from jackettwin.twin.observe import observe
from jackettwin.version import __version__

FEWEST_FOR_PROCESSES = 3
"""Least number of records for which processes are started; fewer are faster in this process."""
DIED = "its process ended abruptly twice, perhaps because memory was short"


@dataclass(frozen=True)
class Failed:
    """A record that could not be observed, and the reason."""

    record: str
    problem: str


@dataclass(frozen=True)
class FileResult:
    """Result of a file.

    Attributes
    ----------
    key : str
        Key of the stored observation.
    observation : Observation or None
        None if the caller knows the record already.
    """

    key: str
    observation: Observation | None


@dataclass(frozen=True)
class _Work:
    """Processing of each file."""

    model: TwinModel
    defaults: FileDefaults | None
    keep: Keep
    known: Collection[str]
    dated: bool

    def see(self, file: Path, *, make: bool = True) -> FileResult | None:
        """Return the result of a file; without ``make`` only a stored one, or None."""
        record = read_record(file, self.defaults)
        if self.dated and record.start_utc is None:
            raise undated(file)
        if record_id(record) in self.known:
            return FileResult("", None)
        key = observation_key(record, self.model)
        seen = self.keep.get(OBSERVATION, key)
        if seen is None and not make:
            return None
        if seen is None:
            with located(file=file):
                seen = observe(record, self.model)
            self.keep.put(OBSERVATION, key, seen)
        return FileResult(key, seen)


def observe_files(
    files: Sequence[Path],
    model: TwinModel,
    *,
    defaults: FileDefaults | None = None,
    known: Collection[str] = (),
    dated: bool = False,
    workers: int | None = None,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Iterator[tuple[int, FileResult | Exception]]:
    """Yield the index of every file with its result or error, in order of completion.

    Parameters
    ----------
    defaults : FileDefaults, optional
        Rate and unit for files that do not state them.
    known : collection of str
        Identities of records that are not observed again.
    dated : bool
        Whether a record without a start is an error, raised before its identification.
    workers : int, optional
        Number of processes, by default one for each core. With 1, this process does the work.
    progress : Progress
        Receives a step for every file.
    keep : Keep
        Stores observations for later runs.
    """
    work = _Work(model, defaults, keep, frozenset(known), dated)
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
        except Exception as error:  # one record that fails must not stop the others
            yield i, error
    else:
        return
    for done, (k, result) in enumerate(in_processes(partial(_one, work), [files[i] for i in left], wanted)):
        if done:
            progress(f"identify records, {left[0] + done} of {len(files)} done")
        yield left[k], NumericalError(f"{files[left[k]]}: {DIED}") if result is None else result


def _one(work: _Work, file: Path) -> FileResult | Exception | None:
    """Return the result of one file, or the error, which the calling process raises or lists."""
    try:
        return work.see(file)
    except Exception as error:
        return error


def undated(record: str | Path) -> InputError:
    """Return the error of a record without a start time."""
    return InputError(
        "a record without a start cannot be followed in time",
        file=record,
        field="start_utc",
        remedy="give start_utc in its description (NAME.json), or a time column with a date",
    )


def observation_key(record: Record, model: TwinModel) -> str:
    """Return the identity of an observation before it is made: equal keys, equal observations."""
    settings = model.settings_hash(record.name)
    return digest([*record_content(record), model.model_hash, model.numbering, settings, __version__])


def sorted_out(
    files: Sequence[Path], results: Iterable[tuple[int, FileResult | Exception]]
) -> tuple[tuple[Observation, ...], tuple[Failed, ...]]:
    """Return the observations in the order of their files, and the failed files.

    Raises
    ------
    Exception
        Of a missing file, or of the first file if all failed.
    """
    found = dict(results)
    errors = {i: result for i, result in sorted(found.items()) if isinstance(result, Exception)}
    for i, error in errors.items():
        if not files[i].exists() or len(errors) == len(found):
            raise error
    failed = tuple(failure(files[i], error) for i, error in errors.items())
    seen = (result for _, result in sorted(found.items()) if isinstance(result, FileResult))
    return tuple(one.observation for one in seen if one.observation is not None), failed


def failure(file: Path, error: Exception) -> Failed:
    """Return a record that could not be observed, with the reason: its input, or a fault of jackettwin."""
    ours = f"{file}: a fault of jackettwin, {type(error).__name__}: "
    return Failed(str(file), f"{'' if isinstance(error, JackettwinError) else ours}{error}")
