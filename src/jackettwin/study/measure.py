"""The records of a twin, observed: what each shows, and the state they make together."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import located
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.findings import Finding
from jackettwin.identification import Examination, ModalEstimate
from jackettwin.progress import SILENT, Progress
from jackettwin.records import read_record
from jackettwin.response import Sensor
from jackettwin.twin import (
    Failed,
    Observation,
    TwinConfig,
    TwinModel,
    TwinState,
    advance_all,
    average,
    empty_state,
    examined,
    observe_files,
    sorted_out,
)
from jackettwin.twin.exact_sums import ModeTotal
from jackettwin.twin.observe import observed
from jackettwin.twin.observe_files import Seen
from jackettwin.updating import Target


@dataclass(frozen=True)
class Measured:
    """What the records say.

    Attributes
    ----------
    observations : one a record, the first of those with the same samples; without those of other structures,
        unless all are
    state : TwinState
        Which all of them make.
    shown : Examination or None
        Of the first record that shows something, for figures.
    findings : tuple of Finding
        Of making the state: records that are known already, or overlap.
    failed : records that could not be identified, and why; the others go on without them
    in_all : (number, seconds), optional
        Of the state's records and of their durations, if the observations are the newest of them alone.
    """

    observations: tuple[Observation, ...]
    state: TwinState
    shown: Examination | None = None
    findings: tuple[Finding, ...] = ()
    failed: tuple[Failed, ...] = ()
    in_all: tuple[int, float] | None = None

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
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Measured:
    """Return what every record of a twin shows, and the state that they make.

    Raises
    ------
    InputError
        If no record can be read and identified, or a sensor and a channel disagree; names file and field.
    """
    shown: Examination | None = None
    results: list[tuple[int, Seen | Exception]] = []
    for i, path in enumerate(config.records):
        progress(f"identify {path.name}")
        try:
            record = read_record(path, config.unsaid)
            with located(file=path):
                shown = examined(record, model, compare=compare, keep=keep)
                results.append((i, Seen("", observed(record, shown, model))))
            break
        except Exception as error:  # of many records, one that fails must not stop the others
            results.append((i, error))
    n = len(results)
    others = observe_files(
        config.records[n:], model, unsaid=config.unsaid, workers=workers, progress=progress, keep=keep
    )
    results += [(n + i, seen) for i, seen in others]
    observations, failed = sorted_out(config.records, results)
    state, findings = advance_all(empty_state(model), observations)
    first = {one.record_id: one for one in reversed(observations)}
    once = tuple(one for one in observations if first[one.record_id] is one)
    own = tuple(one for one in once if not one.mismatched)
    return Measured(own or once, state, shown, findings, failed)


def mean_target(mode: int, total: ModeTotal) -> Target:
    """Return the mean of one mode over all records as a target."""
    mean = average(total)
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return Target(mode, f, f * mean.log_std[0], zeta, zeta * mean.log_std[1], mean.correlation)
