"""Damage and life of the welds of an asset by all its records: accumulated, now, and what is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from math import exp, isfinite, log, sqrt
from typing import Any

import numpy as np

from jackettwin.constants import YEAR_DAYS, YEAR_S
from jackettwin.fatigue import POSITIONS, SIDES, TUBE_POSITIONS, HotSpot, RemainingLife, TubeWeld
from jackettwin.findings import Finding
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.structure import Structure
from jackettwin.study.life.life_so_far import LifeSoFar, damage_of_year
from jackettwin.study.life.shares import BLOCK_DAYS, LAST
from jackettwin.twin import DAMAGE_UNIT, SensedTime, StressModel, WeldSums, planned_joints


@dataclass(frozen=True)
class AssetWeld:
    """One side of a weld of an asset.

    Attributes
    ----------
    number : of the side
    weld : HotSpot, or TubeWeld for a weld around a tube
    side, position : chord, brace or tube; the point with most damage of all records together
    sums : WeldSums
    environment : what corrodes it
    rate, rate_std : damage of a year by the design curve; of its logarithm, what the records leave open
    remaining : what is left of its life, by the mean of the tests
    variances : {source: variance of ln D}
    by_state : {state of operation: share of the damage of the point}
    """

    number: int
    weld: HotSpot | TubeWeld
    side: str
    position: str
    sums: WeldSums
    environment: str
    rate: float
    rate_std: float
    remaining: RemainingLife
    variances: Mapping[str, float]
    by_state: Mapping[str, float]


@dataclass(frozen=True)
class AssetLife:
    """Life of the welds of an asset, the shortest first; none before a record told of damage.

    Welds of a shape beyond the range of their factors come after all others: what is said of them is a
    guess, and the first weld is the one that a headline names.
    """

    model: StressModel
    so_far: LifeSoFar
    time: SensedTime
    welds: tuple[AssetWeld, ...]

    def findings(self) -> list[tuple[str, Finding]]:
        """Return what asks for a person, each with the day since when it does."""
        found, years = [], self.model.settings.years
        for one in self.welds:
            weld = one.weld
            place = weld.name if isinstance(weld, TubeWeld) else f"{weld.brace} at {weld.node}"
            subject = f"{place}, {one.side}"
            if one.number in self.so_far.departed:
                day, ratio = self.so_far.departed[one.number]
                days = BLOCK_DAYS * LAST
                found.append((day, Finding("life_share", subject, {"ratio": ratio, "days": days})))
            if one.number in self.so_far.over_budget and not one.weld.warnings:
                day, ratio, low = self.so_far.over_budget[one.number]
                said = {"ratio": ratio, "low": low, "years": years}
                found.append((day, Finding("life_budget", subject, said)))
        return found

    def rows(self) -> list[dict[str, Any]]:
        """Return the welds as plain JSON data."""
        return [self._row(one) for one in self.welds]

    def _row(self, one: AssetWeld) -> dict[str, Any]:
        structure, sums, weld, settings = (
            self.model.assembly.structure, one.sums, one.weld, self.model.settings,
        )  # fmt: skip
        total, years = sum(one.variances.values()), self.time.seconds / YEAR_S
        median, spread = one.remaining.rate * years, exp(NORMAL_90 * sqrt(total))
        low, mid, high = (one.remaining.quantile(p) for p in QUANTILES)
        left_out = (self.time.n - sums.n) / self.time.n * self.time.beyond
        return _place(structure, weld) | {
            "side": one.side,
            "position": one.position,
            "environment": one.environment,
            "beyond_validity": list(weld.doubts),
            "observed_s": self.time.seconds,
            "records": self.time.n,
            "damage": DAMAGE_UNIT * sums.worst,
            "damage_at_most": DAMAGE_UNIT * (sums.worst + left_out),
            "damage_by_point": [DAMAGE_UNIT * p for p in sums.points],
            "damage_interval_90": [median / spread, median * spread],
            "rate_per_year": one.rate,
            "rate_interval_90": [one.rate * exp(s * NORMAL_90 * one.rate_std) for s in (-1.0, 1.0)],
            "recent_rate_per_year": self.so_far.recent_rate(one.number, sums),
            "budget_per_year": settings.budget,
            "life_years": 1.0 / (one.rate * settings.design_factor),
            "remaining_years": {"p05": _finite(low), "p50": _finite(mid), "p95": _finite(high)},
            "age_years": one.remaining.age_years,
            "failure_probability_per_year": one.remaining.failure_in(1.0),
            "reliability_index": one.remaining.reliability_index,
            "variance_shares": {name: v / total for name, v in one.variances.items()},
            "damage_by_state": dict(one.by_state),
            "departed": _since(self.so_far.departed.get(one.number)),
            "over_budget": _since(self.so_far.over_budget.get(one.number)),
        }


def asset_life(model: StressModel, so_far: LifeSoFar) -> AssetLife:
    """Return the life of the welds that records named among their worst."""
    time, sums = so_far.total
    joints = planned_joints(model.assembly) if sums else ()
    welds: list[HotSpot | TubeWeld] = [w for joint in joints for w in joint.welds for _ in SIDES]
    welds += model.tubes if sums else ()
    age = _age_years(model, so_far, time)
    found = [
        _weld(model, so_far, side, welds[side], sums[side], time, age) for side in sums if sums[side].worst
    ]
    order = sorted(found, key=lambda one: (bool(one.weld.doubts), -one.rate, one.number))
    return AssetLife(model, so_far, time, tuple(order))


def _weld(
    model: StressModel,
    so_far: LifeSoFar,
    side: int,
    weld: HotSpot | TubeWeld,
    sums: WeldSums,
    time: SensedTime,
    age: float,
) -> AssetWeld:
    structure = model.assembly.structure
    if isinstance(weld, TubeWeld):
        curves, z, place, positions = weld.models, weld.z_m, "tube", TUBE_POSITIONS
    else:
        curves, z = model.settings.models, structure.nodes[weld.node][2]
        place, positions = SIDES[side % len(SIDES)], POSITIONS
    environment, own = curves(z - structure.sea_level_z_m)
    m, point = float(np.mean(own.curve.m)), int(np.argmax(sums.points))
    open_ = so_far.variances(side, time, sums)
    variances = {
        "S-N scatter": (log(10.0) * own.curve.log_std) ** 2,
        "stress concentration": (m * own.scf_cov) ** 2,
        "Miner's sum": own.miner_cov**2,
        **open_,
    }
    rate = damage_of_year(sums, time)
    median = rate * 10.0 ** (-2.0 * own.curve.log_std)
    by_state = {op: s[side].points[point] / sums.worst for op, s in so_far.welds.items() if side in s}
    return AssetWeld(
        side, weld, place, positions[point], sums, environment, rate,
        sqrt(sum(open_.values())), RemainingLife(median, sqrt(sum(variances.values())), age), variances,
        by_state,
    )  # fmt: skip


def _age_years(model: StressModel, so_far: LifeSoFar, time: SensedTime) -> float:
    """Return for how long damage has been done: since the start of service, else since the first record."""
    began = model.settings.in_service
    if not so_far.through:
        return time.seconds / YEAR_S
    last = date.fromisoformat(so_far.through).toordinal() + 1
    first = date.fromisoformat(so_far.first).toordinal() if began is None else began.toordinal()
    return max(last - first, 1) / YEAR_DAYS


def _place(structure: Structure, weld: HotSpot | TubeWeld) -> dict[str, Any]:
    """Return where a weld is, and its factors; the joint of a weld around a tube is its name."""
    members = {member.name: member for member in structure.members}
    if isinstance(weld, TubeWeld):
        member = members[weld.member]
        start, end = (np.array(structure.nodes[node]) for node in (member.start, member.end))
        at, ends = start + weld.position * (end - start), (weld.name, weld.member, weld.member)
        scf, other = {weld.kind: {"nominal": {"around": weld.scf}}}, start if weld.position > 0.5 else end
    else:
        brace = members[weld.brace]
        at = np.array(structure.nodes[weld.node])
        other = np.array(structure.nodes[brace.end if brace.start == weld.node else brace.start])
        ends, scf = (weld.node, weld.chord, weld.brace), weld.scf
    return dict(zip(("joint", "chord", "brace"), ends, strict=True)) | {
        "z_m": float(at[2]),
        "above_sea_m": float(at[2]) - structure.sea_level_z_m,
        "node_m": at.tolist(),
        "brace_end_m": other.tolist(),
        "scf": scf,
    }


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _since(found: tuple[Any, ...] | None) -> dict[str, Any] | None:
    return None if found is None else {"since": found[0], "ratio": found[1]}
