"""The report's sections on the update: what it fits, its solutions, what it leaves unexplained."""

from __future__ import annotations

from jackettwin.report import explore, figures_landscape
from jackettwin.report import figures_updating as compare
from jackettwin.report import tables_updating as tables
from jackettwin.report.figures_modes import Shape, mode_shapes_3d
from jackettwin.report.figures_solutions import solution_map
from jackettwin.report.numbers import frequency, percent, words
from jackettwin.report.page import Block, Plot, Text
from jackettwin.report.summary import shown_update
from jackettwin.twin import TwinResult
from jackettwin.twin.truth import true_modes, true_parameters
from jackettwin.updating import Update


def identified_against_updated(result: TwinResult) -> list[Block]:
    """Return measured against updated modes, and the updated parameters."""
    if not result.updates:
        return []
    f, zeta = compare.frequency_errors, compare.damping_comparison
    return [
        Plot(
            "frequencies",
            "Updated frequencies relative to the measured ones, whose 95 % intervals are the bars.",
            f(result.measured, result.updates),
        ),
        Plot(
            "damping",
            "Measured damping ratios with 95 % intervals, and those of each updated law.",
            zeta(result.measured, result.updates),
        ),
        *([tables.relaxation_table(result)] if result.relaxations else []),
        tables.parameter_table(result.updates),
    ]


def against_the_truth(result: TwinResult) -> list[Block]:
    """Return what is known to be true beside what was found; nothing where nothing is known."""
    known, parameters = true_modes(result), true_parameters(result)
    blocks: list[Block] = [tables.truth_table(result, known)] if known else []
    return [*blocks, tables.true_parameters_table(parameters)] if parameters else blocks


def damped_and_undamped(result: TwinResult) -> list[Block]:
    """Return how far each damper stiffens the structure."""
    if not result.updates:
        return []
    text = (
        "A dashpot that is too strong to move acts as a spring: the damped frequencies fit while the "
        "structure without damping is wrong. Differences beyond 5 % are flagged as locked dampers."
    )
    caption = "Difference of undamped from damped frequencies."
    figure = compare.damped_undamped(result.measured, result.updates)
    return [Text((text,)), tables.damped_undamped_table(result), Plot("damped_undamped", caption, figure)]


def the_mode_shapes(result: TwinResult) -> list[Block]:
    """Return the updated mode shapes, moving, with the measured ones at the sensors."""
    if not result.updates:
        return []
    u = shown_update(result)
    shapes = _shapes(result, u)
    caption = (
        f"Mode shapes of the full model updated with {u.law}. Coloured: damped, moving; dotted: undamped at "
        "its largest; pale: at rest. Arrows: the measured shape at the sensors, scaled to the model's."
    )
    return [Plot("mode_shapes", caption, mode_shapes_3d(result.assembly, shapes, result.sensors))]


def _shapes(result: TwinResult, u: Update) -> list[Shape]:
    undamped = explore.undamped_shapes(u)
    order = {
        channel.name: i for found in result.identifications[:1] for i, channel in enumerate(found.channels)
    }
    rows = [order.get(sensor.channel, -1) for sensor in result.sensors]
    shapes = []
    for i, m in enumerate(result.measured):
        f, zeta = float(u.modes.frequency_hz[i]), float(u.modes.damping_ratio[i])
        text = f"<b>{words(m.label)}</b><br>{frequency(f)} Hz<br>ζ {percent(zeta)} %"
        seen = m.estimate.mode_shape[rows] if m.estimate is not None and rows and min(rows) >= 0 else None
        shapes.append(Shape(text, m.label, u.modes.shapes[:, i], undamped[:, i], seen))
    return shapes


def every_solution(result: TwinResult) -> list[Block]:
    """Return every distinct solution of each law, and how complete the search was."""
    if not result.updates:
        return []
    said = tuple(f"{u.law}: {u.search.statement}" for u in result.updates)
    caption = (
        "Every solution of each law between the parameters' bounds. Lines: how far its valley reaches. "
        "Hollow: a locked damper."
    )
    return [
        Text(said),
        Plot("solutions", caption, solution_map(result.updates)),
        *(tables.solutions_table(result, u) for u in result.updates),
    ]


def around_the_solution(result: TwinResult) -> list[Block]:
    """Return sensitivities, cost surfaces and root loci."""
    if not result.updates:
        return []
    curves = [c for u in result.updates for c in explore.sensitivities(u.problem, u.best.theta)]
    caption = "Cost as one parameter moves by ±50 % about the solution, the others held."
    blocks: list[Block] = [Plot("sensitivity", caption, figures_landscape.sensitivity(curves))]
    blocks += [_surface(u) for u in result.updates if len(u.problem.parameters) == 2]
    labels = tuple(m.label for m in result.measured)
    for u in result.updates:
        path = explore.locus(u.model, u.best.theta, u.shown, labels)
        caption = (
            f"{u.law}: poles of each mode as {path.parameter} of every support goes from bound to bound."
        )
        blocks.append(Plot(f"root_locus_{u.law}", caption, figures_landscape.root_locus(path)))
    return blocks


def _surface(u: Update) -> Plot:
    x, y, cost = explore.surface(u)
    parameters = u.problem.parameters
    points = [
        (f"solution {i}{', damper locked' if s.locked_damper else ''}", float(s.theta[0]), float(s.theta[1]))
        for i, s in enumerate(u.solutions, start=1)
    ]
    figure = figures_landscape.cost_surface(
        x,
        y,
        cost,
        names=(parameters[0].name, parameters[1].name),
        units=(parameters[0].unit, parameters[1].unit),
        points=points,
    )
    return Plot(f"cost_surface_{u.law}", f"{u.law}: the cost over the whole bounds.", figure)


def unexplained_damping(result: TwinResult) -> list[Block]:
    """Return measured damping beside what steel, support and rotor give."""
    if not any(result.excess):
        return []
    u = shown_update(result)
    rows = result.excess[result.updates.index(u)]
    text = (
        "What exceeds steel and support has another source: for side-side modes of a parked rotor, above all "
        "its aerodynamics. It is given to the rotor's dashpot, if the twin has one, and reported, not forced "
        "into the soil."
    )
    caption = f"Measured damping beside what steel, the updated support ({u.law}) and the rotor give."
    return [
        Text((text,)),
        Plot("damping_excess", caption, compare.damping_excess(u.law, rows)),
        tables.excess_table(result),
    ]
