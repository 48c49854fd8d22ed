"""Identification of many records in constant memory, without repeating stored results.

Each observation is written to a folder and read back later in the order of the files, so that none stays in
memory. Stored observations are found by the content of their records: a run continued after an interruption
gives the same result to the last digit as an uninterrupted one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jackettwin.files import KeptInFolder
from jackettwin.findings import Finding
from jackettwin.progress import SILENT, Progress
from jackettwin.records import FileDefaults
from jackettwin.twin import OBSERVATION, Failed, Observation, TwinModel, observe_files
from jackettwin.twin.observe_files import failure


@dataclass(frozen=True)
class Batch:
    """Observed records on disk; iteration reads them in the order of the files.

    Attributes
    ----------
    results : tuple of Path
        One file for each distinct record that was observed.
    failed : tuple of Failed
        Records that could not be observed.
    findings : tuple of Finding
        One for each record with the same samples as another.
    """

    results: tuple[Path, ...]
    failed: tuple[Failed, ...]
    findings: tuple[Finding, ...] = ()

    def __len__(self) -> int:
        return len(self.results)

    def __iter__(self) -> Iterator[Observation]:
        return map(OBSERVATION.read, self.results)


def observe_many(
    files: Sequence[Path],
    model: TwinModel,
    *,
    keep: KeptInFolder,
    defaults: FileDefaults | None = None,
    workers: int | None = None,
    progress: Progress = SILENT,
) -> Batch:
    """Observe records on all cores; one that cannot be observed is listed and skipped.

    Parameters
    ----------
    model : TwinModel
        Without a structure, modes are identified but not labelled.
    keep : KeptInFolder
        Stored observations are reused; each new one is stored at once.
    defaults : FileDefaults, optional
        Rate and unit for files that do not state them.
    workers : int, optional
        Number of processes, by default one for each core. With 1, this process does the work.
    progress : Progress
        Receives a step for every record.
    """
    results: dict[int, Path] = {}
    failed: dict[int, Failed] = {}
    own: dict[int, str] = {}
    for i, seen in observe_files(
        files, model, defaults=defaults, workers=workers, progress=progress, keep=keep
    ):
        if isinstance(seen, Exception):
            failed[i] = failure(files[i], seen)
        elif seen.observation is not None:
            results[i], own[i] = keep.place(OBSERVATION, seen.key), seen.observation.record_id
            if (
                not results[i].exists()
            ):  # the disk was full: the worker could not store it, so store it here and raise the error
                OBSERVATION.write(seen.observation, results[i])
    first: dict[str, int] = {}
    doubled = [i for i in sorted(own) if first.setdefault(own[i], i) != i]
    return Batch(
        tuple(results[i] for i in sorted(results) if i not in doubled),
        tuple(failed[i] for i in sorted(failed)),
        tuple(Finding("record_doubled", files[i].name, {"as": files[first[own[i]]].name}) for i in doubled),
    )
