"""The inverse problem of a twin under one law: parameters of its supports from measured data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.response import modal_damping
from jackettwin.soil import Support, family, read_support
from jackettwin.structure import Assembly
from jackettwin.study.measurements import MeasuredRelaxation
from jackettwin.study.relaxations import placed, relaxation_targets
from jackettwin.study.rotor import RotorDamping, States
from jackettwin.twin import ALL, REMAINDERS, SCALES, TwinConfig, TwinState, directions
from jackettwin.twin.water import in_the_records_sea, water_effects
from jackettwin.updating import (
    ErrorModel,
    Growth,
    NuisanceParameters,
    PairDirection,
    Problem,
    ProfileTarget,
    RelaxationTarget,
    Residuals,
    ShapeTarget,
    SupportModel,
    ToleranceDirections,
    joint,
    matrix_of,
    support_model,
)


@dataclass(frozen=True)
class UpdateEvidence:
    """Data that every law is fitted to.

    Attributes
    ----------
    assembly : Assembly
    state : TwinState or None
        State of the records; None if the twin file gives targets.
    states : {operating state: residuals and factors of the parameters}
    rotor : RotorDamping
    relaxations : tuple of MeasuredRelaxation
    pairs : tuple of PairDirection
        Measured directions of bending pairs.
    """

    assembly: Assembly
    state: TwinState | None
    states: States
    rotor: RotorDamping
    relaxations: tuple[MeasuredRelaxation, ...] = ()
    pairs: tuple[PairDirection, ...] = ()


def law_problem(config: TwinConfig, evidence: UpdateEvidence, law: str) -> Problem:
    """Return the problem of one law: residuals of all operating states as functions of its parameters.

    Raises
    ------
    InputError
        If bounds, priors, ties or pile heads do not fit the law.
    """
    return model_problem(config, evidence, law_model(config, evidence, law))


def model_problem(config: TwinConfig, evidence: UpdateEvidence, model: SupportModel) -> Problem:
    """Return the problem of a model: residuals of all operating states as functions of its parameters."""
    relaxations = relaxation_targets(
        config,
        model,
        evidence.relaxations,
        sensors=() if evidence.state is None else placed(evidence.state),
        relative=any(residuals.relative for residuals, _ in evidence.states.values()),
    )
    shapes = measured_shapes(config, model, evidence)
    return tied_problem(
        config,
        model,
        evidence.states,
        shapes=shapes,
        relaxations=relaxations,
        error_model=error_model(config, model, evidence.pairs),
    )


def error_model(
    config: TwinConfig, model: SupportModel, pairs: tuple[PairDirection, ...] = ()
) -> ErrorModel | None:
    """Return the errors of a twin's model, tolerances and remainders; None if the twin sets all to zero.

    ``update.model_error`` replaces the remainder of the modes that it names.
    """
    usual = {name: config.tolerances.std(name, std) for name, std in REMAINDERS.items()}
    stated: dict[str, float] = {}
    for mode in sorted({mode for error in config.update.model_errors for mode in error.modes}):
        error = config.update.model_error(mode)
        stated |= {f"f{mode}": error.frequency} if error.frequency > 0.0 else {}
        stated |= {f"ζ{mode}": error.damping} if error.damping > 0.0 else {}
    if model.directions is None or not (model.directions.each or stated or any(usual.values())):
        return None
    f, zeta = usual["remainder_frequency"], usual["remainder_damping"]
    return ErrorModel(model.directions, stated, f, zeta, SCALES, pairs)


def tied_problem(
    config: TwinConfig,
    model: SupportModel,
    states: States,
    *,
    shapes: tuple[ShapeTarget, ...] = (),
    relaxations: tuple[RelaxationTarget, ...] = (),
    errors: Mapping[str, float] | None = None,
    growth: Growth | None = None,
    error_model: ErrorModel | None = None,
) -> Problem:
    """Return the problem of a model in some states, its legs tied as the twin states."""
    law = {p.name + side for p in model.family.parameters for side in ("", *model.tie_groups.sides)}
    with located(file=config.path):
        return joint(
            model,
            states,
            shapes=shapes,
            relaxations=relaxations,
            shared=tuple(name for name in config.shared if name in law),
            scatter={name: scale for name, scale in config.scatter.items() if name in law},
            errors=errors,
            growth=growth,
            error_model=error_model,
        )


def law_model(config: TwinConfig, evidence: UpdateEvidence, law: str) -> SupportModel:
    """Return the structure on supports of one law, with the twin's bounds and priors of the parameters.

    Raises
    ------
    InputError
        If bounds, priors, ties or pile heads do not fit the law.
    """
    chosen, given, states = family(law), config.update, evidence.states
    said = {name: (prior.median, prior.log_std) for name, prior in given.priors.items()}
    with located(file=config.path):
        waves = None if evidence.state is None else evidence.state.totals[ALL].conditions.waves
        water = water_effects(in_the_records_sea(config.water, waves), evidence.assembly, given.water)
        others = {name: matrix_of(name)(evidence.assembly) for name in given.parameters}
        by_mode = config.mode_damping
        own_steel = {"modes": modal_damping(evidence.assembly, by_mode, config.rayleigh)} if by_mode else {}
    nuisance = NuisanceParameters(
        given.dashpots, given.steel_damping == "free", evidence.rotor.patterns, {**water, **others}, own_steel
    )
    own = {p.name for p in (*chosen.parameters, *nuisance.parameters)}
    relative = any(residuals.relative for residuals, _ in states.values())
    stands = evidence.assembly
    if evidence.rotor.stiffness is not None:
        stands = replace(stands, stiffness=stands.stiffness + evidence.rotor.stiffness)
    try:
        model = support_model(
            stands,
            family=chosen,
            rayleigh=config.rayleigh,
            tie=config.tie,
            bounds=_of_law(given.bounds, own),
            priors=_of_law({**evidence.rotor.priors, **said}, own),
            highest_mode=max(mode for residuals, _ in states.values() for mode in residuals.modes),
            fastest_rate=max((r.rate_rad_s for r in evidence.relaxations), default=0.0),
            nuisance=nuisance,
            heads=_heads(config),
            informed=not relative,
        )
    except InputError as error:
        raise error.at(file=config.path, field=_place(error)) from None
    each = () if relative else directions(config, evidence.assembly)
    n_soil = len(model.tie_groups.suffixes)
    return replace(model, directions=ToleranceDirections(stands, model.condensed, each, n_soil))


def _place(error: InputError) -> str | None:
    """Return the block of the twin file that contains the field named by an error of the model."""
    block = (error.field or "").partition(".")[0]
    return {"bounds": "update", "priors": "update", "mode": "targets"}.get(block)


def _heads(config: TwinConfig) -> Support | None:
    """Return the pile heads that the laws scale."""
    if config.heads is None:
        return None
    with located(file=config.path, field="support.stiffness"):
        source = None if config.heads == "own" else config.heads
        return read_support(source, config.structure, folder=config.path.parent)


def measured_shapes(
    config: TwinConfig, model: SupportModel, evidence: UpdateEvidence
) -> tuple[ShapeTarget, ...]:
    """Return the measured shape of highest MAC of each fitted mode; none where shapes are not fitted."""
    state = evidence.state
    first, _ = next(iter(evidence.states.values()))
    if state is None:
        return _given_shapes(config, model, first)
    if first.relative:
        return ()
    best = {mode: state.clearest[str(mode)] for mode in first.modes if str(mode) in state.clearest}
    return tuple(
        kind.seen(model, mode, one.frequency_hz, one.sensors, one.shape, std)
        for kind, std in _shape_kinds(config)
        for mode, one in best.items()
    )


def _shape_kinds(config: TwinConfig) -> list[tuple[type[ShapeTarget], float]]:
    """Return what is fitted of mode shapes, and its standard deviation."""
    kinds = ((ShapeTarget, config.update.mac_std), (ProfileTarget, config.update.profile_std))
    return [(kind, std) for kind, std in kinds if std is not None]


def _given_shapes(config: TwinConfig, model: SupportModel, data: Residuals) -> tuple[ShapeTarget, ...]:
    """Return the shapes of the targets that are fitted."""
    kinds = _shape_kinds(config)
    if not kinds:
        return ()
    if data.relative:
        raise InputError(
            "shapes can be fitted with data that have standard deviations, not with relative errors",
            file=config.path,
            field="update.mac_std" if config.update.mac_std else "update.profile_std",
            value=kinds[0][1],
            remedy="give every target its standard deviation, or omit the shapes",
        )
    places = {sensor.channel: sensor for sensor in config.sensors}
    shapes: list[ShapeTarget] = []
    for t in data.used:
        given = config.shapes.get(t.mode, {})
        if given and t.frequency_hz is not None:
            sensors, values = tuple(places[name] for name in given), np.array(list(given.values()))
            with located(file=config.path):
                shapes += [
                    kind.seen(model, t.mode, t.frequency_hz, sensors, values, std) for kind, std in kinds
                ]
    return tuple(shapes)


def _of_law(given: Mapping[str, tuple[float, float]], names: set[str]) -> dict[str, tuple[float, float]]:
    """Return the entries of these parameters, with or without a tie's suffix, as all laws share one file."""
    return {k: v for k, v in given.items() if any(k == n or k.startswith(f"{n}_") for n in names)}
