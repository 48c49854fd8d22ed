"""The records of a twin, observed: what each shows, and the state they make together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path

from jackettwin.errors import NumericalError, located
from jackettwin.findings import Finding
from jackettwin.identification import ModalEstimate
from jackettwin.processes import in_processes
from jackettwin.records import Record, read_record
from jackettwin.records.readers.channels import Unsaid
from jackettwin.response.sensors import Sensor
from jackettwin.twin.advance import advance_all
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.examine import Examination
from jackettwin.twin.identified import Keep, not_kept
from jackettwin.twin.many import DIED, Failed, failure
from jackettwin.twin.model import TwinModel
from jackettwin.twin.observation import Observation
from jackettwin.twin.observe import examined, observed
from jackettwin.twin.state import TwinState, empty_state
from jackettwin.twin.sums import ModeTotal, average
from jackettwin.updating import Target

FEWEST_FOR_PROCESSES = 3
"""Fewer records are done sooner than other processes are started."""


@dataclass(frozen=True)
class Measured:
    """What the records say.

    Attributes
    ----------
    observations : one a record
    state : TwinState
        Which all of them make.
    examinations : one a record
        For figures; empty where none are drawn.
    findings : tuple of Finding
        Of making the state: records that are known already, or overlap.
    failed : records that could not be identified, and why; the others go on without them
    feet_stiffness_n_m : of the model's feet on which it is most like the measured modes; inf: as numbered
    """

    observations: tuple[Observation, ...]
    state: TwinState
    examinations: tuple[Examination, ...] = ()
    findings: tuple[Finding, ...] = ()
    failed: tuple[Failed, ...] = ()
    feet_stiffness_n_m: float = inf

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """Where the channels of the first record sit."""
        return self.observations[0].sensors if self.observations else ()

    def clearest(self, mode: int) -> tuple[ModalEstimate, float] | None:
        """Return a mode as the record most like the model shows it, and the MAC; None if none does."""
        shown = [one.modes[mode] for one in self.observations if mode in one.modes]
        best = max(shown, key=lambda pair: pair[1].mac, default=None)
        return None if best is None else (best[0], best[1].mac)


def measure(
    config: TwinConfig,
    model: TwinModel,
    *,
    compare: bool = False,
    workers: int = 1,
    step: Callable[[str], None],
    keep: Keep = not_kept,
) -> Measured:
    """Return what every record of a twin shows, and the state that they make.

    The modes of all records are recognised on the same feet, those most like all of them.

    Raises
    ------
    InputError
        If no record can be read and identified, or a sensor and a channel disagree; names file and field.
    """
    records, examinations, failed = _examined(
        config, model, compare=compare, workers=workers, step=step, keep=keep
    )
    with located(file=config.path):
        feet = model.likest_feet(examinations)
        observations = [
            observed(record, seen, model, feet) for record, seen in zip(records, examinations, strict=True)
        ]
    state, findings = advance_all(empty_state(model), observations)
    return Measured(
        tuple(observations),
        state,
        tuple(examinations),
        findings,
        failed,
        inf if feet is None else feet.stiffness_n_m,
    )


def _examined(
    config: TwinConfig,
    model: TwinModel,
    *,
    compare: bool,
    workers: int,
    step: Callable[[str], None],
    keep: Keep,
) -> tuple[list[Record], list[Examination], tuple[Failed, ...]]:
    """Return what the records show, and those that show nothing; the error of the first if none does."""
    found: dict[int, tuple[Record, Examination] | Exception | None] = {}
    for i, result in _results(config, model, compare=compare, workers=workers, step=step, keep=keep):
        path = config.records[i]
        if isinstance(result, Exception) and not path.exists():
            raise result
        found[i] = result
    failed: list[Failed] = []
    first: Exception | None = None
    for path, result in ((config.records[i], found[i]) for i in sorted(found)):
        error = NumericalError(DIED) if result is None else result
        if isinstance(error, Exception):
            first = first or error
            failed.append(failure(path, error))
    shown = [found[i] for i in sorted(found)]
    good = [result for result in shown if isinstance(result, tuple)]
    if first is not None and not good:
        raise first
    return [record for record, _ in good], [seen for _, seen in good], tuple(failed)


def _results(
    config: TwinConfig,
    model: TwinModel,
    *,
    compare: bool,
    workers: int,
    step: Callable[[str], None],
    keep: Keep,
) -> Iterator[tuple[int, tuple[Record, Examination] | Exception | None]]:
    """Yield what each record shows as it comes, or why nothing; None if it took its process along."""
    # a process needs to know how to examine, not the structure
    how = replace(model, assembly=None, numbered=None, feet=())
    names = [path.name for path in config.records]
    if compare or workers < 2 or len(names) < FEWEST_FOR_PROCESSES:
        for i, path in enumerate(config.records):
            step(f"identify {names[i]}")
            yield i, _one(how, config.unsaid, path, compare=compare and i == 0, keep=keep)
        return
    step(f"identify {names[0]}")
    work = partial(_one, how, config.unsaid, keep=keep)
    for done, (i, result) in enumerate(in_processes(work, config.records, min(workers, len(names))), start=1):
        if done < len(names):
            step(f"identify records, {done} of {len(names)} done")
        yield i, result


def _one(
    model: TwinModel, unsaid: Unsaid, path: Path, *, compare: bool = False, keep: Keep = not_kept
) -> tuple[Record, Examination] | Exception:
    """Return what one record shows, or the error: one that fails must not stop the others."""
    try:
        record = read_record(path, unsaid)
        with located(file=path):
            return record, examined(record, model, compare=compare, keep=keep)
    except Exception as error:
        return error


def mean_target(mode: int, total: ModeTotal) -> Target:
    """Return the mean of one mode over all records as a target."""
    mean = average(total)
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return Target(mode, f, f * mean.log_std[0], zeta, zeta * mean.log_std[1], mean.correlation)
