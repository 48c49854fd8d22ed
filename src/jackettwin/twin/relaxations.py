"""Measured relaxations of a twin: given as targets or found in its records, as data of the update."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import hypot

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.identification.mac import mac
from jackettwin.identification.subspace.real_poles import JOINED
from jackettwin.response.sensors import Sensor
from jackettwin.twin.config import GivenRelaxation, TwinConfig
from jackettwin.twin.measure import Measured
from jackettwin.twin.result import MeasuredRelaxation
from jackettwin.updating import SupportModel, family
from jackettwin.updating.relaxations import RelaxationTarget

_LEAST_SHARE = 0.5
"""A relaxation that fewer of the records show is left out."""

Seen = dict[int, GivenRelaxation]
"""One relaxation, {record: as it shows it}."""


def measured_relaxations(config: TwinConfig, found: Measured | None) -> tuple[MeasuredRelaxation, ...]:
    """Return the relaxations of the twin file, or those that its records share; the slowest first."""
    if found is None:
        fused = [_as_measured(given, records=0) for given in config.relaxations]
    else:
        least = _LEAST_SHARE * len(found.relaxations)
        groups = _distinct(found.relaxations)
        fused = [_as_measured(_fused(seen), len(seen)) for seen in groups if len(seen) >= least]
    ordered = sorted(fused, key=lambda one: one.rate_rad_s)
    return tuple(replace(one, name=f"a{i + 1}") for i, one in enumerate(ordered))


def relaxation_targets(
    config: TwinConfig,
    model: SupportModel,
    measured: tuple[MeasuredRelaxation, ...],
    *,
    sensors: tuple[Sensor, ...],
    relative: bool,
) -> tuple[RelaxationTarget, ...]:
    """Return what a model is fitted to: rates with the model's error, shapes where they are known."""
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
    """Return the laws under which a structure has real poles at all.

    Raises
    ------
    InputError
        If none has.
    """
    kept = tuple(law for law in laws if family(law).relaxes)
    if not kept:
        raise InputError(
            "no structure on this law has real poles, and one was measured",
            file=config.path,
            field="update.laws",
            value=", ".join(laws),
            remedy="another law, or leave the relaxations out (targets; identification.real_poles: false)",
        )
    return kept


def _distinct(records: tuple[tuple[GivenRelaxation, ...], ...]) -> list[Seen]:
    """Return the distinct relaxations of all records, each in one record once at most, the surest first."""
    sightings = [(i, one) for i, shown in enumerate(records) for one in shown]
    groups: list[Seen] = []
    for record, one in sorted(sightings, key=lambda seen: _log_std(seen[1])):
        apart = [np.inf if record in group else _apart(one, next(iter(group.values()))) for group in groups]
        nearest = int(np.argmin(apart)) if groups else -1
        if groups and apart[nearest] < JOINED:
            groups[nearest][record] = one
        else:
            groups.append({record: one})
    return groups


def _log_std(one: GivenRelaxation) -> float:
    return (one.rate_std_rad_s or 0.0) / one.rate_rad_s


def _apart(one: GivenRelaxation, other: GivenRelaxation) -> float:
    """Return |Δ ln a| + 1 − MAC at the channels of both, as identification joins relaxations."""
    common = [channel for channel in one.shape if channel in other.shape]
    shapes = [np.array([given.shape[channel] for channel in common]) for given in (one, other)]
    unlike = 1.0 - float(mac(*shapes)) if common else 0.0
    return abs(float(np.log(one.rate_rad_s / other.rate_rad_s))) + unlike


def _fused(seen: Seen) -> GivenRelaxation:
    """Return the mean of ln a weighted by precision, its scatter in the standard deviation (Birge 1932)."""
    each = list(seen.values())
    log_rate = np.log([one.rate_rad_s for one in each])
    weight = np.array([_log_std(one) for one in each]) ** -2.0
    mean = float(weight @ log_rate / weight.sum())
    chi2 = float(weight @ (log_rate - mean) ** 2)
    widened = max(1.0, chi2 / (len(each) - 1)) if len(each) > 1 else 1.0
    rate = float(np.exp(mean))
    return GivenRelaxation(rate, rate * float(np.sqrt(widened / weight.sum())), each[0].shape)


def _as_measured(one: GivenRelaxation, records: int) -> MeasuredRelaxation:
    shape = np.array(list(one.shape.values()), dtype=np.complex128)
    return MeasuredRelaxation("", one.rate_rad_s, one.rate_std_rad_s, tuple(one.shape), shape, records)
