"""The records of a twin, observed: what each shows, and the state they make together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from jackettwin.errors import located
from jackettwin.findings import Finding
from jackettwin.identification import ModalEstimate
from jackettwin.records import Record, read_record
from jackettwin.response.sensors import Sensor
from jackettwin.twin.advance import advance_all
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.examine import Examination
from jackettwin.twin.identified import Keep, not_kept
from jackettwin.twin.many import Failed, failure
from jackettwin.twin.model import TwinModel
from jackettwin.twin.observation import Observation
from jackettwin.twin.observe import examined, observed
from jackettwin.twin.state import TwinState, empty_state
from jackettwin.twin.sums import ModeTotal, average
from jackettwin.updating import Target


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
    records, examinations, failed = _examined(config, model, compare=compare, step=step, keep=keep)
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
    step: Callable[[str], None],
    keep: Keep,
) -> tuple[list[Record], list[Examination], tuple[Failed, ...]]:
    """Return what the records show, and those that show nothing; the error of the first if none does."""
    records: list[Record] = []
    examinations: list[Examination] = []
    failed: list[Failed] = []
    first: Exception | None = None
    for path in config.records:
        step(f"identify {path.name}")
        try:
            record = read_record(path, config.unsaid)
            with located(file=path):
                seen = examined(record, model, compare=compare and not examinations, keep=keep)
        except Exception as error:  # of many records, one that fails must not stop the others
            if not path.exists():
                raise
            first = first or error
            failed.append(failure(path, error))
        else:
            records.append(record)
            examinations.append(seen)
    if first is not None and not records:
        raise first
    return records, examinations, tuple(failed)


def mean_target(mode: int, total: ModeTotal) -> Target:
    """Return the mean of one mode over all records as a target."""
    mean = average(total)
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return Target(mode, f, f * mean.log_std[0], zeta, zeta * mean.log_std[1], mean.correlation)
