"""Measured relaxations of a twin, from targets or records, as data of the update."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.identification import mac
from jackettwin.identification.subspace.real_poles import JOINED
from jackettwin.response import Sensor
from jackettwin.soil import family, members
from jackettwin.study.measurements import MeasuredRelaxation
from jackettwin.twin import ALL, UNIT, OperationTotal, TwinConfig, TwinState, plus
from jackettwin.twin.config import GivenRelaxation
from jackettwin.twin.state import ClearShape, RateSums
from jackettwin.updating import RelaxationTarget, SupportModel

_LEAST_SHARE = 0.5
"""Least share of the records in which a relaxation must be found to be fitted."""


def measured_relaxations(config: TwinConfig, state: TwinState | None) -> tuple[MeasuredRelaxation, ...]:
    """Return the relaxations of the twin file, or those common to its records, the slowest first."""
    if state is None:
        fused = [_as_measured(given, records=0) for given in config.relaxations]
    else:
        total = state.totals.get(ALL, OperationTotal())
        n = total.conditions.records
        groups = _distinct(total.rates, state.clearest)
        fused = [_fused(group, n) for group in groups if group.sums.n >= _LEAST_SHARE * n]
    ordered = sorted(fused, key=lambda one: one.rate_rad_s)
    return tuple(replace(one, name=f"a{i + 1}") for i, one in enumerate(ordered))


def placed(state: TwinState) -> tuple[Sensor, ...]:
    """Return the sensors of all shapes in a state."""
    return tuple({s.channel: s for shape in state.clearest.values() for s in shape.sensors}.values())


def relaxation_targets(
    config: TwinConfig,
    model: SupportModel,
    measured: tuple[MeasuredRelaxation, ...],
    *,
    sensors: tuple[Sensor, ...],
    relative: bool,
) -> tuple[RelaxationTarget, ...]:
    """Return the relaxations as targets: rates with the model's error, and shapes where known."""
    places: Mapping[str, Sensor] = {sensor.channel: sensor for sensor in (*config.sensors, *sensors)}
    targets = []
    for one in measured:
        std = hypot((one.rate_std_rad_s or 0.0) / one.rate_rad_s, config.update.rate_error)
        target = RelaxationTarget(one.name, one.rate_rad_s, None if relative else std)
        if one.channels and all(channel in places for channel in one.channels):
            with located(file=config.path):
                target = target.seen(model, tuple(places[c] for c in one.channels), one.shape)
        targets.append(target)
    return tuple(targets)


def relaxing(config: TwinConfig, laws: tuple[str, ...]) -> tuple[str, ...]:
    """Return the laws under which a structure has real poles.

    Raises
    ------
    InputError
        If no law gives real poles.
    """
    kept = tuple(law for law in laws if all(family(name).relaxes for name in members([law])))
    if not kept:
        raise InputError(
            "a relaxation was measured, but no structure on this law has real poles",
            file=config.path,
            field="update.laws",
            value=", ".join(laws),
            remedy="another law, or omit the relaxations (targets; identification.real_poles: false)",
        )
    return kept


@dataclass(frozen=True)
class _Group:
    """One relaxation over all records, and its most certain shape."""

    sums: RateSums
    shape: ClearShape | None


def _distinct(rates: Mapping[str, RateSums], clearest: Mapping[str, ClearShape]) -> list[_Group]:
    """Return the distinct relaxations: close rates with similar shapes are one, the most certain first."""
    groups: list[_Group] = []
    for key, sums in sorted(rates.items(), key=lambda item: (-item[1].w, item[0])):
        one = _Group(sums, clearest.get(f"a{key}"))
        apart = [_apart(one, group) for group in groups]
        nearest = int(np.argmin(apart)) if groups else -1
        if groups and apart[nearest] < JOINED:
            groups[nearest] = replace(groups[nearest], sums=plus(groups[nearest].sums, sums))
        else:
            groups.append(one)
    return groups


def _apart(one: _Group, other: _Group) -> float:
    """Return |Δ ln a| + 1 − MAC at common channels, by which identification joins relaxations."""
    unlike = 0.0
    if one.shape is not None and other.shape is not None:
        values = [dict(zip(_names(s), s.shape, strict=True)) for s in (one.shape, other.shape)]
        common = [name for name in values[0] if name in values[1]]
        shapes = [np.array([value[name] for name in common]) for value in values]
        unlike = 1.0 - float(mac(*shapes)) if common else 0.0
    return abs(one.sums.wx / one.sums.w - other.sums.wx / other.sums.w) + unlike


def _names(shape: ClearShape) -> tuple[str, ...]:
    return tuple(sensor.channel for sensor in shape.sensors)


def _fused(group: _Group, n_records: int) -> MeasuredRelaxation:
    """Return the mean of ln a weighted by precision, its scatter in the standard deviation (Birge 1932)."""
    n, w, wx, wxx = group.sums
    chi2 = (wxx * w - wx * wx) / w / UNIT
    widened = max(1.0, chi2 / (n - 1)) if n > 1 else 1.0
    rate = float(np.exp(wx / w))
    std = rate * float(np.sqrt(widened * UNIT / w))
    names, shape = (
        ((), np.empty(0, complex)) if group.shape is None else (_names(group.shape), group.shape.shape)
    )
    return MeasuredRelaxation("", rate, std, names, shape, min(n, n_records))


def _as_measured(one: GivenRelaxation, records: int) -> MeasuredRelaxation:
    shape = np.array(list(one.shape.values()), dtype=np.complex128)
    return MeasuredRelaxation("", one.rate_rad_s, one.rate_std_rad_s, tuple(one.shape), shape, records)
