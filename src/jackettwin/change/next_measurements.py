"""Ranking of further measurements and inspections that would distinguish the causes of a change.

All frequencies and damping ratios of the model's modes, monitored or not, in every known operating state,
and inspections wherever a cause is visible, are ranked by expected information.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.causes import SeenCauses
from jackettwin.change.standing_modes import MODES
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.response import LOCAL
from jackettwin.watching import (
    Cause,
    CauseVerdict,
    Diagnosis,
    History,
    Watch,
    expected_information,
    typical,
    unexplained_std,
)

_RECORDS, _RECORD_S, _SHOWN = 144, 600.0, 5
"""Ten-minute records of a further measurement over a month, their length [s],
and the number of measurements named."""
_INDEPENDENT = 7.5
"""Independent values per month of unexplained variation that lasts two days."""
_USUAL_ZETA, _TELLING, _LIKELY, _LOOK_STD = 0.01, 0.01, 0.01, 0.3
"""Damping ratio of a mode that is not monitored; information [nats] below which nothing is suggested;
smallest probability of a cause that counts; and error of an inspection relative to what there is to be seen,
of which one in twenty is inconclusive."""
_UNEXPLAINED = {"frequency": 1e-3, "damping": 0.05}
"""Unexplained standard deviations if no quantity of the kind is monitored."""
LOOKS = (
    (r"^scour", "a survey of the seabed at the feet"),
    (r" (lost|weakened)( |$)", "a look at {0} and those alike"),
    (r" flooded( |$)", "flooded-member detection at {0} and those alike"),
    (r"^marine growth", "the thickness of the growth under water"),
    (r"^mass of the RNA", "the log of what was changed on top of the tower"),
    (r"^corrosion", "plate thickness in the splash zone"),
    (r"^grouted", "a look at the grouted or bolted connection"),
    (r"^sensor: clock", "the logger's clock beside a reference"),
    (r"^sensor: yaw", "the yaw reading beside the nacelle's position"),
    (r"^sensor: more scatter", "a second accelerometer beside the one in doubt"),
)
"""Places where causes are visible on inspection, by their names; those in the ground are not."""


@dataclass(frozen=True)
class Measurement:
    """A possible measurement or inspection, and its expected information on the cause [nats].

    Attributes
    ----------
    mode, quantity, state, sensor : of a quantity: label, "frequency" or "damping", the operating state that
        tells most, and what to see it with if no sensor shows it yet; empty where that is not the question
    """

    what: str
    gain_nats: float
    mode: str = ""
    quantity: str = ""
    state: str = ""
    sensor: str = ""


@dataclass(frozen=True)
class Circumstances:
    """Conditions of a further measurement.

    Attributes
    ----------
    states : names of the operating states
    damping : (n_states, MODES) usual damping ratios of the model's modes
    unexplained : (2,) standard deviation of ln f and ln ζ that nothing explains
    """

    states: tuple[str, ...]
    damping: FloatArray
    unexplained: FloatArray

    @classmethod
    def of(cls, watch: Watch, baseline: History, labels: Sequence[str]) -> Circumstances:
        """Return the conditions of a baseline; other modes are given the damping of monitored ones."""
        damping = np.full((len(watch.design.states), MODES), _USUAL_ZETA)
        for row, state in zip(damping, watch.design.states, strict=True):
            zeta = typical(baseline.damping[baseline.states == state])
            if np.isfinite(zeta).any():
                row[:] = np.nanmedian(zeta)
            for label, value in zip(baseline.labels, zeta, strict=True):
                if label in labels and np.isfinite(value):
                    row[labels.index(label)] = value
        usual = dict(_UNEXPLAINED)
        usual |= {block.kind: float(np.median(unexplained_std(block))) for block in watch.blocks}
        names = tuple(baseline.state_names[state] for state in watch.design.states)
        return cls(names, damping, np.array([usual["frequency"], usual["damping"]]))

    def noise(self, frequency_hz: FloatArray) -> FloatArray:
        """Return the accuracy of a change of ln f and ln ζ from a month's records, (n_states, 2, n_modes).

        It is the long-data limit (Au 2014) plus unexplained variation.
        """
        limits = np.array([long_data_limits(frequency_hz, z, _RECORDS * _RECORD_S) for z in self.damping])
        slow = self.unexplained[None, :, None] ** 2 / _INDEPENDENT
        return np.asarray(np.sqrt(2.0 * (limits**2 + slow)))


def next_measurements(
    seen: SeenCauses, diagnosis: Diagnosis, around: Circumstances
) -> tuple[Measurement, ...]:
    """Return measurements and inspections that distinguish likely causes, the most informative first.

    A quantity is measured for a month before and after; it appears once, in its most informative state.
    An inspection shows whether the causes visible there are present.
    """
    by_name = {v.cause: v for v in diagnosis.verdicts}
    likely = [c for c in seen.model.causes if by_name[c.name].probability > _LIKELY]
    found = _looks([v for v in diagnosis.verdicts if v.probability > _LIKELY])
    noise = around.noise(seen.model.frequency_hz)
    for column in _telling(seen) if len(likely) > 1 else ():
        kind, mode = divmod(column, MODES)
        gains = [_gain(likely, by_name, column, float(std)) for std in noise[:, kind, mode]]
        best = int(np.argmax(gains))
        found.append(_named(seen, column, around.states[best] if len(gains) > 1 else "", gains[best]))
    told = [m for m in found if m.gain_nats > _TELLING]
    return tuple(sorted(told, key=lambda m: -m.gain_nats)[:_SHOWN])


def _telling(seen: SeenCauses) -> list[int]:
    """Return the informative quantities, as indices among the model's."""
    labels = seen.model.labels
    modes = [i for i, label in enumerate(labels) if seen.model.tells(label) and not label.startswith(LOCAL)]
    return [i + shift for shift in (0, MODES) for i in modes]


def _named(seen: SeenCauses, column: int, state: str, gain: float) -> Measurement:
    """Return a measurement of a quantity, in words."""
    kind, mode = divmod(column, MODES)
    label, quantity = seen.model.labels[mode], ("frequency", "damping")[kind]
    shown = any(other % MODES == mode for other in seen.columns)
    sensor = "" if shown else seen.model.seen_best[mode]
    again = "once more " if column in seen.columns else ""
    where = f", {state}" if state else ""
    by = f", by {sensor}" if sensor else ""
    what = f"the {quantity} of {label} {again}in a month's records{where}{by}"
    return Measurement(what, gain, label, quantity, state, sensor)


def _gain(likely: Sequence[Cause], verdicts: dict[str, CauseVerdict], column: int, noise: float) -> float:
    """Return the expected information of one quantity of given accuracy on likely causes [nats]."""
    share = np.array([verdicts[c.name].probability for c in likely])
    mean, std = np.array([_predicted(c, verdicts[c.name], column, noise) for c in likely]).T
    # the remaining probability of other causes is not affected
    return float(share.sum() * expected_information(share / share.sum(), mean, std))


def _looks(verdicts: Sequence[CauseVerdict]) -> list[Measurement]:
    """Return the information of an inspection, the entropy of its outcome."""
    share = np.array([v.probability for v in verdicts])
    places: dict[str, list[float]] = {}
    for i, verdict in enumerate(verdicts):
        place = next((text for start, text in LOOKS if re.search(start, verdict.cause)), None)
        if place is not None:
            text = place.format(verdict.cause.split(" ")[0])
            places.setdefault(text, [0.0] * len(verdicts))[i] = 1.0
    doubt = np.full(len(verdicts), _LOOK_STD)
    return [
        Measurement(text, expected_information(share / share.sum(), np.array(shows), doubt))
        for text, shows in places.items()
    ]


def _predicted(cause: Cause, verdict: CauseVerdict, column: int, noise: float) -> tuple[float, float]:
    """Return mean and standard deviation of what a cause does to one quantity, at the size it would have."""
    per = cause.draws[:, column]
    low, high = verdict.interval_90
    size_std = (high - low) / 3.29
    spread = np.hypot(np.std(per) * verdict.size, np.mean(per) * size_std)
    kind = slice(0, MODES) if column < MODES else slice(MODES, 2 * MODES)
    misfit = cause.misfit * np.sqrt(np.mean(cause.draws[:, kind] ** 2)) * abs(verdict.size)
    if cause.mixing is not None:
        misfit = np.hypot(misfit, np.linalg.norm(cause.mixing[:, column]) * verdict.size)
    mean = cause.steps(np.array([verdict.size]))[0, column]
    return float(mean), float(np.sqrt(spread**2 + noise**2 + misfit**2))
