"""Many records: memory flat, nothing done twice.

Observations go to a folder as they come and are read back one by one, in the order of the files: none stays
in memory. What is kept there is found by content, so a run that was stopped gives to the last digit what it
would have given in one go.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jackettwin.files import KeptInFolder
from jackettwin.findings import Finding
from jackettwin.progress import SILENT, Progress
from jackettwin.records import Unsaid
from jackettwin.twin import OBSERVATION, Failed, Observation, TwinModel, observe_files
from jackettwin.twin.observe_files import failure


@dataclass(frozen=True)
class Batch:
    """Observed records, on disk: iterating reads them in the order of the files.

    Attributes
    ----------
    results : tuple of Path
        One file for every record that was observed, each record once.
    failed : tuple of Failed
        The others.
    findings : tuple of Finding
        Records whose samples are those of another.
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
    unsaid: Unsaid | None = None,
    workers: int | None = None,
    progress: Progress = SILENT,
) -> Batch:
    """Observe records on all cores; one that cannot be observed is listed and stops nothing.

    Parameters
    ----------
    model : TwinModel
        One without a structure identifies, and recognises nothing.
    keep : KeptInFolder
        What is there is not observed again, what is new is put there as it comes.
    unsaid : Unsaid, optional
        Rate and unit, for files that do not say them.
    workers : int, optional
        Processes; default one a core. One works in this process.
    progress : Progress
        Told of every record.
    """
    results: dict[int, Path] = {}
    failed: dict[int, Failed] = {}
    own: dict[int, str] = {}
    for i, seen in observe_files(files, model, unsaid=unsaid, workers=workers, progress=progress, keep=keep):
        if isinstance(seen, Exception):
            failed[i] = failure(files[i], seen)
        elif seen.observation is not None:
            results[i], own[i] = keep.place(OBSERVATION, seen.key), seen.observation.record_id
            if not results[i].exists():  # no room: that is said here, where it can be raised
                OBSERVATION.write(seen.observation, results[i])
    first: dict[str, int] = {}
    doubled = [i for i in sorted(own) if first.setdefault(own[i], i) != i]
    return Batch(
        tuple(results[i] for i in sorted(results) if i not in doubled),
        tuple(failed[i] for i in sorted(failed)),
        tuple(Finding("record_doubled", files[i].name, {"as": files[first[own[i]]].name}) for i in doubled),
    )
