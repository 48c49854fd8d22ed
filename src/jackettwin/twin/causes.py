"""The causes of a change as directions, from a structure that stands on ground of uncertain stiffness.

The feet's stiffness is fitted to the frequencies of the baseline; what the fit leaves open, and what the
model misses, makes the draws of every direction.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.response.labels import LOCAL, mode_kinds, mode_labels
from jackettwin.response.modal import UndampedModes, undamped_modes
from jackettwin.response.mode_tracking import track_modes
from jackettwin.response.system import build_system
from jackettwin.soil.support import Spring, Support
from jackettwin.structure import Assembly, Structure, assemble
from jackettwin.twin.changed_structures import Happening, Standing, happenings
from jackettwin.watching import (
    Cause,
    CauseVerdict,
    Diagnosis,
    Pattern,
    expected_information,
    lognormal_sizes,
    sensor_noise,
)
from jackettwin.watching.causes import MISFIT

MODES = 8
"""Modes of the model that are computed."""
_DRAWS = 6
_TYPICAL_STIFFNESS = 2.5e9
"""Of a foot [N/m], before anything is known: give or take a factor e."""
_FEET_APART = 0.15
"""Standard deviation of ln stiffness from foot to foot: no site is the same at all of them, and in a nearly
round structure that turns the axes of a pair."""
_MODEL_ERROR = 0.01
"""Relative standard deviation by which a model misses frequencies, before its own are compared: worth as much
as one mode."""
_MISSES = 5.0
"""A model that misses frequencies by a share misses the directions of causes by so many times as much:
docs/verification/directions.md."""
_LOSS = (0.08, 0.4)
"""Loss factor of the ground: median and spread in ln."""
_ALIKE = 0.995
"""Cosine between directions of one family from which they are one cause."""
_RECORDS, _RECORD_S, _SHOWN = 144, 600.0, 5
"""Ten-minute records of a further measurement, and how many are named."""
_USUAL_ZETA, _TELLING, _LOOK_STD = 0.01, 0.01, 0.3
"""Damping ratio of a further mode; nats below which nothing is worth measuring; and by how much of what there
is to be seen a look may err: one in twenty does not tell."""
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
_ONE_SIZE = 0.1
"""Spread of ln size below which a cause is there or not."""
_SHOWS = 3e-4
"""A change of all ln f below this, at its usual size, is not worth a bet: it takes years to be found."""
_KEPT = 0.7
"""A mode's shape has to stay by this share, in kinetic energy, among those of the whole structure."""
_TRACE = 1e-5
"""A change of all logarithms below this leaves no trace."""


@dataclass(frozen=True)
class ModelCauses:
    """Causes and what each does to all modes of a model.

    Attributes
    ----------
    labels : of the model's modes
    frequency_hz : (n_modes,) of the fitted model
    causes : their draws are over ln f of all modes, then ln ζ of all modes
    traceless : names of what leaves no trace in frequencies and damping
    mixed : labels of modes that a cause may turn into members' own: which is which afterwards, nobody knows
    """

    labels: tuple[str, ...]
    frequency_hz: FloatArray
    causes: tuple[Cause, ...]
    traceless: tuple[str, ...]
    mixed: tuple[str, ...] = ()

    def tells(self, label: str) -> bool:
        """Return whether a mode of this label tells of causes."""
        return label in self.labels and label not in self.mixed

    def patterns(self, labels: Sequence[str]) -> tuple[Pattern, ...]:
        """Return what the causes do to frequencies, of those that would show, over modes by label."""
        found = []
        for cause in self.causes:
            once = cause.draws.mean(axis=0)
            change = np.array([once[self.labels.index(n)] if self.tells(n) else 0.0 for n in labels])
            if np.abs(change).max() * np.median(np.abs(cause.sizes)) > _SHOWS:
                found.append(Pattern(cause.name, change, cause.prior))
        return tuple(found)


def model_causes(
    structure: Structure,
    labels: Sequence[str],
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    *,
    gravity: bool = True,
    seed: int = 0,
) -> ModelCauses:
    """Return what may have happened to a structure whose modes are known by label.

    Parameters
    ----------
    labels, frequency_hz, damping_ratio : (n,) of the baseline; NaN where ζ is not known

    Raises
    ------
    InputError
        If no label is that of a mode of the model.
    """
    typical = Standing(structure, *(np.full(len(structure.reaction_nodes), _TYPICAL_STIFFNESS) for _ in "hv"))
    assembly = assemble(structure, gravity=gravity)
    named = Modes.of(typical, assembly)
    places = [named.labels.index(label) if label in named.labels else -1 for label in labels]
    if max(places, default=-1) < 0:
        raise InputError(
            "no mode of the model has such a label", field="label", value=", ".join(labels),
            allowed=", ".join(named.labels), remedy="label modes as `jackettwin modes` does",
        )  # fmt: skip
    rng = np.random.default_rng((77, seed))
    stands, best, error = standings(typical, named, places, frequency_hz, assembly, rng)
    fitted = Modes.of(best, assembly, like=named).modes.frequency_hz
    zeta = np.full(MODES, 0.01)
    for place, value in zip(places, damping_ratio, strict=True):
        if place >= 0 and np.isfinite(value):
            zeta[place] = value
    loss = _LOSS[0] * np.exp(_LOSS[1] * rng.standard_normal(_DRAWS))
    bases = [Modes.of(standing, assembly, like=named) for standing in stands]
    found: list[tuple[str, Cause]] = []
    traceless = ["sensor: gain", "sensor: sign", "sensor: position"]
    kept = np.ones(MODES)
    for event in happenings(typical):
        after = assemble(event.apply(typical).structure, gravity=gravity)  # whatever the feet
        changed = [Modes.of(event.apply(s), after, like=b) for s, b in zip(stands, bases, strict=True)]
        draws = np.array([
            effect(event, base, then, eta, zeta)
            for base, then, eta in zip(bases, changed, loss, strict=True)
        ])  # fmt: skip
        kept = np.minimum(kept, np.min([one.kept for one in changed], axis=0))
        if np.abs(draws * event.median).max() < _TRACE:
            traceless.append(event.name)
        else:
            sizes, weights = lognormal_sizes(event.median, event.spread, both_ways=event.both_ways)
            bend = _bend(event, stands[0], gravity, bases[0], loss[0], zeta, draws[0])
            cause = Cause(
                event.name, draws, sizes, weights, event.unit, bend=bend, misfit=min(_MISSES * error, MISFIT)
            )  # fmt: skip
            found.append((event.family, cause))
    causes = (*_families(found), _clock(), *_yaw(fitted, named.labels, zeta))
    mixed = tuple(n for n, share in zip(named.labels, kept, strict=True) if share < _KEPT)
    return ModelCauses(named.labels, fitted, causes, tuple(traceless), mixed)


@dataclass(frozen=True)
class Modes:
    """Modes of a standing structure, in the order of another's.

    ``soil_share`` is the share of the strain energy in the ground, ``kept`` that of the kinetic energy in the
    other's modes of the whole structure; modes with members of their own begin with ``local``.
    """

    labels: tuple[str, ...]
    modes: UndampedModes
    mass: Any
    soil_share: FloatArray
    kept: FloatArray

    @classmethod
    def of(cls, standing: Standing, assembly: Assembly, like: Modes | None = None) -> Modes:
        """Return the modes of an assembled structure on its feet, named by kind, or in another's order."""
        feet = zip(standing.structure.reaction_nodes, standing.horizontal, standing.vertical, strict=True)
        springs = tuple(Spring(node, np.diag([h, h, v, 0.0, 0.0, 0.0])) for node, h, v in feet)
        system = build_system(assembly, Support(springs))
        if like is None:
            modes, kept = undamped_modes(system, MODES), np.ones(MODES)
            labels = mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))
        else:
            modes, labels = _followed(like, undamped_modes(system, MODES + 6)), like.labels
            kept = _kept(like, modes.shapes)
        moved = (assembly.expand @ modes.shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
        energy = np.zeros(len(modes.omega))
        for spring in springs:
            u = moved[assembly.mesh.node_names.index(spring.node)]
            energy += np.einsum("im,ij,jm->m", u, spring.matrix, u)
        return cls(labels, modes, assembly.mass, energy / modes.omega**2, kept)


def _followed(like: Modes, modes: UndampedModes) -> UndampedModes:
    """Return modes in the order of another's, by shape."""
    order = track_modes(like.mass, like.modes.omega, like.modes.shapes, modes.shapes)
    order = np.where(order < 0, np.arange(MODES), order)
    return UndampedModes(modes.omega[order], modes.shapes[:, order])


def _kept(like: Modes, shapes: FloatArray) -> FloatArray:
    """Return the share of each shape's kinetic energy in another's modes of the whole structure, (n,)."""
    whole = like.modes.shapes[:, [not name.startswith(LOCAL) for name in like.labels]]
    moving = like.mass @ shapes
    return np.asarray(np.sum((whole.T @ moving) ** 2, axis=0) / np.einsum("im,im->m", shapes, moving))


def effect(event: Happening, base: Modes, after: Modes, eta: float, zeta: FloatArray) -> FloatArray:
    """Return the change of ln f and ln ζ by one unit of an event, (2·MODES,).

    The ground's part of ζ is ½η times its share of the strain energy.
    """
    ln_f = np.log(after.modes.omega / base.modes.omega)
    more = 0.5 * eta * (after.soil_share - base.soil_share) + event.damps * np.maximum(-ln_f, 0.0)
    return np.concatenate([ln_f, more / zeta]) / event.per


def repeated(event: Happening, times: int) -> Happening:
    """Return an event that happens so many times over, as one; its effect is per event still."""

    def apply(standing: Standing) -> Standing:
        for _ in range(times):
            standing = event.apply(standing)
        return standing

    return replace(event, apply=apply, per=times * event.per)


def _bend(
    event: Happening,
    standing: Standing,
    gravity: bool,
    base: Modes,
    eta: float,
    zeta: FloatArray,
    once: FloatArray,
) -> FloatArray:
    """Return how an event's direction turns with each further median size, (2·MODES,), if it has sizes."""
    if event.spread < _ONE_SIZE:
        return np.zeros(0)
    thrice = repeated(event, 3)
    stands = thrice.apply(standing)
    after = Modes.of(stands, assemble(stands.structure, gravity=gravity), like=base)
    often = effect(thrice, base, after, eta, zeta)
    return np.asarray(0.5 * (often - once) * event.median / event.per)


def standings(
    typical: Standing,
    named: Modes,
    places: Sequence[int],
    frequency_hz: FloatArray,
    assembly: Assembly,
    rng: np.random.Generator,
) -> tuple[list[Standing], Standing, float]:
    """Return draws of the feet's stiffness that agree with the measured frequencies, and the likeliest.

    The third is by how much the model misses frequencies: what the fit leaves over tells, with one mode's
    worth of what is usual.

    Parameters
    ----------
    places, frequency_hz : of measured modes among the named ones, −1 for none of them
    """
    known = [(place, f) for place, f in zip(places, frequency_hz, strict=True) if place >= 0]

    def at(x: FloatArray) -> Standing:
        return replace(
            typical, horizontal=typical.horizontal * np.exp(x[0]), vertical=typical.vertical * np.exp(x[1])
        )

    def residual(x: FloatArray) -> FloatArray:
        omega = Modes.of(at(x), assembly, like=named).modes.omega
        off = [np.log(omega[place] / (2.0 * pi * f)) / _MODEL_ERROR for place, f in known]
        return np.array([*off, *x])

    fit = least_squares(residual, np.zeros(2), diff_step=[1e-3, 1e-3], max_nfev=12, bounds=(-3.0, 3.0))
    slope, left = np.asarray(fit.jac), fit.fun[: len(known)]
    error = np.sqrt((left @ left + 1.0) / (max(len(known) - 2, 0) + 1))  # in units of the usual
    slope[: len(known)] /= error
    covariance = np.linalg.inv(slope.T @ slope)
    points = rng.multivariate_normal(fit.x, covariance, _DRAWS).clip(-3.5, 3.5)
    drawn = [at(x) for x in points]
    apart = np.exp(_FEET_APART * rng.standard_normal((_DRAWS, 2, typical.horizontal.size)))
    drawn = [
        replace(s, horizontal=s.horizontal * h, vertical=s.vertical * v)
        for s, (h, v) in zip(drawn, apart, strict=True)
    ]
    return drawn, at(fit.x), float(error) * _MODEL_ERROR


def _families(found: list[tuple[str, Cause]]) -> tuple[Cause, ...]:
    """Return the causes, those of one family and direction as one; a family has one prior weight."""
    out: list[Cause] = []
    for family in dict.fromkeys(name for name, _ in found):
        members = [cause for name, cause in found if name == family]
        groups: list[list[Cause]] = []
        for cause in members:
            near = next((g for g in groups if _cosine(g[0], cause) > _ALIKE), None)
            if near is None:
                groups.append([cause])
            else:
                near.append(cause)
        for group in groups:
            first, more = group[0], len(group) - 1
            name = first.name if not more else f"{first.name} (or {more} alike)"
            out.append(replace(first, name=name, prior=len(group) / len(members)))
    return tuple(out)


def _cosine(one: Cause, other: Cause) -> float:
    a, b = (c.draws.mean(axis=0) for c in (one, other))
    scale = np.concatenate([np.ones(MODES), np.full(MODES, 0.02)])  # ζ is known fifty times less well
    a, b = a * scale, b * scale
    nearness = float(a @ b / np.sqrt((a @ a) * (b @ b)))
    length = float(np.sqrt((a @ a) / (b @ b)))
    return nearness if max(length, 1.0 / length) < 1.0 + MISFIT else 0.0


def _clock() -> Cause:
    """Return a clock that runs wrong: all frequencies alike, no damping."""
    sizes, weights = lognormal_sizes(1e-3, 1.2, both_ways=True)
    direction = np.concatenate([np.ones(MODES), np.zeros(MODES)])[None]
    return Cause("sensor: clock", direction, sizes, weights, "-", prior=0.5)


def _yaw(frequency_hz: FloatArray, labels: Sequence[str], zeta: FloatArray) -> tuple[Cause, ...]:
    """Return a yaw angle that is read wrong: it mixes the frequencies and damping of each bending pair."""
    direction = np.zeros(2 * MODES)
    for number in (1, 2):
        try:
            i, j = labels.index(f"fore_aft_{number}"), labels.index(f"side_side_{number}")
        except ValueError:
            continue
        direction[i] = np.log(frequency_hz[j] / frequency_hz[i])
        direction[j] = -direction[i]
        direction[MODES + i] = (zeta[j] - zeta[i]) / zeta[i]
        direction[MODES + j] = (zeta[i] - zeta[j]) / zeta[j]
    if not direction.any():
        return ()
    sizes, weights = lognormal_sizes(0.05, 1.0)  # sin² of the angle: 13°
    return (Cause("sensor: yaw misread", direction[None], sizes, weights, "sin² of the angle", prior=0.5),)


@dataclass(frozen=True)
class SeenCauses:
    """Causes over the quantities that are watched.

    Attributes
    ----------
    causes : over the known quantities; the last is a failing sensor
    known : (m,) which watched quantities belong to modes of the model
    further : what else could be measured: name, and index into the model's quantities
    model : all that the causes do
    """

    causes: tuple[Cause, ...]
    known: BoolArray
    further: tuple[tuple[str, int], ...]
    model: ModelCauses


def seen_causes(
    model: ModelCauses, quantities: Sequence[tuple[str, int]], labels: Sequence[str]
) -> SeenCauses:
    """Return the causes over watched quantities.

    Parameters
    ----------
    quantities : (m,) kind and mode of each watched quantity
    labels : of the modes
    """
    known = np.array([model.tells(labels[mode]) for _, mode in quantities], dtype=np.bool_)
    columns = [
        model.labels.index(labels[mode]) + (0 if kind == "frequency" else MODES)
        for (kind, mode), good in zip(quantities, known, strict=True)
        if good
    ]
    kept = [pair for pair, good in zip(quantities, known, strict=True) if good]
    causes = tuple(
        replace(c, draws=c.draws[:, columns], bend=c.bend[columns] if c.bend.size else c.bend)
        for c in model.causes
    )
    further = tuple(
        (f"{what} of {label}", i + shift)
        for what, shift in (("frequency", 0), ("damping", MODES))
        for i, label in enumerate(model.labels)
        if i + shift not in columns and model.tells(label) and not label.startswith(LOCAL)
    )
    return SeenCauses((*causes, sensor_noise(kept)), known, further, model)


class Measurement(NamedTuple):
    """What could be measured or looked at, and the information [nats] to expect on which cause it is."""

    what: str
    gain_nats: float


def next_measurements(seen: SeenCauses, diagnosis: Diagnosis) -> tuple[Measurement, ...]:
    """Return what could be measured or looked at to tell likely causes apart, the most telling first.

    A further quantity is known as 144 ten-minute records before and after tell it at the precision no method
    can beat (Au 2014). A look at a place tells whether the causes that show there are it.
    """
    by_name = {v.cause: v for v in diagnosis.verdicts}
    likely = [c for c in seen.model.causes if by_name[c.name].probability > 0.01]
    found = _looks([v for v in diagnosis.verdicts if v.probability > 0.01])
    share = np.array([by_name[c.name].probability for c in likely])
    limits = np.sqrt(2.0) * long_data_limits(seen.model.frequency_hz, _USUAL_ZETA, _RECORDS * _RECORD_S)
    for what, column in seen.further if len(likely) > 1 else ():
        noise = limits[0 if column < MODES else 1][column % MODES]
        each = [_predicted(c, by_name[c.name], column, float(noise)) for c in likely]
        mean, std = np.array(each).T
        # what is left for other causes is not told by a further mode
        gain = share.sum() * expected_information(share / share.sum(), mean, std)
        found.append(Measurement(f"the {what}, of a day of records", float(gain)))
    told = [m for m in found if m.gain_nats > _TELLING]
    return tuple(sorted(told, key=lambda m: -m.gain_nats)[:_SHOWN])


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
    kind = slice(0, MODES) if column < MODES else slice(MODES, None)
    misfit = cause.misfit * np.sqrt(np.mean(cause.draws[:, kind] ** 2)) * abs(verdict.size)
    mean = cause.steps(np.array([verdict.size]))[0, column]
    return float(mean), float(np.sqrt(spread**2 + noise**2 + misfit**2))
