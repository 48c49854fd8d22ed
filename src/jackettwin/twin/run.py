"""The main job: records to modes to updated supports."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import hypot

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.response.labels import mode_kinds, mode_labels
from jackettwin.soil.files import read_support
from jackettwin.soil.support import Support
from jackettwin.structure import Assembly, assemble
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.measure import Measured, Sighting, fuse, measure
from jackettwin.twin.narrative import assumptions, cautions
from jackettwin.twin.result import DampingExcess, MeasuredMode, TwinResult
from jackettwin.twin.rotor import States, mean_wind, operating_states, rotor_damping
from jackettwin.updating import (
    Residuals,
    Target,
    Update,
    family,
    joint,
    numbered_modes,
    support_model,
    update,
)
from jackettwin.updating.extras import Extras
from jackettwin.updating.model import SupportModel
from jackettwin.updating.shapes import ShapeTarget

_PAIRED_MODES = 12
"""Modes of the model that measured modes may be paired with."""


def run_twin(
    config: TwinConfig,
    *,
    laws: tuple[str, ...] | None = None,
    step: Callable[[str], None] = lambda _: None,
) -> TwinResult:
    """Identify the records of a twin (or take its targets) and update its supports under each law.

    Parameters
    ----------
    laws : tuple of str, optional
        Instead of the twin file's.
    step : callable
        Told what is being done, once a step; ``count_steps`` says how many there are.

    Raises
    ------
    InputError
        If records, sensors or targets do not fit the structure.
    NumericalError
        If no solution can be found.
    """
    step("assemble the structure")
    assembly = assemble(
        config.structure,
        beam_theory=config.beam,
        rotary_inertia=config.rotary_inertia,
        subdivide=config.subdivide,
        gravity=config.gravity,
    )
    number = max([_PAIRED_MODES, *(target.mode + 2 for target in config.targets)])
    numbered = numbered_modes(assembly, number)
    labels = mode_labels(mode_kinds(assembly, numbered.shapes))
    found = measure(config, assembly, numbered, step=step) if config.records else None
    measured = _from_records(config, found, labels) if found is not None else _from_targets(config, labels)
    residuals = _residuals(config, measured)
    wind = mean_wind(config, found)
    states = operating_states(config, measured, found, residuals, wind)
    rotor = rotor_damping(config, assembly, numbered, wind)
    priors = {**rotor.priors, **config.update.priors}
    extras = Extras(config.update.dashpots, config.update.steel_damping == "free", rotor.patterns)
    heads = _heads(config)
    shown = tuple(m.mode for m in measured)
    updates = []
    for law in laws or config.update.laws:
        step(f"update {law}")
        updates.append(_update(config, assembly, law, states, priors, extras, heads, shown, found))
    return TwinResult(
        name=config.name,
        assembly=assembly,
        sensors=() if found is None else found.sensors,
        numbered=numbered,
        labels=labels,
        observations=() if found is None else found.observations,
        names=() if found is None else _names(found, labels),
        measured=measured,
        updates=tuple(updates),
        excess=tuple(_excess(measured, result) for result in updates),
        assumptions=assumptions(config, measured, wind),
        warnings=cautions(config, found, measured, tuple(updates)),
    )


def _names(found: Measured, labels: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple("" if n is None else labels[n - 1] for n in numbers) for numbers in found.numbers)


def count_steps(config: TwinConfig, laws: tuple[str, ...] | None = None) -> int:
    """Return how many steps ``run_twin`` announces."""
    return 1 + len(config.records) + len(laws or config.update.laws)


def _update(
    config: TwinConfig,
    assembly: Assembly,
    law: str,
    states: States,
    priors: Mapping[str, tuple[float, float]],
    extras: Extras,
    heads: Support | None,
    modes: tuple[int, ...],
    found: Measured | None,
) -> Update:
    chosen, s = family(law), config.update
    own = {p.name for p in (*chosen.parameters, *extras.parameters)}
    try:
        model = support_model(
            assembly,
            family=chosen,
            rayleigh=config.rayleigh,
            tie=config.tie,
            bounds=_of_law(s.bounds, own),
            priors=_of_law(priors, own),
            highest_mode=max(mode for r, _ in states.values() for mode in r.modes),
            extras=extras,
            heads=heads,
            head_priors=not any(r.relative for r, _ in states.values()),
        )
        problem = joint(model, states, shapes=_shapes(config, model, found, states))
    except InputError as error:
        raise error.at(file=config.path, field="update" if s.bounds or s.priors else None) from None
    return update(
        problem,
        modes=modes,
        method=s.method,
        starts=s.starts,
        particles=s.particles,
        sampler=s.sampler,
        seed=s.seed,
    )


def _heads(config: TwinConfig) -> Support | None:
    """Return the pile heads that the laws scale."""
    if config.heads is None:
        return None
    with located(file=config.path, field="support.stiffness"):
        source = None if config.heads == "own" else config.heads
        return read_support(source, config.structure, folder=config.path.parent)


def _shapes(
    config: TwinConfig, model: SupportModel, found: Measured | None, states: States
) -> tuple[ShapeTarget, ...]:
    """Return the shape of each fitted mode where it is most like the model's."""
    first, _ = next(iter(states.values()))
    if config.update.mac_std is None or found is None or first.relative:
        return ()
    by_channel = {sensor.channel: sensor for sensor in found.sensors}
    channels = {
        id(mode): seen.identification.channels
        for seen in found.observations
        for mode in seen.identification.modes
    }
    shapes = []
    for mode in first.modes:
        best = max(found.sightings[mode], key=lambda seen: seen.mac).estimate
        places = tuple(by_channel[c.name] for c in channels[id(best)] if c.name in by_channel)
        if len(places) == best.mode_shape.size:
            shapes.append(
                ShapeTarget.seen(
                    model, mode, best.frequency_hz, places, best.mode_shape, config.update.mac_std
                )
            )
    return tuple(shapes)


def _of_law(given: Mapping[str, tuple[float, float]], names: set[str]) -> dict[str, tuple[float, float]]:
    """Return what is given for these parameters, with or without a tie's suffix: laws share one file."""
    return {k: v for k, v in given.items() if any(k == n or k.startswith(f"{n}_") for n in names)}


def _from_targets(config: TwinConfig, labels: tuple[str, ...]) -> tuple[MeasuredMode, ...]:
    return tuple(
        MeasuredMode(
            mode=t.mode,
            label=labels[t.mode - 1],
            frequency_hz=t.frequency_hz,
            frequency_std_hz=t.frequency_std_hz,
            damping_ratio=t.damping_ratio,
            damping_ratio_std=t.damping_ratio_std,
            estimate=None,
            mac=None,
            fits_frequency=t.frequency_hz is not None,
            fits_damping=t.damping_ratio is not None,
        )
        for t in sorted(config.targets, key=lambda t: t.mode)
    )


def _from_records(config: TwinConfig, found: Measured, labels: tuple[str, ...]) -> tuple[MeasuredMode, ...]:
    if not found.sightings:
        raise InputError(
            "no identified mode resembles a mode of the model",
            file=config.path,
            field="records",
            value=[path.name for path in config.records],
            remedy="check the sensors' places and directions, and the structure",
        )
    return tuple(
        _measured_mode(config, mode, labels[mode - 1], seen) for mode, seen in found.sightings.items()
    )


def _measured_mode(config: TwinConfig, mode: int, label: str, seen: tuple[Sighting, ...]) -> MeasuredMode:
    f, f_std, zeta, zeta_std = fuse(seen)
    best = max(seen, key=lambda s: s.mac)
    chosen = mode in config.update.modes
    wanted = config.update.damping_of
    damped = wanted == "all" or (
        wanted != "none" and (label.startswith(wanted) if isinstance(wanted, str) else label in wanted)
    )
    return MeasuredMode(
        mode, label, f, f_std, zeta, zeta_std, best.estimate, best.mac, chosen, chosen and damped
    )


def _residuals(config: TwinConfig, measured: tuple[MeasuredMode, ...]) -> Residuals:
    """Return the residuals of all measured modes; what takes no part in the fit is None."""
    errors = [config.update.model_error(m.mode) for m in measured]
    complete = all(
        (m.frequency_std_hz is not None or e.frequency > 0.0 or not m.fits_frequency)
        and (m.damping_ratio_std is not None or e.damping > 0.0 or not m.fits_damping)
        for m, e in zip(measured, errors, strict=True)
    )
    weighting = config.update.weighting
    if weighting == "covariance" and not complete:
        raise InputError(
            "covariance weighting needs a standard deviation of every target",
            file=config.path,
            field="update.weighting",
            value=weighting,
            remedy="give frequency_std_hz and damping_ratio_std, or weighting: relative",
        )
    relative = weighting == "relative" or not complete
    targets = []
    for m, error in zip(measured, errors, strict=True):
        f = m.frequency_hz if m.fits_frequency else None
        zeta = m.damping_ratio if m.fits_damping else None
        targets.append(
            Target(
                m.mode,
                f,
                None if relative or f is None else hypot(m.frequency_std_hz or 0.0, error.frequency * f),
                zeta,
                None if relative or zeta is None else hypot(m.damping_ratio_std or 0.0, error.damping * zeta),
            )
        )
    with located(file=config.path):
        return Residuals(tuple(targets), relative)


def _excess(measured: tuple[MeasuredMode, ...], result: Update) -> tuple[DampingExcess, ...]:
    return tuple(
        DampingExcess(m.label, m.damping_ratio, m.damping_ratio_std, float(steel + soil), float(rotor))
        for m, (steel, soil, rotor) in zip(measured, result.budget.damping_ratio, strict=True)
        if m.damping_ratio is not None and not np.isnan(steel)
    )
