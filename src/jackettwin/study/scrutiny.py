"""What stands behind a fit: what it does not explain, what it hangs on, and what would settle that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, exp, isfinite, log
from typing import Any

import numpy as np

from jackettwin.study.measurements import MeasuredMode
from jackettwin.updating import (
    USABLE,
    DatumCheck,
    Direction,
    Influence,
    Objection,
    PairDirection,
    Target,
    Tolerance,
    Update,
    influences,
    objection,
)


@dataclass(frozen=True)
class Condition:
    """A parameter that would be known if one tolerance were settled.

    Attributes
    ----------
    parameter : str
    tolerance : Tolerance
    factor : float
        Upper over lower end of the 90 % interval that it would have.
    effect : float
        Change of ln θ with one standard deviation more than stated.
    """

    parameter: str
    tolerance: Tolerance
    factor: float
    effect: float


@dataclass(frozen=True)
class Scrutiny:
    """What stands behind the fit of one law.

    Attributes
    ----------
    objection : Objection or None
        What the fit does not explain; None without standard deviations.
    influences : tuple of Influence
        Of every open tolerance on the parameters, in the order of the problem's.
    conditions : tuple of Condition
        The nearest way to each parameter that is not known and would be.
    """

    objection: Objection | None
    influences: tuple[Influence, ...] = ()
    conditions: tuple[Condition, ...] = ()

    @property
    def objects(self) -> bool:
        """Whether chance does not explain what was measured."""
        return self.objection is not None and self.objection.objects

    def movers(self, parameter: int) -> tuple[Influence, ...]:
        """Return the tolerances by how far they move a parameter, the most first."""
        return tuple(sorted(self.influences, key=lambda one: -abs(float(one.effect[parameter]))))


def scrutiny(
    u: Update,
    measured: Sequence[MeasuredMode],
    suspects: Sequence[Direction],
    pairs: Sequence[PairDirection] = (),
) -> Scrutiny:
    """Return what stands behind a fit.

    Parameters
    ----------
    suspects : what else may be wrong with the structure, to explain what the tolerances do not
    pairs : measured directions of bending pairs
    """
    beside = [
        Target(m.mode, m.frequency_hz, m.frequency_std_hz)
        for m in measured
        if not m.fits_frequency and m.frequency_hz and m.frequency_std_hz
    ]
    z = np.log(u.best.theta)
    known = u.uncertainty
    found = () if known is None else influences(u.problem, np.median(known.log_theta, axis=0))
    return Scrutiny(objection(u.problem, z, beside, suspects, pairs), found, _conditions(u, found))


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
    """Return what stands behind a fit as plain JSON data."""
    return {
        "objection": None if s.objection is None else _objection_document(s.objection),
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


def _objection_document(o: Objection) -> dict[str, Any]:
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
        "not_seen_by_these_data": [tolerance.name for tolerance in o.unseen],
        "seen_from": {
            tolerance.name: size if isfinite(size) else None
            for tolerance, size in zip(o.unseen, o.seen_from, strict=True)
        },
    }


def _miss(check: DatumCheck) -> dict[str, float]:
    """Return by how much a datum is missed, directions in degrees."""
    if check.is_direction:
        return {"measured_less_predicted_deg": degrees(check.miss), "std_deg": degrees(check.std)}
    return {"measured_over_predicted_less_one": check.miss, "std": check.std}


def _tolerance_document(t: Tolerance) -> dict[str, Any]:
    return {"name": t.name, "words": t.words, "std": t.std, "unit": t.unit}


def _named(names: Sequence[str], values: Sequence[float]) -> dict[str, float]:
    return dict(zip(names, values, strict=True))
