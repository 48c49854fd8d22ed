"""Many records: every core at work, memory flat, nothing done twice.

Each record becomes a few kilobytes of JSON in a folder, under a name that holds a hash of the file's
size and time, its description and the settings: what is there already is not computed again. Results are
read back from there one by one, in the order of the files, whoever wants them: none stays in memory, and a
run that was stopped gives to the last digit what it would have given in one go.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError, JackettwinError
from jackettwin.files import atomic_path
from jackettwin.files.json import null_for_nan
from jackettwin.identification import Identification, IdentificationSettings
from jackettwin.identification.picks import Pick
from jackettwin.identification.storage import from_plain, slim, to_plain
from jackettwin.processes import in_processes
from jackettwin.records.readers import description_file, formats
from jackettwin.records.readers.channels import Unsaid
from jackettwin.twin.examine import Examination, examine_file
from jackettwin.twin.identified import Keep, not_kept
from jackettwin.version import __version__

FEWEST_FOR_PROCESSES = 6
"""Fewer records are done sooner than other processes are started."""
DIED = "the process that worked on it ended abruptly, twice: out of memory?"


@dataclass(frozen=True)
class Seen:
    """What is kept of an observed record.

    Attributes
    ----------
    identification : Identification
        Without poles and spectrum.
    quality : dict
        ``Quality.summary()``.
    conditions : dict
        What the record says of wind, yaw and state.
    """

    identification: Identification
    quality: dict[str, Any]
    conditions: dict[str, Any]


@dataclass(frozen=True)
class Failed:
    """A record that could not be identified, and why."""

    record: str
    problem: str


def failure(file: Path, error: Exception) -> Failed:
    """Return a record that could not be identified, with the reason: the input, or a fault of ours."""
    ours = (
        ""
        if isinstance(error, JackettwinError)
        else f"{file}: a fault of jackettwin, {type(error).__name__}: "
    )
    return Failed(str(file), f"{ours}{error}")


@dataclass(frozen=True)
class Batch:
    """Observed records, on disk: iterating reads them in the order of the files.

    Attributes
    ----------
    results : tuple of Path
        One file for every record that was identified.
    failed : tuple of Failed
        The others.
    """

    results: tuple[Path, ...]
    failed: tuple[Failed, ...]

    def __len__(self) -> int:
        return len(self.results)

    def __iter__(self) -> Iterator[Seen]:
        return map(_read, self.results)


@dataclass(frozen=True)
class _Work:
    """What is done with every record."""

    settings: IdentificationSettings
    picks: tuple[Pick, ...]
    unsaid: Unsaid


def record_files(sources: Sequence[str | Path]) -> tuple[Path, ...]:
    """Return the files meant by paths of records and of folders of records, folders in the order of names.

    Raises
    ------
    InputError
        If a path does not exist or a folder holds no record.
    """
    known = {extension for form in formats() for extension in form.extensions}
    files: list[Path] = []
    for source in map(Path, sources):
        if not source.is_dir():
            files.append(source)
            continue
        inside = sorted(p for p in source.iterdir() if p.suffix.lower() in known)
        if not inside:
            raise InputError(
                "folder holds no record",
                file=source,
                allowed=", ".join(sorted(known)),
                remedy="give the folder that holds the files, or the files",
            )
        files += inside
    if len(files) > 1:
        for file in files:
            if not file.exists():
                raise InputError("no such file", file=file, remedy="check the path")
    return tuple(files)


def observe_many(
    files: Sequence[Path],
    settings: IdentificationSettings,
    *,
    folder: Path,
    picks: tuple[Pick, ...] = (),
    unsaid: Unsaid | None = None,
    workers: int | None = None,
    step: Callable[[str], None] = lambda _: None,
    keep: Keep = not_kept,
) -> Batch:
    """Observe records on all cores; one that cannot be identified is listed and stops nothing.

    Parameters
    ----------
    folder : Path
        Of results: those that are there are not computed again, new ones are put there as they come.
    picks : tuple of Pick
        Poles to take instead of the automatic selection, for the records they name.
    unsaid : Unsaid, optional
        Rate and unit, for files that do not say them.
    workers : int, optional
        Processes; default one a core. One works in this process.
    step : callable
        Told the name of every record that is done.
    keep : callable
        Keeps what was identified for the next time; goes to other processes.
    """
    work = _Work(settings, picks, unsaid or Unsaid())
    places = [_place(folder, file, work) for file in files]
    left = []
    for i, place in enumerate(places):
        if _readable(place):
            step(files[i].name)
        else:
            left.append(i)
    failed: dict[int, Failed] = {}
    for i, result in _computed(files, left, work, workers, keep):
        if isinstance(result, Failed):
            failed[i] = result
        else:
            _write(result, places[i])
        step(files[i].name)
    return Batch(
        tuple(place for i, place in enumerate(places) if i not in failed),
        tuple(failed[i] for i in sorted(failed)),
    )


def kept(seen: Examination) -> Seen:
    """Return what is kept of an observation."""
    return Seen(slim(seen.identification), seen.quality.summary(), dict(seen.record.conditions))


def _computed(
    files: Sequence[Path],
    left: list[int],
    work: _Work,
    workers: int | None,
    keep: Keep,
) -> Iterator[tuple[int, Seen | Failed]]:
    """Yield results as they come, with a bounded number of records under way."""
    n_workers = min(workers or os.cpu_count() or 1, len(left))
    if n_workers < 2 or (workers is None and len(left) < FEWEST_FOR_PROCESSES):
        for i in left:
            yield i, _one(work, files[i], keep)
        return
    for k, result in in_processes(partial(_one, work, keep=keep), [files[i] for i in left], n_workers):
        yield left[k], result or Failed(str(files[left[k]]), DIED)


def _one(work: _Work, file: Path, keep: Keep = not_kept) -> Seen | Failed:
    """Return what a record shows, or why it shows nothing, whatever went wrong."""
    try:
        seen = examine_file(file, work.settings, picks=work.picks, unsaid=work.unsaid, keep=keep)
        return kept(seen)
    except Exception as error:  # one record must not end a batch; alone it shows the traceback
        return failure(file, error)


def _place(folder: Path, file: Path, work: _Work) -> Path:
    """Return where the result of a record is kept."""
    stamps = [
        (p.name, p.stat().st_size, p.stat().st_mtime_ns)
        for p in (file, description_file(file))
        if p is not None and p.exists()
    ]
    key = json.dumps([str(file.resolve()), stamps, asdict(work), __version__], default=str)
    return folder / f"{file.stem}-{hashlib.sha256(key.encode()).hexdigest()[:16]}.json"


def _write(seen: Seen, path: Path) -> None:
    plain = {
        "identification": to_plain(seen.identification),
        "quality": seen.quality,
        "conditions": seen.conditions,
    }
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(null_for_nan(plain), ensure_ascii=False), encoding="utf-8")


def _read(path: Path) -> Seen:
    plain = json.loads(path.read_text(encoding="utf-8"))
    return Seen(from_plain(plain["identification"]), plain["quality"], plain["conditions"])


def _readable(path: Path) -> bool:
    """Tell whether there is a result, one that this version can read."""
    try:
        _read(path)
    except (OSError, ValueError, KeyError, TypeError):
        return False
    return True
