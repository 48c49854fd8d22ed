"""Causes of a change as directions, from a structure on ground of uncertain stiffness.

The feet's stiffness is drawn from the posterior of the twin's supports if a run provides one;
otherwise it is fitted to the frequencies of the baseline. The remaining uncertainty and the model error give
the draws of every direction.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import ndtri

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.change.changed_structures import Happening, Standing, happenings
from jackettwin.change.event_effects import bend, effect, happened, mixing, pairs_of, repeated
from jackettwin.change.fitted_feet import on_its_feet
from jackettwin.change.ground import UNDESCRIBED, Ground, Loss
from jackettwin.change.standing_modes import MODES, NEAR, Modes, on_feet
from jackettwin.change.working_rotor import WorkingRotor
from jackettwin.loads import Coefficients, Water, mass_per_level
from jackettwin.response import tide_slopes, undamped_modes
from jackettwin.structure import Assembly, Structure, assemble
from jackettwin.twin import WaterConfig, in_water
from jackettwin.watching import (
    Cause,
    Pattern,
    Slope,
    sensor_noise,
    sizes_about,
)
from jackettwin.watching.causes import MISFIT

_DRAWS = 6
_TYPICAL_STIFFNESS = 2.5e9
"""Prior stiffness of a foot [N/m], within about a factor of e."""
_MISSES = 2.0
"""Errors of a model's directions over its error of frequencies, of each mode by itself:
docs/verification/directions.md."""
_LOSS = (0.08, 0.4)
"""Loss factor of the ground: median and spread in ln."""
_ALIKE = 0.995
"""Cosine between directions of one family above which they are one cause."""
_ONE_SIZE = 0.1
"""Spread of ln size below which a cause is either present or absent."""
_SHOWS = 3e-4
"""Change of all ln f, at the usual size, below which a cause is not bet on: it would take years to detect."""
_KEPT = 0.7
"""Smallest share of a mode's kinetic energy among the modes of the whole structure."""
_SEA_LEVEL = re.compile(r"^(sea|water)_?level(_m)?$|^tide(_m)?$", re.IGNORECASE)
"""Names of a sea level in metres."""
_LEAST_PER_M, _UNKNOWN_PER_M = 1e-4, 0.01
"""Standard deviation of d ln f per metre of sea level from other effects than added mass,
and for a mode that the model lacks."""
_MISREAD = 0.05
"""Median size of a yaw error, sin² of the angle: 13°."""
_OF_KIND = {"frequency": 0, "damping": MODES, "angle": 2 * MODES}
"""First index of each kind among the quantities of a model."""
_TRACE = 1e-5
"""Change of all logarithms below which a cause has no effect."""


@dataclass(frozen=True)
class ModelCauses:
    """Causes and their effects on all modes of a model.

    Attributes
    ----------
    labels : of the model's modes
    frequency_hz : (n_modes,) of the fitted model
    causes : their draws are over ln f of all modes, then ln ζ of all modes, then the directions [rad] in
        which the lower modes of bending pairs move
    traceless : names of what leaves no trace in frequencies and damping
    level_per_m : (n_modes,) d ln f per metre of sea level
    seen_best : of each mode, the accelerometer that would see most of it
    mixed : labels of modes that a cause may turn into members' own: which is which afterwards, nobody knows
    """

    labels: tuple[str, ...]
    frequency_hz: FloatArray
    causes: tuple[Cause, ...]
    traceless: tuple[str, ...]
    mixed: tuple[str, ...] = ()
    level_per_m: FloatArray = field(default_factory=lambda: np.zeros(MODES))
    seen_best: tuple[str, ...] = ("",) * MODES

    def slopes(self, labels: Sequence[str], conditions: Sequence[str]) -> tuple[Slope, ...]:
        """Return the model's prior effects of conditions by name: that of sea level, from added mass.

        The mass of water that a structure carries is known within a factor of two: coefficients, growth,
        flooding.
        """
        at = [self.labels.index(n) if n in self.labels else -1 for n in labels]
        per_m = np.array([self.level_per_m[i] if i >= 0 else 0.0 for i in at])
        unsure = np.where(np.array(at) >= 0, np.abs(per_m) + _LEAST_PER_M, _UNKNOWN_PER_M)
        return tuple(Slope(name, per_m, unsure) for name in conditions if _SEA_LEVEL.search(name))

    def tells(self, label: str) -> bool:
        """Tell whether a mode of this label informs on causes."""
        return label in self.labels and label not in self.mixed

    def patterns(self, labels: Sequence[str]) -> tuple[Pattern, ...]:
        """Return the visible effects of causes on frequencies, over modes by label."""
        found = []
        for cause in self.causes:
            once = cause.draws.mean(axis=0)
            change = np.array([once[self.labels.index(n)] if self.tells(n) else 0.0 for n in labels])
            if np.abs(change).max() * cause.usual > _SHOWS:
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
    ground: Ground = UNDESCRIBED,
    rotor: WorkingRotor | None = None,
    water: WaterConfig | None = None,
) -> ModelCauses:
    """Return the possible causes for a structure whose modes are known by label.

    Parameters
    ----------
    labels, frequency_hz, damping_ratio : (n,) of the baseline; NaN where ζ is not known
    ground : what is known of it
    rotor : at work, if the modes are those of operation
    water : whose mass moves with the structure, if the structure's own has none of it

    Raises
    ------
    InputError
        If no label is that of a mode of the model.
    """

    def standing(structure: Structure) -> Assembly:
        assembly = in_water(water, assemble(structure, gravity=gravity))
        return assembly if rotor is None else rotor.on(assembly)

    stiff = np.full(len(structure.reaction_nodes), _TYPICAL_STIFFNESS)
    typical = Standing(structure, stiff, stiff, ground.scour_loss)
    assembly = standing(structure)
    rng = np.random.default_rng((77, seed))
    named, places, stands, best, error = on_its_feet(
        typical, assembly, labels, frequency_hz, ground.stiffness, _DRAWS, rng
    )
    stands = _with_other_losses(stands, ground.loss_std, np.random.default_rng((78, seed)))
    fit = Modes.of(best, assembly, like=named).modes
    fitted = fit.frequency_hz
    per_level = mass_per_level(assembly, Coefficients(), Water())
    level = tide_slopes(fitted, fit.shapes, assembly.mass, per_level).relative
    zeta = np.full(MODES, 0.01)
    for place, value in zip(places, damping_ratio, strict=True):
        if place >= 0 and np.isfinite(value):
            zeta[place] = value
    loss = _LOSS[0] * np.exp(_LOSS[1] * rng.standard_normal(_DRAWS))
    near = undamped_modes(on_feet(best, assembly), NEAR).shapes
    bases = Modes.of_each(stands, assembly, [named] * _DRAWS, near)

    def modes_after(event: Happening, stands: Sequence[Standing], bases: Sequence[Modes]) -> list[Modes]:
        stood = happened(event, stands)
        same = stood[0].structure is structure
        return Modes.of_each(stood, assembly if same else standing(stood[0].structure), bases, near)

    def effects(event: Happening, changed: Sequence[Modes]) -> FloatArray:
        of = zip(bases, changed, loss, strict=True)
        return np.array([effect(event, base, then, eta, zeta) for base, then, eta in of])

    found: list[tuple[str, Cause]] = []
    traceless = ["sensor: gain", "sensor: sign", "sensor: position"]
    kept = np.ones(MODES)
    for event in happenings(typical):
        changed = modes_after(event, stands, bases)
        draws = effects(event, changed)
        kept = np.minimum(kept, np.min([one.kept for one in changed], axis=0))
        if np.abs(draws[:, : 2 * MODES] * event.median).max() < _TRACE:
            traceless.append(event.name)
        else:
            sizes, weights = sizes_about(
                event.median, event.spread, both_ways=event.both_ways, larger=True, largest=event.largest
            )  # fmt: skip
            per_unit = {event.per: draws[0]}
            for often in [repeated(event, x) for x in event.solved] if event.spread > _ONE_SIZE else ():
                then = modes_after(often, stands[:1], bases[:1])[0]
                per_unit[often.per] = effect(often, bases[0], then, loss[0], zeta)
            bent = bend(per_unit)
            if event.or_else is not None:
                other = replace(event, apply=event.or_else)
                share = _evenly(len(stands), np.random.default_rng((79, seed)))[:, None]
                draws = draws + share * (effects(other, modes_after(other, stands, bases)) - draws)
            cause = Cause(
                event.name, draws, sizes, weights, event.unit, bent_at=bent[0], bend=bent[1],
                misfit=min(_MISSES * error, MISFIT), mixing=mixing(event, bases[0], changed[0], error),
            )  # fmt: skip
            found.append((event.family, cause))
    works = () if rotor is None else (rotor.cause(assembly, fit, zeta, _DRAWS, rng),)
    causes = (*_families(found), *works, _clock(), *_yaw(fitted, named.labels, zeta))
    mixed = tuple(n for n, share in zip(named.labels, kept, strict=True) if share < _KEPT)
    best_seen = _seen_best(assembly, fit.shapes)
    return ModelCauses(named.labels, fitted, causes, tuple(traceless), mixed, level, best_seen)


def _with_other_losses(stands: Sequence[Standing], std: float, rng: np.random.Generator) -> list[Standing]:
    """Return draws of the feet with draws of what scour takes of them, independent by component."""
    z = ndtri(np.stack([_evenly(len(stands), rng) for _ in Loss._fields], axis=1))
    return [
        replace(one, scour_loss=Loss(*(np.exp(std * of) * np.array(one.scour_loss))))
        for one, of in zip(stands, z, strict=True)
    ]


def _evenly(n: int, rng: np.random.Generator) -> FloatArray:
    """Return equally likely quantiles of a uniform share in random order, (n,), with its mean for any n."""
    return np.asarray(rng.permutation((np.arange(n) + 0.5) / n))


def _seen_best(assembly: Assembly, shapes: FloatArray) -> tuple[str, ...]:
    """Return the place and horizontal axis above the sea of each mode's largest relative motion."""
    stands = assembly.structure
    named = [name for name in assembly.mesh.node_names if name in stands.nodes]
    names = [name for name in named if stands.nodes[name][2] >= stands.sea_level_z_m] or named
    places = [assembly.mesh.node_names.index(name) for name in names]
    moved = np.abs((assembly.expand @ shapes).reshape(len(assembly.mesh.node_names), 6, -1)[places, :2])
    own = moved**3 / np.maximum(np.sum(moved**2, axis=2, keepdims=True), 1e-300)
    out = []
    for shape in own.transpose(2, 0, 1):
        node, axis = np.unravel_index(np.argmax(shape), shape.shape)
        out.append(f"an accelerometer at {names[node]} along {'xy'[axis]}")
    return tuple(out)


def _families(found: list[tuple[str, Cause]]) -> tuple[Cause, ...]:
    """Return the causes, merged within one family and direction; each family has one prior weight."""
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
            others = tuple(cause.name for cause in group[1:])
            out.append(replace(first, name=name, prior=len(group) / len(members), alike=others))
    return tuple(out)


def _cosine(one: Cause, other: Cause) -> float:
    a, b = (c.draws.mean(axis=0) for c in (one, other))
    scale = np.repeat([1.0, 0.02, 0.0], MODES)  # ζ is known fifty times less well
    a, b = a * scale, b * scale
    nearness = float(a @ b / np.sqrt((a @ a) * (b @ b)))
    length = float(np.sqrt((a @ a) / (b @ b)))
    return nearness if max(length, 1.0 / length) < 1.0 + MISFIT else 0.0


def _clock() -> Cause:
    """Return the cause of a wrong clock: all frequencies change alike, exactly so, damping does not."""
    sizes, weights = sizes_about(1e-3, 1.2, both_ways=True, larger=True, finer=5)
    direction = np.repeat([1.0, 0.0, 0.0], MODES)[None]
    return Cause("sensor: clock", direction, sizes, weights, "-", prior=0.5, misfit=0.0)


def _yaw(frequency_hz: FloatArray, labels: Sequence[str], zeta: FloatArray) -> tuple[Cause, ...]:
    """Return the cause of a wrong yaw, which mixes and rotates bending pairs.

    The sense of rotation is unknown, hence two draws.
    """
    direction = np.zeros(3 * MODES)
    for i, j in pairs_of(labels)[:2]:
        direction[i] = np.log(frequency_hz[j] / frequency_hz[i])
        direction[j] = -direction[i]
        direction[MODES + i] = (zeta[j] - zeta[i]) / zeta[i]
        direction[MODES + j] = (zeta[i] - zeta[j]) / zeta[j]
        direction[[2 * MODES + i, 2 * MODES + j]] = np.arcsin(np.sqrt(_MISREAD)) / _MISREAD
    if not direction.any():
        return ()
    sizes, weights = sizes_about(_MISREAD, 1.0)
    draws = direction * np.repeat([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]], MODES, axis=1)
    return (Cause("sensor: yaw misread", draws, sizes, weights, "sin² of the angle", prior=0.5),)


@dataclass(frozen=True)
class SeenCauses:
    """Causes over the monitored quantities.

    Attributes
    ----------
    causes : over the known quantities; the last is a failing sensor
    known : (m,) which watched quantities belong to modes of the model
    columns : of the known ones, their index among the model's quantities
    model : all that the causes do
    """

    causes: tuple[Cause, ...]
    known: BoolArray
    columns: tuple[int, ...]
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
        model.labels.index(labels[mode]) + _OF_KIND[kind]
        for (kind, mode), good in zip(quantities, known, strict=True)
        if good
    ]
    kept = [pair for pair, good in zip(quantities, known, strict=True) if good]
    causes = tuple(
        replace(
            c,
            draws=c.draws[:, columns],
            bend=c.bend[:, columns] if c.bend.size else c.bend,
            mixing=None if c.mixing is None else c.mixing[:, columns],
        )
        for c in model.causes
    )
    return SeenCauses((*causes, sensor_noise(kept)), known, tuple(columns), model)
