"""Exploration of a twin's law: effect of its parameters on modes and cost, and the paths of the search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import did_you_mean, located, require, require_between
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.progress import SILENT, Progress
from jackettwin.response import mode_kinds, mode_labels
from jackettwin.study.run import run_twin
from jackettwin.twin import TwinConfig
from jackettwin.updating import (
    CostCurve,
    CostSurface,
    Locus,
    ModeSensitivity,
    Problem,
    SearchMethod,
    SearchPath,
    SupportModel,
    Update,
    cost_curve,
    cost_surface,
    numbered_modes,
    root_locus,
    search_paths,
    sensitivity,
    starting_points,
)


@dataclass(frozen=True)
class ExploreSettings:
    """Extent of an exploration.

    Attributes
    ----------
    modes : numbers; empty for the first five, and those measured
    along : parameters of the root loci; empty for all of the law
    over : the two parameters of the cost surface; empty for the first two
    grid : points of the surface along each parameter
    starts : number of the search's own starting points whose paths are computed
    points : {parameter: value} of further starting points; omitted parameters have the solution's values
    method : {"least-squares", "nelder-mead"} of the paths
    at : {parameter: value} of the point to explore; omitted parameters have the solution's values
    """

    modes: tuple[int, ...] = ()
    along: tuple[str, ...] = ()
    over: tuple[str, ...] = ()
    grid: int = 49
    starts: int = 8
    points: tuple[Mapping[str, float], ...] = ()
    method: SearchMethod = "least-squares"
    at: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class CostLandscape:
    """The cost as a function of the parameters, and the paths of searches over it.

    Attributes
    ----------
    update : Update
        Every solution; nothing is sampled.
    surface : CostSurface or None
        None for a law with one parameter.
    curves : one for each parameter
    paths : one for each starting point
    method : of the paths
    """

    update: Update
    surface: CostSurface | None
    curves: tuple[CostCurve, ...]
    paths: tuple[SearchPath, ...]
    method: SearchMethod


@dataclass(frozen=True)
class Exploration:
    """Effect of the parameters of one law.

    Attributes
    ----------
    name : of the twin or structure
    model : SupportModel
    theta : (n_parameters,) parameters of the model at the point explored
    labels : of the modes of ``sensitivity``
    sensitivity : ModeSensitivity
    loci : one for each parameter
    landscape : CostLandscape or None
        None where nothing was measured.
    """

    name: str
    model: SupportModel
    theta: FloatArray
    labels: tuple[str, ...]
    sensitivity: ModeSensitivity
    loci: tuple[Locus, ...]
    landscape: CostLandscape | None = None


def explore(
    config: TwinConfig,
    settings: ExploreSettings = ExploreSettings(),
    *,
    law: str | None = None,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Exploration:
    """Explore one law of a twin around its best solution, or around a given point.

    Parameters
    ----------
    law : str, optional
        Default: the first of the twin file.
    progress : Progress
        Receives the steps of ``run_twin`` for one law and two more.

    Raises
    ------
    InputError
        If the twin cannot be run or has no such mode or parameter, or a value is out of bounds.
    """
    chosen = (law or config.update.laws[0],)
    result = run_twin(config, laws=chosen, posteriors="none", progress=progress, keep=keep)
    (update,) = result.updates
    return explore_update(config.name, update, settings, seed=config.update.seed, progress=progress)


def explore_update(
    name: str,
    update: Update,
    settings: ExploreSettings = ExploreSettings(),
    *,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Exploration:
    """Explore a law that was fitted, around its best solution or around a given point.

    Parameters
    ----------
    seed : of the starting points
    progress : Progress
        Receives two steps.

    Raises
    ------
    InputError
        If the law has no such mode or parameter, or a value is out of bounds.
    """
    problem = update.problem
    with located(field="at"):
        at = _point(problem, settings.at, update.best.theta)
    progress("cost and paths of the search")
    landscape = _landscape(update, settings, at, seed=seed, progress=progress)
    theta = problem.vectors(np.log(at)[None], problem.states[0])[0]
    progress("modes along the parameters")
    return _explored(name, update.model, theta, settings, update.shown, landscape)


def explore_model(
    name: str, model: SupportModel, theta: FloatArray, settings: ExploreSettings = ExploreSettings()
) -> Exploration:
    """Explore a structure on supports without measurements: its modes only, without a cost.

    Parameters
    ----------
    theta : (n_parameters,) of the model

    Raises
    ------
    InputError
        If the model has no such mode or parameter.
    """
    return _explored(name, model, theta, settings, (), None)


def _explored(
    name: str,
    model: SupportModel,
    theta: FloatArray,
    settings: ExploreSettings,
    measured: tuple[int, ...],
    landscape: CostLandscape | None,
) -> Exploration:
    modes = settings.modes or tuple(sorted({*range(1, 6), *measured}))
    with located(field="modes"):
        model, modes = _with_modes(model, modes, said=bool(settings.modes))
    numbered = numbered_modes(model.assembly, max(modes))
    labels = mode_labels(mode_kinds(model.assembly, numbered.shapes, numbered.frequency_hz))
    with located(field="along"):
        loci = tuple(
            root_locus(model, theta, parameter, modes) for parameter in settings.along or _all(model)
        )
    shown = tuple(labels[mode - 1] for mode in modes)
    return Exploration(name, model, theta, shown, sensitivity(model, theta, modes), loci, landscape)


def _with_modes(
    model: SupportModel, modes: tuple[int, ...], *, said: bool
) -> tuple[SupportModel, tuple[int, ...]]:
    """Return the model with at least these modes; modes that it lacks are omitted unless requested."""
    there = numbered_modes(model.assembly, max(modes)).omega.size
    beyond = [mode for mode in modes if mode > there]
    require(
        not (beyond and said),
        "the structure has fewer modes",
        value=beyond,
        allowed=f"1 to {there}",
        remedy="leave them out, or divide the structure's members (subdivide)",
    )
    known = tuple(mode for mode in modes if mode <= there)
    return model.reaching(max(known)), known


def _all(model: SupportModel) -> tuple[str, ...]:
    """Return the parameters of the loci: the law's own if all tie groups have them, and other free ones."""
    one_loss = model.tie_groups.one_loss
    names = [p.name for p in model.parameters[: model.n_of_law]] if one_loss else model.family.names
    return (*names, *(p.name for p in model.parameters[model.n_of_law :]))


def _landscape(
    update: Update, settings: ExploreSettings, at: FloatArray, *, seed: int, progress: Progress
) -> CostLandscape:
    problem = update.problem
    with located(field="start"):
        own = [_point(problem, given, update.best.theta) for given in settings.points]
    scattered = list(starting_points(problem, settings.starts, seed))
    paths = search_paths(
        problem,
        np.reshape([*own, *scattered], (-1, at.size)),
        update.solutions,
        method=settings.method,
        progress=progress,
    )
    with located(field="over"):
        axes = _axes(problem, settings.over)
    progress.within("cost surface")
    surface = None
    if axes:
        x, y = (
            np.geomspace(problem.parameters[a].low, problem.parameters[a].high, settings.grid) for a in axes
        )
        surface = cost_surface(problem, at, axes, x, y)
    curves = tuple(cost_curve(problem, at, j) for j in range(at.size))
    return CostLandscape(update, surface, curves, paths, settings.method)


def _axes(problem: Problem, names: Sequence[str]) -> tuple[int, int] | None:
    """Return the indices of two parameters; the first two without names, None if there is only one."""
    known = [p.name for p in problem.parameters]
    if not names:
        return (0, 1) if len(known) > 1 else None
    for name in names:
        _known(name, known)
    require(len(set(names)) == 2, "a surface has two parameters", value=list(names), allowed="two names")
    return known.index(names[0]), known.index(names[1])


def _point(problem: Problem, given: Mapping[str, float], otherwise: FloatArray) -> FloatArray:
    """Return θ (d,) with some values given.

    Raises
    ------
    InputError
        If there is no such parameter, or a value is outside its bounds.
    """
    known = [p.name for p in problem.parameters]
    theta = otherwise.copy()
    for name, value in given.items():
        _known(name, known)
        p = problem.parameters[known.index(name)]
        require_between(name, value, p.low, p.high, p.unit if p.unit != "-" else "")
        theta[known.index(name)] = value
    return theta


def _known(name: str, known: Sequence[str]) -> None:
    remedy = did_you_mean(name, known)
    require(name in known, "no such parameter", value=name, allowed=", ".join(known), remedy=remedy)


def exploration_document(found: Exploration) -> dict[str, Any]:
    """Return an exploration as JSON data, SI units."""
    values = zip(found.model.parameters, found.theta, strict=True)
    return {
        "name": found.name,
        "law": found.model.family.name,
        "parameters": [
            {"name": p.name, "unit": p.unit, "value": float(v), "low": p.low, "high": p.high}
            for p, v in values
        ],
        "modes": sensitivity_rows(found.sensitivity, found.labels),
        "largest_difference_from_central_differences": found.sensitivity.difference,
        "loci": [_locus(locus, found.labels) for locus in found.loci],
        **(_no_landscape() if found.landscape is None else _landscape_document(found.landscape)),
    }


def sensitivity_rows(s: ModeSensitivity, labels: Sequence[str]) -> list[dict[str, Any]]:
    """Return a row for each mode at a point, with its sensitivity to every parameter.

    Parameters
    ----------
    labels : of the modes
    """
    names = [p.name for p in s.parameters]
    return [
        {
            "mode": mode,
            "label": label,
            "frequency_hz": float(s.frequency_hz[i]),
            "damping_ratio": float(s.damping_ratio[i]),
            "frequency_sensitivity": dict(zip(names, map(float, s.frequency[i]), strict=True)),
            "damping_sensitivity": dict(zip(names, map(float, s.damping[i]), strict=True)),
        }
        for i, (mode, label) in enumerate(zip(s.modes, labels, strict=True))
    ]


def _locus(locus: Locus, labels: tuple[str, ...]) -> dict[str, Any]:
    branches = [
        {
            "mode": mode,
            "label": label,
            "pole_real_rad_s": locus.poles[:, i].real,
            "pole_imag_rad_s": locus.poles[:, i].imag,
            "frequency_hz": locus.frequency_hz[:, i],
            "damping_ratio": locus.damping_ratio[:, i],
            "most_damped_at": locus.most_damped(i)[0],
            "most_damping_ratio": locus.most_damped(i)[1],
        }
        for i, (mode, label) in enumerate(zip(locus.modes, labels, strict=True))
    ]
    p = locus.parameter
    return {
        "parameter": p.name,
        "unit": p.unit,
        "values": locus.values,
        "origin": locus.origin,
        "branches": branches,
    }


def _no_landscape() -> dict[str, Any]:
    return {"search": None, "solutions": [], "surface": None, "curves": [], "paths": []}


def _landscape_document(seen: CostLandscape) -> dict[str, Any]:
    names, surface = [p.name for p in seen.update.problem.parameters], seen.surface

    def named(theta: FloatArray) -> dict[str, float]:
        return dict(zip(names, map(float, theta), strict=True))

    return {
        "search": seen.update.search.statement,
        "solutions": [
            {
                "parameters": named(s.theta),
                "cost": s.cost,
                "locked_damper": s.locked_damper,
                "starts": s.found,
            }
            for s in seen.update.solutions
        ],
        "surface": surface
        and {
            "x": {"parameter": surface.parameters[0].name, "values": surface.x},
            "y": {"parameter": surface.parameters[1].name, "values": surface.y},
            "cost": surface.cost,
        },
        "curves": [
            {"parameter": c.parameter.name, "value": c.value, "factor": c.factor, "cost": c.cost}
            for c in seen.curves
        ],
        "method": seen.method,
        "paths": [
            {
                "start": named(path.points[0]),
                "end": named(path.end),
                "start_cost": float(path.cost[0]),
                "end_cost": path.end_cost,
                "evaluations": len(path.cost),
                "fate": path.fate,
                "solution": path.solution,
                "points": path.points,
                "cost": path.cost,
            }
            for path in seen.paths
        ],
    }
