"""What to measure or look at next, so that the causes of a change are told apart.

Every frequency and damping ratio of the model's modes, watched already or not, in every operating state that
the table knows, and a look at every place where a cause shows: ranked by the information to be expected.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.causes import MODES, SeenCauses
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
"""Ten-minute records of a further measurement, spread over a month, and how many measurements are named."""
_INDEPENDENT = 7.5
"""Independent values that a month holds of what is unexplained, if it lasts two days."""
_USUAL_ZETA, _TELLING, _LIKELY, _LOOK_STD = 0.01, 0.01, 0.01, 0.3
"""Damping ratio of a mode that is not watched; nats below which nothing is worth measuring; probability from
which a cause counts; and by how much of what there is to be seen a look may err: one in twenty does not
tell."""
_UNEXPLAINED = {"frequency": 1e-3, "damping": 0.05}
"""Where no quantity of the kind is watched."""
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
"""Where causes show to who looks, by their names; what is in the ground does not."""


@dataclass(frozen=True)
class Measurement:
    """What could be measured or looked at, and the information [nats] to expect on which cause it is.

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
    """What a further measurement would be made in.

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
        """Return the circumstances of a baseline; a mode that is not watched is damped as the others are."""
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
        """Return how well a month's records tell a change of ln f and ln ζ, (n_states, 2, n_modes).

        No method beats the limits of long data (Au 2014); what is unexplained comes on top.
        """
        limits = np.array([long_data_limits(frequency_hz, z, _RECORDS * _RECORD_S) for z in self.damping])
        slow = self.unexplained[None, :, None] ** 2 / _INDEPENDENT
        return np.asarray(np.sqrt(2.0 * (limits**2 + slow)))


def next_measurements(
    seen: SeenCauses, diagnosis: Diagnosis, around: Circumstances
) -> tuple[Measurement, ...]:
    """Return what could be measured or looked at to tell likely causes apart, the most telling first.

    A quantity is known as a month's records before and after tell it; each stands there once, in the state
    that tells most. A look at a place tells whether the causes that show there are it.
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
    """Return the quantities that tell of causes, as indices among the model's."""
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
    """Return what one quantity, known so well, would tell of likely causes [nats]."""
    share = np.array([verdicts[c.name].probability for c in likely])
    mean, std = np.array([_predicted(c, verdicts[c.name], column, noise) for c in likely]).T
    # what is left for other causes is not told by it
    return float(share.sum() * expected_information(share / share.sum(), mean, std))


def _looks(verdicts: Sequence[CauseVerdict]) -> list[Measurement]:
    """Return what looking somewhere tells: the entropy of whether the causes that show there are it."""
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
    mean = cause.steps(np.array([verdict.size]))[0, column]
    return float(mean), float(np.sqrt(spread**2 + noise**2 + misfit**2))
