r"""Structures that a record's own frequencies make likely: stiffness of feet, and tolerances of drawings.

Unknowns are the logarithms of the feet's stiffness sideways and upright and the tolerances φ of the twin, in
their standard deviations. Frequencies of the record's modes tell of them to first order,

.. math:: \frac{∂ \ln ω}{∂θ} = \frac{x^T (∂K - ω^2 ∂M)\,x}{2 ω^2}, \qquad x^T M x = 1,

about the point that Gauss and Newton find, so that they are normal there (Tarantola 2005, eq. (3.51)). A
first frequency hardly tells soft feet from mass on top; the shapes of the first pair do, as far as they lie
out of the plane of the model's pair, with

.. math:: \frac{∂x_i}{∂θ} = \sum_{n} x_n \frac{x_n^T (∂K - ω_i^2 ∂M)\,x_i}{ω_i^2 - ω_n^2}

over the other modes (Fox & Kapoor 1968). This is no update: supports stay springs, and one record's modes
tell of them what one record can.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.fatigue import JointStresses, ModelsAtHeight, TubeWeld, tube_welds
from jackettwin.identification import ModalEstimate
from jackettwin.loads import Coefficients
from jackettwin.response import System, UndampedModes, build_system, track_modes, undamped_modes
from jackettwin.sensing import MotionModel, RotorByWind
from jackettwin.soil import Prony, Spring, Support, standing
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.twin.life.settings import LifeSettings
from jackettwin.twin.life.weld_map import RestingLoads, planned_joints
from jackettwin.updating import Direction, moved_along, on_unlike_feet, possible

_STEPS = 3
_LONGEST_STEP, _SETTLED = 1.5, 0.02
"""Of ln k and of tolerances in their deviations."""
_MODES = 5
"""Both bending pairs and torsion; higher ones feel blades and braces more than feet."""
_REMAINDER = 0.005
"""Of a frequency: what beams and springs miss of it."""
_PAIR = 2
"""Modes whose shapes tell of the feet: those that sensors on a tower see best."""
_SHAPE_REMAINDER, _OTHERWISE = 0.003, 0.05
"""Of a shape over its largest entry: what beams and gains of sensors miss of it, and what no foot makes."""
_COMMON_STD, _OWN_STD, _UPRIGHT = 1.5, 0.5, 0.7
"""Of ln k of all feet together, of each way alone, and how much stiffer feet are upright."""
_WAYS = (np.diag([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), np.diag([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
_USUAL_RATIO = 0.01
_EXTRA = 8


@dataclass(frozen=True)
class StressModel:
    """Model from which a twin's stresses are estimated.

    Attributes
    ----------
    settings : LifeSettings
    assembly : with what drawings say
    rest : weight of its steel and what the water does to it
    rayleigh : damping of the steel
    numbered : modes on pinned feet
    directions : what tolerances that are open do to the structure
    depth_m : of the water; None takes the lowest node for the bed
    coefficients : of drag, added mass and growth; None are those of bare members
    at_work : what a standard deviation of the stiffness that the rotor at work adds does to the structure
    rotor : how it damps at work and what its thrust does in gusts; None is a usual one
    """

    settings: LifeSettings
    assembly: Assembly
    rest: RestingLoads
    rayleigh: Rayleigh
    numbered: UndampedModes
    directions: tuple[Direction, ...] = ()
    depth_m: float | None = None
    coefficients: Coefficients | None = None
    at_work: Direction | None = None
    rotor: RotorByWind | None = None
    _modes: dict[bytes, UndampedModes] = field(default_factory=dict, init=False, repr=False, compare=False)

    def working(self) -> StressModel:
        """Return the model with the rotor at work, whose stiffness is left open; as it is without a rotor."""
        return self._working

    @cached_property
    def _working(self) -> StressModel:
        one = self.at_work
        if one is None or one.stiffness is None:
            return self
        stiffness = self.assembly.stiffness + one.stiffness / one.tolerance.std
        others = tuple(d for d in self.directions if d.tolerance.name != one.tolerance.name)
        return replace(
            self,
            assembly=replace(self.assembly, stiffness=stiffness),
            directions=(*others, one),
            at_work=None,
        )

    @cached_property
    def n_ways(self) -> int:
        """Number of stiffnesses of the feet; 0 where pins alone do not make the structure stable."""
        fixed = standing(self.assembly.structure).fixed
        return len(_WAYS) if fixed and all(len(dofs) == len("xyz") for _, dofs in fixed) else 0

    @cached_property
    def joints(self) -> tuple[JointStresses, ...]:
        """Joints of tubes with their welds."""
        return planned_joints(self.assembly)

    @cached_property
    def tubes(self) -> tuple[TubeWeld, ...]:
        """Butt welds around tubes."""
        return tube_welds(self.assembly, self.settings.details)[0]

    @cached_property
    def curves(self) -> ModelsAtHeight:
        """Curves of the welds by elevation."""
        return self.settings.models

    def modes_from(self, theta: FloatArray) -> UndampedModes:
        """Return the modes at θ, from which all records that begin there go on: computed once."""
        key = theta.tobytes()
        if key not in self._modes:
            self._modes.clear()
            self._modes[key] = undamped_modes(self.system(theta), self.numbered.omega.size + _EXTRA)
        return self._modes[key]

    def system(self, theta: FloatArray) -> System:
        """Return the structure with ln k of its feet and tolerances (n_ways + n_directions,)."""
        ways, phi = np.split(theta, [self.n_ways])
        structure = self.assembly.structure
        assembly, shares = moved_along(self.assembly, self.directions, phi)
        springs = tuple(
            Spring(node, pattern, Prony(k0=float(np.exp(k))))
            for k, pattern in zip(ways, _WAYS, strict=False)
            for node in structure.reaction_nodes
        )
        support = on_unlike_feet(Support(springs), structure, shares) if springs else standing(structure)
        return build_system(assembly, support, rayleigh=self.rayleigh)

    def slopes(self, system: System, shapes: FloatArray, omega: FloatArray) -> FloatArray:
        """Return ∂ ln ω/∂θ (n_modes, n_ways + n_directions) of mass-normalised shapes (n_dof, n_modes)."""
        found = np.zeros((omega.size, self.n_ways + len(self.directions)))
        on_feet = np.zeros((omega.size, self.n_ways, len(self.assembly.structure.reaction_nodes), 6))
        for spring in system.support.springs:
            f = self.assembly.structure.reaction_nodes.index(spring.node)
            way = int(spring.matrix[2, 2] > 0.0)
            x = shapes[self.assembly.dofs(spring.node)]
            on_feet[:, way, f] = (spring.law.static_stiffness * np.diag(spring.matrix)[:, None] * x**2).T
        found[:, : self.n_ways] = on_feet.sum(axis=(2, 3))
        for j, one in enumerate(self.directions, start=self.n_ways):
            if one.stiffness is not None:
                found[:, j] += np.einsum("im,im->m", shapes, one.stiffness @ shapes)
            if one.mass is not None:
                found[:, j] -= omega**2 * np.einsum("im,im->m", shapes, one.mass @ shapes)
            if one.feet is not None:
                found[:, j] += (on_feet * one.feet).sum(axis=(1, 2, 3))
        return found / (2.0 * omega[:, None] ** 2)

    def shape_slopes(
        self, system: System, modes: UndampedModes, pair: IntArray, seen: FloatArray
    ) -> FloatArray:
        """Return ∂/∂θ (n_ways + n_directions, n_channels, 2) of what sensors see of a pair, out of its plane.

        Feet unlike each other are left out: they turn a pair within its plane more than out of it.

        Parameters
        ----------
        seen : (n_channels, n_modes) of all modes
        """
        x, square = modes.shapes[:, pair], modes.omega**2
        between = np.zeros((self.n_ways + len(self.directions), modes.omega.size, pair.size))
        for spring in system.support.springs:
            at = modes.shapes[self.assembly.dofs(spring.node)]
            way = int(spring.matrix[2, 2] > 0.0)
            between[way] += spring.law.static_stiffness * at.T @ spring.matrix @ at[:, pair]
        for j, one in enumerate(self.directions, start=self.n_ways):
            if one.stiffness is not None:
                between[j] += modes.shapes.T @ (one.stiffness @ x)
            if one.mass is not None:
                between[j] -= modes.shapes.T @ (one.mass @ x) * square[pair]
        others = np.setdiff1d(np.arange(modes.omega.size), pair)
        return np.asarray(seen[:, others] @ (between[:, others] / (square[pair] - square[others, None])))


@dataclass(frozen=True)
class LikelyStructures:
    """Structures that a record's frequencies leave likely: a normal distribution of their unknowns.

    Attributes
    ----------
    model : StressModel
    mean : (n,) ln k of the feet, then tolerances
    covariance : (n, n)
    ratios : {mode: damping ratio} as measured
    near : modes of a structure near the likeliest; None where nothing was computed
    """

    model: StressModel
    mean: FloatArray
    covariance: FloatArray
    ratios: Mapping[int, float]
    near: UndampedModes | None = None

    def systems(self, number: int, *, seed: int = 0) -> tuple[System, ...]:
        """Return the likeliest structure, then others as probable, in pairs about it."""
        rng = np.random.default_rng(seed)
        values, vectors = np.linalg.eigh(self.covariance)
        root, found = vectors * np.sqrt(np.maximum(values, 0.0)), [self.mean]
        while len(found) < number:
            away = root @ rng.standard_normal(values.size)
            found += [self.mean + away, self.mean - away]
        return tuple(
            possible(lambda d: self.model.system(self.mean + d), t - self.mean, near=self.near)
            for t in found[:number]
        )

    def damped(self, motion: MotionModel) -> MotionModel:
        """Return a model of the motion with the record's damping ratios, and a usual one of other modes."""
        # what the water's drag damps besides, braces most of all, is in the model's own
        own = np.diag(motion.damping) / (2.0 * motion.omega)
        numbered, ratios = self.model.numbered, np.maximum(own, _USUAL_RATIO)
        successor = track_modes(self.model.assembly.mass, numbered.omega, numbered.shapes, motion.shapes)
        for mode, ratio in self.ratios.items():
            if mode <= successor.size and successor[mode - 1] >= 0:
                ratios[successor[mode - 1]] = ratio
        return motion.with_ratios(ratios)


def likely_structures(
    model: StressModel,
    modes: Mapping[int, ModalEstimate],
    stiffness_n_m: float,
    *,
    sensors: sp.csr_array | None = None,
) -> LikelyStructures:
    """Return the structures that modes of a record leave likely.

    Parameters
    ----------
    modes : {number on pinned feet: as measured}
    stiffness_n_m : of each foot, to start from
    sensors : (n_channels, n_dof) what the channels of the modes' shapes see of a displacement; without it
        frequencies tell alone
    """
    measured = {m: modes[m] for m in sorted(modes) if m <= min(_MODES, model.numbered.omega.size)}
    k = np.log(stiffness_n_m) + _UPRIGHT * (np.arange(model.n_ways) - 0.5 * (model.n_ways - 1))
    prior = np.concatenate([k, np.zeros(len(model.directions))])
    P0 = np.eye(prior.size)
    P0[: model.n_ways, : model.n_ways] *= _OWN_STD**2
    P0[: model.n_ways, : model.n_ways] += _COMMON_STD**2
    theta, P = prior, P0
    if not measured:
        return LikelyStructures(model, theta, P, {})
    near = model.modes_from(prior)
    for _ in range(_STEPS):
        H, r, R, near = _misfit(model, theta, measured, near, sensors)
        gain = P0 @ H.T @ np.linalg.inv(H @ P0 @ H.T + np.diag(R))
        step = prior + gain @ (r + H @ (theta - prior)) - theta
        theta = theta + step * min(1.0, _LONGEST_STEP / max(np.abs(step).max(), 1e-300))
        P = P0 - gain @ H @ P0
        if np.abs(step).max() < _SETTLED:
            break
    return LikelyStructures(model, theta, P, {m: mode.damping_ratio for m, mode in measured.items()}, near)


def _misfit(
    model: StressModel,
    theta: FloatArray,
    measured: Mapping[int, ModalEstimate],
    near: UndampedModes,
    sensors: sp.csr_array | None,
) -> tuple[FloatArray, FloatArray, FloatArray, UndampedModes]:
    """Return slopes (m, n), what data exceed the model's by (m,), their variances (m,), and modes.

    Data are the logarithms of frequencies, then shapes over their largest entry.

    Parameters
    ----------
    near : modes of the step before
    """
    system, numbered = model.system(theta), model.numbered
    modes = undamped_modes(system, near.omega.size, near=near)
    successor = track_modes(model.assembly.mass, numbered.omega, numbered.shapes, modes.shapes)
    known = [m for m in measured if successor[m - 1] >= 0]
    at = successor[[m - 1 for m in known]] if known else np.zeros(0, dtype=np.intp)
    H = model.slopes(system, modes.shapes[:, at], modes.omega[at])
    r = np.array([np.log(measured[m].frequency_hz) for m in known]) - np.log(modes.frequency_hz[at])
    own = [measured[m].log_covariance for m in known]
    R = np.array([_REMAINDER**2 + (_REMAINDER**2 if c is None else float(c[0, 0])) for c in own])
    parts = [(H, r, np.array(R))]
    pair = successor[:_PAIR]
    if sensors is not None and pair.size == _PAIR and (pair >= 0).all():
        seen = np.asarray(sensors @ modes.shapes)
        slopes = model.shape_slopes(system, modes, pair, seen)
        shapes = [_shape_misfit(seen[:, pair], slopes, measured[m]) for m in measured if m <= _PAIR]
        parts += [part for part in shapes if part is not None]
    H, r, R = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return H, r, R, modes


def _shape_misfit(
    pair: FloatArray, slopes: FloatArray, mode: ModalEstimate
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return slopes (k, n), what a measured shape exceeds the plane of a model's pair by (k,), its variances.

    None where a channel lies so far out of it that a sensor is wrong and no foot.
    """
    seen = mode.lagging
    top = seen.mode_shape[int(np.abs(seen.mode_shape).argmax())]
    shape = (seen.mode_shape / top).real
    inverse = np.linalg.pinv(pair)
    out = np.eye(shape.size) - pair @ inverse
    r = out @ shape
    if np.abs(r).max() > _OTHERWISE:
        return None
    own = 0.0 if seen.mode_shape_std is None else seen.mode_shape_std / abs(top)
    return out @ (slopes @ (inverse @ shape)).T, r, np.full(r.size, _SHAPE_REMAINDER**2) + np.square(own)
