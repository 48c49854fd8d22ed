"""Damage of one record at the welds that it damages most, small enough to store for every record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.fatigue import POSITIONS, SIDES, JointStresses, LifeModel, ModelsAtHeight, count
from jackettwin.sensing import MotionEstimate, SensorReadings, Weather, likely_motions, stress_remainder
from jackettwin.structure import Structure
from jackettwin.twin.life.likely_structures import LikelyStructures
from jackettwin.twin.life.weld_map import WeldMap, weld_map

DAMAGE_UNIT = 1e-11
"""Of damage: a weld that has this of a record lasts a million years."""
KEPT = 16
"""Sides of welds that are kept of a record."""
_COUNTED = 24
"""Sides of welds whose cycles are counted: those whose stress varies most, for its curve."""
_AGAIN = KEPT + 2
"""Sides that are counted in other motions, too: those with most damage in the likeliest."""
STEP = 0.02
"""Of logarithms that are kept: a damage is known to a hundredth."""
STRUCTURES = 2
"""Structures that count, the likeliest among them."""
_SEEN = 0.1
"""Growth of ln damage by a drawn error up to which a motion is as good as known."""
_OF_PAIRS = 0.8
"""Mean of the standard deviation that one structure and its mirror show, over the true one: √(2/π)."""


@dataclass(frozen=True)
class SensedDamage:
    """Damage of a record by the design curve, as whole steps of logarithms; the worst side first.

    Attributes
    ----------
    sides : (n,) 2 · weld + side (0 chord, 1 brace), welds in the order of the structure's joints
    points : (n, 8) steps of ln(damage/DAMAGE_UNIT) at each point, 0 where there is less than that
    unseen, model : (n,) steps of the standard deviation of ln damage: of what sensors do not see, and of
        the structures that the record leaves likely
    beyond : steps of what all points that are left out have at most
    """

    sides: IntArray
    points: IntArray
    unseen: IntArray
    model: IntArray
    beyond: int = 0


def damage_of(steps: IntArray | int) -> FloatArray:
    """Return the damage that steps tell, in :data:`DAMAGE_UNIT`; zero for none."""
    return np.asarray(np.where(np.greater(steps, 0), np.exp(STEP * np.asarray(steps)), 0.0))


def steps_of(damage: FloatArray) -> IntArray:
    """Return damage in steps."""
    more = np.maximum(damage / DAMAGE_UNIT, 1.0)
    return np.asarray(np.rint(np.log(more) / STEP), dtype=np.intp)


def sensed_damage(
    likely: LikelyStructures,
    readings: SensorReadings,
    weather: Weather,
    *,
    structures: int = STRUCTURES,
) -> SensedDamage | None:
    """Return the damage of a record at the worst of a structure's welds; None without welds of tubes.

    Levels of the forces are found once, on the likeliest structure; others have those that are as probable.
    A structure that lies on the other side of the likeliest has its damage mirrored, as ln D is nearly linear
    in what structures differ by: it need not be smoothed.

    Raises
    ------
    InputError
        If no tube reaches into the water.
    NumericalError
        If the filter does not come to rest.
    """
    systems = likely.systems(structures)
    estimates = likely_motions(systems, readings, weather, damped=likely.damped, near=likely.near)
    told = likely.model
    chart = weld_map(systems[0], estimates[0].model, told.dry, told.joints)
    curves = _Curves.of(told.assembly.structure, told.joints, told.curves)
    mean = estimates[0].mean()
    sides, guessed, largest_left = curves.worst(chart, mean, estimates[0].covariance)
    first = curves.damage(chart, mean, sides)
    order = np.argsort(-first.max(axis=1), kind="stable")
    rest, again = first[order[_AGAIN:]], order[:_AGAIN]
    sides, first, guessed = sides[again], first[again], guessed[again]
    # what sensors do not see adds to the damage of every structure as it does to that of the first
    unseen = np.array(_drawn(curves, chart, estimates[0], mean, sides, first)) / np.maximum(first, 1e-300)
    others, of = [], set(curves.joint[sides // len(SIDES)].tolist())
    for system, one in zip(systems[1:], estimates[1:], strict=True):
        chart = weld_map(system, one.model, told.dry, told.joints, of=of)
        others.append(curves.damage(chart, one.mean(), sides, like=first))
    mirrored = [first**2 / np.maximum(one, _LEAST * first + 1e-300) for one in others]
    damage = np.array([first, *others, *mirrored])[:, None] * unseen
    worst = damage.mean(axis=(0, 1)).max(axis=1)
    bound = largest_left * float((worst / guessed).max(initial=0.0))
    grown = float((worst / np.maximum(first.max(axis=1), 1e-300)).max(initial=0.0))
    bound = max(bound, grown * float(rest.max(initial=0.0)))
    return _kept(sides, damage, bound, curves.remainder[sides // len(SIDES)])


def _drawn(
    curves: _Curves,
    chart: WeldMap,
    estimate: MotionEstimate,
    mean: FloatArray,
    sides: IntArray,
    first: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the damage of two motions as probable as the real one, (n_sides, 8) each.

    Where sensors see most of the motion the second is the first mirrored about the mean. Errors that are as
    large as the motion itself have the same ranges either way, so that they would seem known.
    """
    one = next(estimate.draws(1, mean=mean))
    damage = curves.damage(chart, one, sides, like=first)
    grown = np.median(np.log(np.maximum(damage.max(axis=1), 1e-300) / np.maximum(first.max(axis=1), 1e-300)))
    other = 2.0 * mean - one if abs(grown) < _SEEN else next(estimate.draws(1, seed=1, mean=mean))
    return damage, curves.damage(chart, other, sides, like=first)


def _kept(sides: IntArray, damage: FloatArray, bound: float, remainder: FloatArray) -> SensedDamage:
    """Return what is kept of damages (n_structures, n_draws, n_sides, 8) of the sides that were counted."""
    mean = damage.mean(axis=(0, 1))
    order = np.argsort(-mean.max(axis=1), kind="stable")
    kept, rest = order[:KEPT], order[KEPT:]
    kept = kept[mean[kept].max(axis=1) >= DAMAGE_UNIT]
    at = mean[kept].argmax(axis=1)
    logs = np.log(np.maximum(damage[:, :, kept, at], DAMAGE_UNIT))
    unseen = logs.std(axis=1, ddof=1).mean(axis=0) if logs.shape[1] > 1 else np.zeros(kept.size)
    model = logs.mean(axis=1).std(axis=0, ddof=1) / _OF_PAIRS if len(logs) > 1 else np.zeros(kept.size)
    model = np.hypot(model, remainder[kept])
    left = max(bound, float(mean[rest].max(initial=0.0)))
    by_chance, shared = (np.rint(std / STEP).astype(np.intp) for std in (unseen, model))
    return SensedDamage(sides[kept], steps_of(mean[kept]), by_chance, shared, int(steps_of(np.array(left))))


@dataclass(frozen=True)
class _Curves:
    """The curve and thickness of every side of every weld; the joint it is of.

    ``remainder`` (n_welds,) is the standard deviation of ln damage that simplified waves and modes leave.
    """

    models: tuple[LifeModel, ...]
    thickness_m: FloatArray
    joint: IntArray
    remainder: FloatArray

    @classmethod
    def of(cls, structure: Structure, joints: Sequence[JointStresses], models: ModelsAtHeight) -> _Curves:
        """Return those of a structure's welds."""
        welds = [weld for joint in joints for weld in joint.welds]
        heights = [structure.nodes[w.node][2] - structure.sea_level_z_m for w in welds]
        at = [models(z)[1] for z in heights]
        left = [stress_remainder(z) * float(np.mean(m.curve.m)) for z, m in zip(heights, at, strict=True)]
        joint = np.repeat(np.arange(len(joints)), [len(j.welds) for j in joints])
        return cls(tuple(at), np.array([w.thickness_m for w in welds]), joint, np.array(left))

    def worst(
        self, chart: WeldMap, motion: FloatArray, unseen: FloatArray
    ) -> tuple[IntArray, FloatArray, float]:
        """Return the sides that vary most for their curves, what one cycle does to them, and to the next.

        Parameters
        ----------
        unseen : (n_coordinates, n_coordinates) covariance of what the motion (n, n_coordinates) misses
        """
        seen = np.cov(motion.T) + unseen
        size = np.concatenate([_spread(chart, j, seen) for j in range(len(chart.joints))])
        per_cycle = np.array(
            [
                [
                    model.curve.damage(_TYPICAL * size[w, s : s + 1], np.ones(1), thickness_m=t)
                    for s, t in enumerate(self.thickness_m[w])
                ]
                for w, model in enumerate(self.models)
            ]
        ).ravel()
        order = np.argsort(-per_cycle, kind="stable")
        chosen, rest = order[:_COUNTED], order[_COUNTED:]
        return chosen, np.maximum(per_cycle[chosen], 1e-300), float(per_cycle[rest].max(initial=0.0))

    def damage(
        self, chart: WeldMap, motion: FloatArray, sides: IntArray, *, like: FloatArray | None = None
    ) -> FloatArray:
        """Return the damage (n_sides, 8) of a motion at the points of some sides.

        Parameters
        ----------
        like : damage of another motion; points that had little of it follow the side's worst, uncounted
        """
        welds, found = sides // len(SIDES), np.zeros((sides.size, len(POSITIONS)))
        first = np.concatenate([[0], np.cumsum(np.bincount(self.joint))])
        # seven digits: a damage is kept to a hundredth
        single = motion.astype(np.float32)
        for joint in np.unique(self.joint[welds]):
            here = np.flatnonzero(self.joint[welds] == joint)
            braces = sorted({int(w - first[joint]) for w in welds[here]})
            parts = dict(zip(braces, chart.parts(int(joint), single, braces), strict=True))
            for i in here:
                w, s = divmod(int(sides[i]), len(SIDES))
                curve, t = self.models[w].curve, float(self.thickness_m[w, s])
                known = np.ones(len(POSITIONS)) if like is None else like[i] / max(like[i].max(), 1e-300)
                major = np.flatnonzero(known >= _MINOR)
                if not major.size:
                    continue
                brace = w - int(first[joint])
                stress = chart.joints[int(joint)].weld_stress(brace, parts[brace], s, major)
                cycles = [count(series) for series in stress]
                ranges = np.concatenate([c.ranges for c in cycles])
                each = 1.0 / curve.cycles_to_failure(ranges, thickness_m=t)
                of = np.repeat(major, [c.ranges.size for c in cycles])
                numbers = np.concatenate([c.numbers for c in cycles])
                found[i] = np.bincount(of, each * numbers, minlength=len(POSITIONS))
                minor, worst = known < _MINOR, int(known.argmax())
                found[i, minor] = known[minor] * found[i, worst]
        return found


_LEAST = 0.1
"""Of the likeliest structure's damage, below which another's is not mirrored further."""
_MINOR = 0.1
"""Of the damage at a side's worst point, below which a point is not counted in every motion."""
_TYPICAL = 3.5
"""Ranges over standard deviations that do most damage: to choose welds with alone."""


def _spread(chart: WeldMap, joint: int, covariance: FloatArray) -> FloatArray:
    """Return the largest standard deviation (n_welds, 2) of the points of a joint, as if of a K, Y or X."""
    rows = chart.rows[joint]
    between = rows @ covariance @ rows.transpose(0, 2, 1)
    matrices = np.array([weld.matrices for weld in chart.joints[joint].welds])
    square = np.einsum("wkspi,wij,wkspj->wksp", matrices, between, matrices)
    return np.asarray(np.sqrt(square.max(axis=(1, 3))))
