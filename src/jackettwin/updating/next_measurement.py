"""Which further measurement would tell most."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.identifiability import information
from jackettwin.updating.nuisance_parameters import DASHPOTS
from jackettwin.updating.problem import Problem

_RECORD_S = 600.0
"""Length of the record a further measurement comes from."""
_POINTS = 24
_TORSION, _FOURTH = 3, 4
_STILL = 0.1
"""A calm state keeps this share of the rotor's damping."""


@dataclass(frozen=True)
class Measurement:
    """A further measurement and what to expect of it.

    Attributes
    ----------
    gain_nats : float
        Information gained on all parameters together, ½ ln of the determinants' ratio: the posterior's mean.
    ratio : (d,) posterior over prior standard deviation of each ln θ with it: its mean square, rooted
    """

    what: str
    gain_nats: float
    ratio: FloatArray


def next_measurements(problem: Problem, z: FloatArray) -> tuple[Measurement, ...]:
    """Return further measurements, the most telling first.

    Each is a ten-minute record's worth at the precision no method can beat, CoV f = √(ζ/2πfT),
    CoV ζ = 1/√(2πζfT) (Au 2014).

    Parameters
    ----------
    z : (n, d) draws of ln θ from the posterior
    """
    points = z[:: max(1, len(z) // _POINTS)][:_POINTS]
    near = problem.anchor(points.mean(axis=0))
    bases = [information(problem, point, near) for point in points]
    kept = [(point, base) for point, base in zip(points, bases, strict=True) if base is not None]
    if not kept:
        return ()
    found = [
        _judged(problem, what, [(base, extra(point, base)) for point, base in kept])
        for what, extra in _candidates(problem).items()
    ]
    return tuple(sorted(found, key=lambda m: -m.gain_nats))


Extra = Callable[[FloatArray, FloatArray], FloatArray]


def _candidates(problem: Problem) -> dict[str, Extra]:
    targets = {t.mode: t for state in problem.states for t in state.residuals.targets}
    candidates: dict[str, Extra] = {"four times as many records": lambda _, base: 3.0 * base}
    for mode, name in ((_TORSION, "torsion"), (_FOURTH, "the second bending mode")):
        known = targets.get(mode)
        if mode > problem.model.highest_mode:
            continue
        if known is None or known.frequency_hz is None:
            candidates[f"frequency of {name} (mode {mode})"] = _single(problem, mode, damping=False)
        if known is None or known.damping_ratio is None:
            candidates[f"damping of {name} (mode {mode})"] = _single(problem, mode, damping=True)
    rotor = [i for i, p in enumerate(problem.parameters) if p.name.split("@")[0] in DASHPOTS]
    if rotor and len(problem.states) == 1:
        candidates["the same modes in a calm"] = _calm(problem, rotor)
    return candidates


def _single(problem: Problem, mode: int, *, damping: bool) -> Extra:
    """Return the information in one mode's frequency or damping ratio."""
    state = problem.states[0]

    def extra(point: FloatArray, base: FloatArray) -> FloatArray:
        modes = problem.model.predict_many(problem.vectors(point[None], state), (mode,))
        pole, slope = modes.poles[0, 0], modes.slopes[0, 0]
        if np.isnan(pole):
            return np.zeros_like(base)
        size, zeta = abs(pole), max(-pole.real / abs(pole), 1e-6)
        d_ln_f = (np.conj(pole) * slope).real / size**2
        cycles = size / (2.0 * pi) * _RECORD_S
        if damping:
            gradient, variance = -slope.real / (size * zeta) - d_ln_f, 1.0 / (2.0 * pi * zeta * cycles)
        else:
            gradient, variance = d_ln_f, zeta / (2.0 * pi * cycles)
        full = gradient @ state.weights
        return np.asarray(np.outer(full, full) / variance)

    return extra


def _calm(problem: Problem, rotor: list[int]) -> Extra:
    """Return the information in the same measurements with little rotor damping, in a known proportion."""

    def extra(point: FloatArray, base: FloatArray) -> FloatArray:
        calm = point.copy()
        calm[rotor] += np.log(_STILL)
        found = information(problem, calm)
        return np.zeros_like(base) if found is None else found

    return extra


def _judged(problem: Problem, what: str, pairs: list[tuple[FloatArray, FloatArray]]) -> Measurement:
    prior = problem.prior.std
    precision = np.diag(prior**-2.0)
    gains, ratios = [], []
    for base, extra in pairs:
        before, after = base + precision, base + extra + precision
        gains.append(0.5 * (np.linalg.slogdet(after)[1] - np.linalg.slogdet(before)[1]))
        ratios.append(np.sqrt(np.diag(np.linalg.inv(after))) / prior)
    return Measurement(what, float(np.mean(gains)), np.sqrt(np.mean(np.square(ratios), axis=0)))
