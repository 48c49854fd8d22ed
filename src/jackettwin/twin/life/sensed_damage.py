"""Damage of one record at the welds that it damages most, small enough to store for every record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import AnyFloatArray, FloatArray, IntArray
from jackettwin.fatigue import POSITIONS, SIDES, LifeModel, count
from jackettwin.sensing import MotionEstimate, SensorReadings, Weather, likely_motions, stress_remainder
from jackettwin.twin.life.likely_structures import LikelyStructures, StressModel
from jackettwin.twin.life.weld_map import WeldMap, weld_map

DAMAGE_UNIT = 1e-11
"""Of damage: a weld that has this of a record lasts a million years."""
KEPT = 16
"""Sides of welds that are kept of a record."""
_COUNTED = 24
"""Sides of welds whose cycles are counted: those whose stress varies most, for its curve."""
_AGAIN = KEPT + 2
"""Sides that are counted in other motions, too: those with most damage in the likeliest."""
KEPT_TUBES, _COUNTED_TUBES = 4, 6
"""The same of welds around tubes."""
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
    sides : (n,) 2 · weld + side (0 chord, 1 brace), welds in the order of the structure's joints, and behind
        them all the welds around tubes
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
    likely: LikelyStructures, readings: SensorReadings, weather: Weather
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
    systems = likely.systems(STRUCTURES)
    estimates = likely_motions(systems, readings, weather, damped=likely.damped, near=likely.near)
    told = likely.model
    rest = told.rest.under(weather, told.assembly)
    chart = weld_map(systems[0], estimates[0].model, rest, told.joints, tubes=told.tubes)
    curves = _Curves.of(told, working=weather.working)
    mean = estimates[0].mean()
    sides, guessed, largest_left = curves.worst(chart, mean, estimates[0].covariance)
    first = curves.damage(chart, mean, sides)
    again, left = curves.most(first, sides, (_AGAIN, KEPT_TUBES))
    not_again = first[left]
    sides, first, guessed = sides[again], first[again], guessed[again]
    # what sensors do not see adds to the damage of every structure as it does to that of the first
    unseen = np.array(_drawn(curves, chart, estimates[0], mean, sides, first)) / np.maximum(first, 1e-300)
    others, of = [], set(curves.joint[sides[sides < curves.n_sides] // len(SIDES)].tolist())
    for system, one in zip(systems[1:], estimates[1:], strict=True):
        chart = weld_map(system, one.model, rest, told.joints, of=of, tubes=told.tubes)
        others.append(curves.damage(chart, one.mean(), sides, like=first))
    mirrored = [first**2 / np.maximum(one, _LEAST * first + 1e-300) for one in others]
    damage = np.array([first, *others, *mirrored])[:, None] * unseen
    worst = damage.mean(axis=(0, 1)).max(axis=1)
    bound = largest_left * float((worst / guessed).max(initial=0.0))
    grown = float((worst / np.maximum(first.max(axis=1), 1e-300)).max(initial=0.0))
    bound = max(bound, grown * float(not_again.max(initial=0.0)))
    return _kept(curves, sides, damage, bound)


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


def _kept(curves: _Curves, sides: IntArray, damage: FloatArray, bound: float) -> SensedDamage:
    """Return what is kept of damages (n_structures, n_draws, n_sides, 8) of the sides that were counted."""
    mean = damage.mean(axis=(0, 1))
    kept, rest = curves.most(mean, sides, (KEPT, KEPT_TUBES))
    kept = kept[mean[kept].max(axis=1) >= DAMAGE_UNIT]
    at = mean[kept].argmax(axis=1)
    logs = np.log(np.maximum(damage[:, :, kept, at], DAMAGE_UNIT))
    unseen = logs.std(axis=1, ddof=1).mean(axis=0) if logs.shape[1] > 1 else np.zeros(kept.size)
    model = logs.mean(axis=1).std(axis=0, ddof=1) / _OF_PAIRS if len(logs) > 1 else np.zeros(kept.size)
    model = np.hypot(model, curves.remainder[sides[kept]])
    left = max(bound, float(mean[rest].max(initial=0.0)))
    by_chance, shared = (np.rint(std / STEP).astype(np.intp) for std in (unseen, model))
    return SensedDamage(sides[kept], steps_of(mean[kept]), by_chance, shared, int(steps_of(np.array(left))))


@dataclass(frozen=True)
class _Curves:
    """The curve and thickness of every side of every weld and, behind them, of every weld around a tube.

    ``joint`` (n_welds,) is the joint that a weld is of, and ``remainder`` (n,) the standard deviation of ln
    damage that simplified waves and modes leave.
    """

    models: tuple[LifeModel, ...]
    thickness_m: FloatArray
    joint: IntArray
    remainder: FloatArray

    @classmethod
    def of(cls, told: StressModel, *, working: bool) -> _Curves:
        """Return those of a structure's welds; more is left open of them while its rotor works."""
        structure = told.assembly.structure
        welds = [weld for joint in told.joints for weld in joint.welds]
        sides = [(structure.nodes[w.node][2], t, told.curves) for w in welds for t in w.thickness_m]
        sides += [(tube.z_m, tube.section.thickness_m, tube.models) for tube in told.tubes]
        above = [z - structure.sea_level_z_m for z, _, _ in sides]
        at = [curves(z)[1] for z, (_, _, curves) in zip(above, sides, strict=True)]
        left = [
            stress_remainder(z, working=working) * float(np.mean(m.curve.m))
            for z, m in zip(above, at, strict=True)
        ]
        joint = np.repeat(np.arange(len(told.joints)), [len(j.welds) for j in told.joints])
        return cls(tuple(at), np.array([t for _, t, _ in sides]), joint, np.array(left))

    @property
    def n_sides(self) -> int:
        """Number of the sides of welds of joints."""
        return len(SIDES) * self.joint.size

    def most(self, damage: FloatArray, sides: IntArray, number: tuple[int, int]) -> tuple[IntArray, IntArray]:
        """Return which sides have most damage (n, …), so many of joints and of tubes, and the rest."""
        order = np.argsort(-damage.reshape(len(damage), -1).max(axis=1), kind="stable")
        of_tubes = sides[order] >= self.n_sides
        first = np.concatenate([order[~of_tubes][: number[0]], order[of_tubes][: number[1]]])
        return first, np.setdiff1d(order, first)

    def worst(
        self, chart: WeldMap, motion: FloatArray, unseen: FloatArray
    ) -> tuple[IntArray, FloatArray, float]:
        """Return the sides that vary most for their curves, what one cycle does to them, and to the next.

        Parameters
        ----------
        unseen : (n_coordinates, n_coordinates) covariance of what the motion (n, n_coordinates) misses
        """
        seen = np.cov(motion.T) + unseen
        size = np.concatenate(
            [
                *(_spread(chart, j, seen).ravel() for j in range(len(chart.joints))),
                [float(np.sqrt(np.einsum("pi,ij,pj->p", rows, seen, rows).max())) for rows in chart.tubes],
            ]
        )
        per_cycle = np.array(
            [
                model.curve.damage(_TYPICAL * size[s : s + 1], np.ones(1), thickness_m=float(t))
                for s, (model, t) in enumerate(zip(self.models, self.thickness_m, strict=True))
            ]
        )
        chosen, rest = self.most(per_cycle, np.arange(size.size), (_COUNTED, _COUNTED_TUBES))
        return chosen, np.maximum(per_cycle[chosen], 1e-300), float(per_cycle[rest].max(initial=0.0))

    def damage(
        self, chart: WeldMap, motion: FloatArray, sides: IntArray, *, like: FloatArray | None = None
    ) -> FloatArray:
        """Return the damage (n_sides, 8) of a motion at the points of some sides.

        Parameters
        ----------
        like : damage of another motion; points that had little of it follow the side's worst, uncounted
        """
        found, welds = np.zeros((sides.size, len(POSITIONS))), sides // len(SIDES)
        first = np.concatenate([[0], np.cumsum(np.bincount(self.joint))])
        # seven digits: a damage is kept to a hundredth
        single: AnyFloatArray = motion.astype(np.float32)
        known = np.ones_like(found)
        if like is not None:
            known = like / np.maximum(like.max(axis=1, keepdims=True), 1e-300)
        of_joints = sides < self.n_sides
        for joint in np.unique(self.joint[welds[of_joints]]):
            here = np.flatnonzero(of_joints & (self.joint[np.minimum(welds, self.joint.size - 1)] == joint))
            braces = sorted({int(w - first[joint]) for w in welds[here]})
            parts = dict(zip(braces, chart.parts(int(joint), single, braces), strict=True))
            for i in here:
                brace, major = int(welds[i] - first[joint]), np.flatnonzero(known[i] >= _MINOR)
                side = int(sides[i]) % len(SIDES)
                stress = chart.joints[int(joint)].weld_stress(brace, parts[brace], side, major)
                found[i] = self._counted(int(sides[i]), stress, major, known[i])
        for i in np.flatnonzero(~of_joints):
            major = np.flatnonzero(known[i] >= _MINOR)
            rows = chart.tubes[int(sides[i]) - self.n_sides][major].astype(np.float32)
            found[i] = self._counted(int(sides[i]), rows @ single.T, major, known[i])
        return found

    def _counted(self, side: int, stress: AnyFloatArray, major: IntArray, known: FloatArray) -> FloatArray:
        """Return the damage (8,) at the points of a side, of which some are counted (n, n_samples)."""
        if not major.size:
            return np.zeros(len(POSITIONS))
        cycles, t = [count(series) for series in stress], float(self.thickness_m[side])
        ranges = np.concatenate([c.ranges for c in cycles])
        each = 1.0 / self.models[side].curve.cycles_to_failure(ranges, thickness_m=t)
        of = np.repeat(major, [c.ranges.size for c in cycles])
        numbers = np.concatenate([c.numbers for c in cycles])
        found = np.asarray(np.bincount(of, each * numbers, len(POSITIONS)), dtype=np.float64)
        minor = known < _MINOR
        found[minor] = known[minor] * found[int(known.argmax())]
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
