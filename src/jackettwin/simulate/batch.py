"""Simulate a set of cases on all cores, skipping finished ones."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import replace
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError
from jackettwin.files import write_json
from jackettwin.processes import worker_pool
from jackettwin.records import write_record
from jackettwin.records.readers.description import read_description
from jackettwin.simulate.record import simulate
from jackettwin.simulate.scenario.files import scenario_from
from jackettwin.simulate.scenario.sets import Case, ScenarioSet
from jackettwin.version import __version__


def run_case(case: Case, folder: Path) -> None:
    """Simulate one case and write its record; the key of the case goes with it."""
    done = simulate(scenario_from(case.data, case.path))
    metadata = {**done.record.metadata, "case_key": case.key, "wall_s": done.wall_s}
    start = case.start_utc or done.record.start_utc
    record = replace(done.record, name=case.name, start_utc=start, metadata=metadata)
    write_record(record, record_path(case, folder))


def record_path(case: Case, folder: Path) -> Path:
    """Return the path of a case's record."""
    return folder / f"{case.name}.parquet"


def pending_cases(chosen: ScenarioSet, folder: Path) -> tuple[Case, ...]:
    """Return the cases without a finished record of theirs in ``folder``."""
    return tuple(case for case in chosen.cases if not _finished(case, folder))


def _finished(case: Case, folder: Path) -> bool:
    path = record_path(case, folder)
    if not path.exists() or not path.with_suffix(".json").exists():
        return False
    try:
        return read_description(path.with_suffix(".json")).metadata.get("case_key") == case.key
    except InputError:  # incomplete, or of another case
        return False


def run_set(
    chosen: ScenarioSet,
    folder: Path,
    *,
    workers: int | None = None,
    step: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Run what is pending of a set, write ``manifest.json`` and return its content.

    Parameters
    ----------
    workers : int, optional
        Processes; default one a core, and none but this one for a single case.
    step : callable
        Called with the name of each finished case.

    Raises
    ------
    InputError
        If the scenario of the first case is wrong: then nothing is simulated.
    """
    first = chosen.cases[0]
    scenario_from(first.data, first.path)  # refuse before the long computation starts
    folder.mkdir(parents=True, exist_ok=True)
    todo = pending_cases(chosen, folder)
    n = min(workers or os.cpu_count() or 1, len(todo))
    if n <= 1:
        for case in todo:
            run_case(case, folder)
            step(case.name)
    else:
        for name in _in_parallel(todo, folder, n):
            step(name)
    manifest = _manifest(chosen, folder)
    write_json(manifest, folder / "manifest.json")
    return manifest


def _in_parallel(todo: tuple[Case, ...], folder: Path, workers: int) -> Iterator[str]:
    """Yield the names of cases as they are done; the first error, or Ctrl-C, stops the rest."""
    with worker_pool(workers) as pool:
        running: dict[Future[None], Case] = {pool.submit(run_case, case, folder): case for case in todo}
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                case = running.pop(future)
                future.result()
                yield case.name


def _manifest(chosen: ScenarioSet, folder: Path) -> dict[str, Any]:
    """Return the content of every record of the set, including its truth."""
    cases = []
    for case in chosen.cases:
        path = record_path(case, folder)
        known = read_description(path.with_suffix(".json"))
        cases.append(
            {
                "name": case.name,
                "record": path.name,
                "key": case.key,
                "conditions": dict(known.conditions),
                "true_modes": known.metadata["true_modes"],
                "wall_s": known.metadata["wall_s"],
            }
        )
    return {"set": chosen.name, "code_version": __version__, "cases": cases}
