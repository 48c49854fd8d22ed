"""Observation of a twin's records, and the state that they form."""

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
from jackettwin.twin.observe_files import FileResult
from jackettwin.updating import Target


@dataclass(frozen=True)
class Measured:
    """Observations of a twin's records.

    Attributes
    ----------
    observations : one for each record with different samples; records of other structures are left out unless
        all are
    state : TwinState
        Formed by all records.
    shown : Examination or None
        Of the first record with a result, for figures.
    findings : tuple of Finding
        On records that the state contains already or that overlap.
    failed : records that could not be identified, and the reasons
    in_all : (number, seconds), optional
        Number and total duration of the state's records, if ``observations`` are only the newest.
    """

    observations: tuple[Observation, ...]
    state: TwinState
    shown: Examination | None = None
    findings: tuple[Finding, ...] = ()
    failed: tuple[Failed, ...] = ()
    in_all: tuple[int, float] | None = None

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """Sensors of the first record's channels."""
        return self.observations[0].sensors if self.observations else ()

    def clearest(self, mode: int) -> tuple[ModalEstimate, float] | None:
        """Return the estimate of a mode with the highest MAC among the records, and that MAC, or None."""
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
    """Return the observation of every record of a twin, and the state that they form.

    Raises
    ------
    InputError
        If no record can be read and identified, or a sensor and a channel disagree; the error names file and
        field.
    """
    shown: Examination | None = None
    results: list[tuple[int, FileResult | Exception]] = []
    for i, path in enumerate(config.records):
        progress(f"identify {path.name}")
        try:
            record = read_record(path, config.defaults)
            with located(file=path):
                shown = examined(record, model, compare=compare, keep=keep)
                results.append((i, FileResult("", observed(record, shown, model))))
            break
        except Exception as error:  # one record that fails must not stop the others
            results.append((i, error))
    n = len(results)
    others = observe_files(
        config.records[n:], model, defaults=config.defaults, workers=workers, progress=progress, keep=keep
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
