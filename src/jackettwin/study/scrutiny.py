"""Scrutiny of a fit: unexplained data, tolerances it depends on, and data that would determine more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees, exp, isfinite, log
from typing import Any

import numpy as np

from jackettwin.files import named
from jackettwin.response import observation_matrix
from jackettwin.study.measurements import MeasuredMode, may_be_two, sensors_of
from jackettwin.twin import Observation
from jackettwin.updating import (
    USABLE,
    CheckedShape,
    DatumCheck,
    Direction,
    Influence,
    Objection,
    OrderCheck,
    PairDirection,
    ShapeCheck,
    Target,
    Tolerance,
    Update,
    influences,
    objection,
    order_checks,
    shape_checks,
)


@dataclass(frozen=True)
class Condition:
    """A parameter that would be determined if one tolerance were known exactly.

    Attributes
    ----------
    parameter : str
    tolerance : Tolerance
    factor : float
        Ratio of the upper to the lower end of its 90 % interval in that case.
    effect : float
        Change of ln θ if the tolerance is one standard deviation above its stated value.
    """

    parameter: str
    tolerance: Tolerance
    factor: float
    effect: float


@dataclass(frozen=True)
class Scrutiny:
    """Scrutiny of the fit of one law.

    Attributes
    ----------
    objection : Objection or None
        Data that the fit does not explain; None without standard deviations.
    influences : tuple of Influence
        Of every open tolerance on the parameters, in the problem's order.
    conditions : tuple of Condition
        For each undetermined parameter, the tolerance whose knowledge would determine it best.
    """

    objection: Objection | None
    influences: tuple[Influence, ...] = ()
    conditions: tuple[Condition, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether chance cannot explain the misfit."""
        return self.objection is not None and self.objection.objects

    def movers(self, parameter: int) -> tuple[Influence, ...]:
        """Return the influences of the tolerances on a parameter, the largest first."""
        return tuple(sorted(self.influences, key=lambda one: -abs(float(one.effect[parameter]))))


def scrutiny(
    u: Update,
    measured: Sequence[MeasuredMode],
    suspects: Sequence[Direction],
    pairs: Sequence[PairDirection] = (),
    observations: Sequence[Observation] = (),
) -> Scrutiny:
    """Return the scrutiny of a fit.

    Parameters
    ----------
    suspects : further possible errors of the structure, tried on data that the tolerances do not explain
    pairs : measured directions of bending pairs
    observations : records that show shapes
    """
    beside = [
        Target(m.mode, m.frequency_hz, m.frequency_std_hz)
        for m in measured
        if not m.fits_frequency and m.frequency_hz and m.frequency_std_hz
    ]
    z = np.log(u.best.theta)
    known = u.uncertainty
    found = () if known is None else influences(u.problem, np.median(known.log_theta, axis=0))
    said = objection(u.problem, z, beside, suspects, pairs)
    if said is not None:
        said = replace(said, shapes=_shapes(u, measured, observations), orders=_orders(u, measured))
    return Scrutiny(said, found, _conditions(u, found))


def _shapes(
    u: Update, measured: Sequence[MeasuredMode], observations: Sequence[Observation]
) -> tuple[ShapeCheck, ...]:
    """Return the check of each measured shape whose record knows how sure it is, fitted or not."""
    modes, shapes, own_hz = [], [], []
    every = u.modes.damped
    for m, hz in zip(measured, u.modes.frequency_hz, strict=True):
        seen, e = sensors_of(m, observations), m.estimate
        std = None if e is None else e.mode_shape_std
        if std is None and e is not None and e.unrefined is not None:
            # a refined shape has none of its own: that of the one before is no smaller
            std = e.unrefined.mode_shape_std
        if seen is None or e is None or std is None or not np.isfinite(hz) or may_be_two(m, observations):
            continue
        sensors, rows = seen
        modes.append(CheckedShape(m.mode, e.mode_shape[rows], std[rows]))
        shapes.append(np.asarray(observation_matrix(u.model.assembly, sensors) @ every.shapes))
        own_hz.append(float(hz))
    return shape_checks(modes, shapes, every.frequency_hz, own_hz)


def _orders(u: Update, measured: Sequence[MeasuredMode]) -> tuple[OrderCheck, ...]:
    """Return the check of the order of the measured modes that the posterior predicts."""
    q = None if u.uncertainty is None else u.uncertainty.predictive
    known = [
        m for m in measured
        if q is not None and m.mode in q.modes and m.frequency_hz and m.frequency_std_hz
    ]  # fmt: skip
    if q is None or len(known) < 2:
        return ()
    f, std = np.array([[m.frequency_hz, m.frequency_std_hz] for m in known], dtype=np.float64).T
    draws = np.log(q.frequency_hz[:, [q.modes.index(m.mode) for m in known]])
    whole = draws[np.isfinite(draws).all(axis=1)]
    return order_checks([m.mode for m in known], np.log(f), std / f, whole) if len(whole) else ()


def _conditions(u: Update, found: tuple[Influence, ...]) -> tuple[Condition, ...]:
    known = u.uncertainty
    if known is None or not found:
        return ()
    conditions = []
    for j, verdict in enumerate(known.verdicts):
        nearest = min(found, key=lambda one: float(one.settled[j]))
        factor = exp(log(verdict.interval_factor) * float(nearest.settled[j]))
        if verdict.verdict == "weak" and verdict.decided_by == "data" and factor <= USABLE:
            effect = float(nearest.effect[j])
            conditions.append(Condition(verdict.name, nearest.tolerance, factor, effect))
    return tuple(conditions)


def scrutiny_document(s: Scrutiny, parameters: Sequence[str]) -> dict[str, Any]:
    """Return the scrutiny of a fit as plain JSON data."""
    return {
        "objection": None if s.objection is None else _objection_document(s.objection, parameters),
        "tolerances": [
            {
                **_tolerance_document(one.tolerance),
                "source": one.tolerance.source,
                "settled_by": one.tolerance.settled_by,
                "posterior_mean": one.mean * one.tolerance.std,
                "posterior_std": one.std * one.tolerance.std,
                "log_effect_of_one_std": _named(parameters, one.effect.tolist()),
                "log_std_if_settled_over_now": _named(parameters, one.settled.tolist()),
                "not_told_from": list(one.alike),
            }
            for one in s.influences
        ],
        "conditions": [
            {
                "parameter": one.parameter,
                "known_if_settled": one.tolerance.name,
                "interval_factor": one.factor,
                "log_effect_of_one_std": one.effect,
            }
            for one in s.conditions
        ],
    }


def _objection_document(o: Objection, parameters: Sequence[str]) -> dict[str, Any]:
    return {
        "objects": o.objects,
        "chi2": o.chi2,
        "freedom": o.freedom,
        "probability": o.probability,
        "checks": [
            {
                "datum": check.datum,
                **_miss(check),
                "fitted": check.fitted,
                "objects": check.objects,
            }
            for check in o.checks
        ],
        "explanations": [
            {**_tolerance_document(e.tolerance), "size": e.size, "chi2_less": e.gain} for e in o.explanations
        ],
        "asked_for_by_these_data": [tolerance.name for tolerance in o.suspected],
        "not_seen_by_these_data": [one.tolerance.name for one in o.unseen],
        "seen_from": {
            one.tolerance.name: one.seen_from if isfinite(one.seen_from) else None for one in o.unseen
        },
        "unseen": [
            {
                **_tolerance_document(one.tolerance),
                "seen_from": one.seen_from if isfinite(one.seen_from) else None,
                "log_effect_at_its_size": _named(parameters, one.effect.tolist()),
                "settled_by": one.tolerance.settled_by,
            }
            for one in o.unseen
        ],
        "shapes": [named(one, "mode", "outside", "expected", "std", "objects") for one in o.shapes],
        "orders": [
            named(one, "lower", "upper", "objects")
            | {
                "log_frequency_ratio_measured": one.apart,
                "log_frequency_ratio_predicted": one.predicted,
                "std": one.std,
            }
            for one in o.orders
        ],
    }


def _miss(check: DatumCheck) -> dict[str, float]:
    """Return the residual of a datum; of directions in degrees."""
    if check.is_direction:
        return {"measured_less_predicted_deg": degrees(check.miss), "std_deg": degrees(check.std)}
    return {"measured_over_predicted_less_one": check.miss, "std": check.std}


def _tolerance_document(t: Tolerance) -> dict[str, Any]:
    return {"name": t.name, "words": t.words, "std": t.std, "unit": t.unit}


def _named(names: Sequence[str], values: Sequence[float]) -> dict[str, float]:
    return dict(zip(names, values, strict=True))
