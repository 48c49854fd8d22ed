"""The page on an explored law: ends of searches, shape of the cost, sensitivity of the modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jackettwin.report.figures import landscape as figures
from jackettwin.report.pages.page import Block, PageSection, Plot, Text, write_page
from jackettwin.report.table import Table, cell
from jackettwin.report.tables.numbers import frequency, percent, quantity, words
from jackettwin.study import CostLandscape, Exploration
from jackettwin.updating import Locus
from jackettwin.version import __version__


def write_explore_page(found: Exploration, path: Path) -> Path:
    """Write one self-contained HTML file; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    values = ", ".join(
        f"{p.name} {quantity(float(v), p.unit, digits=3)}"
        for p, v in zip(found.model.parameters, found.theta, strict=True)
    )
    sections = [
        *([] if found.landscape is None else _cost(found.landscape)),
        PageSection("Sensitivity of the modes", _sensitivity(found)),
        PageSection("Root locus", tuple(block for locus in found.loci for block in _locus(found, locus))),
    ]
    law = found.model.family.name
    return write_page(
        sections,
        path,
        title=f"{found.name}: {law} explored",
        subtitle=f"at {values} · jackettwin {__version__}",
    )


def _cost(seen: CostLandscape) -> list[PageSection]:
    u = seen.update
    blocks: list[Block] = [Text((u.search.statement,)), solutions_table(seen), paths_table(seen)]
    shapes: list[Block] = []
    if seen.surface is not None:
        names = [p.name for p in u.problem.parameters]
        i, j = (names.index(p.name) for p in seen.surface.parameters)
        points = [
            (f"solution {n}", float(s.theta[i]), float(s.theta[j]))
            for n, s in enumerate(u.solutions, start=1)
        ]
        others = [name for name in names if name not in (names[i], names[j])]
        rest = f" The others ({', '.join(others)}) have their values at the explored point." if others else ""
        caption = (
            "Where is the cost low? Logarithm of the cost over two parameters; lines are the paths of "
            f"searches, which start at rings.{rest}"
        )
        shapes.append(
            Plot("cost_surface", caption, figures.cost_surface(seen.surface, points, seen.paths, (i, j)))
        )
    caption = "How sharp is the minimum? Cost as one parameter varies with the others fixed."
    shapes.append(Plot("cost_curves", caption, figures.cost_curves(seen.curves), fits=True))
    return [
        PageSection("Ends of the searches", tuple(blocks)),
        PageSection("Shape of the cost", tuple(shapes)),
    ]


def solutions_table(seen: CostLandscape) -> Table:
    """Return every solution in a column, that of lowest cost first."""
    found = seen.update.solutions
    rows = [
        (p.name, *(quantity(float(s.theta[j]), p.unit, digits=3) for s in found))
        for j, p in enumerate(seen.update.problem.parameters)
    ]
    rows.append(("cost", *(f"{s.cost:.3g}" for s in found)))
    rows.append(("damper", *("locked" if s.locked_damper else "free" for s in found)))
    heads = ("", *(f"solution {i}" for i in range(1, len(found) + 1)))
    return Table("Which solutions are there?", heads, tuple(rows))


def paths_table(seen: CostLandscape) -> Table:
    """Return the start and end of every search."""
    parameters = seen.update.problem.parameters
    rows = []
    for i, path in enumerate(seen.paths, start=1):
        start = ", ".join(
            f"{p.name} {quantity(float(value), p.unit, digits=3)}"
            for p, value in zip(parameters, path.points[0], strict=True)
        )
        fate = path.fate if path.solution is None else f"solution {path.solution + 1}"
        costs = (f"{value:.3g}" for value in (path.cost[0], path.end_cost))
        rows.append((str(i), start, fate, *costs, str(len(path.cost))))
    caption = (
        f"Where does the search from each starting point end ({seen.method})? On a plateau the model is far "
        "from the data and no parameter changes that; where a search stalled, the cost can still decrease."
    )
    heads = ("path", "starts at", "ends at", "cost at its start", "at its end", "evaluations")
    return Table(caption, heads, tuple(rows), text_columns=3)


def _sensitivity(found: Exploration) -> tuple[Block, ...]:
    s = found.sensitivity
    names = [p.name for p in s.parameters]
    drawn = figures.sensitivities(names, found.labels, s.frequency, s.damping)
    return Plot("sensitivity", "Which parameter affects which mode?", drawn), sensitivity_table(found)


def sensitivity_table(found: Exploration) -> Table:
    """Return the modes at the explored point and their derivatives, one row per parameter."""
    s = found.sensitivity
    rows = []
    for i, label in enumerate(found.labels):
        mode = (
            words(label),
            frequency(float(s.frequency_hz[i])),
            percent(float(s.damping_ratio[i]), decimals=3),
        )
        for j, p in enumerate(s.parameters):
            by = (cell(float(s.frequency[i, j]), "+.4f"), cell(100.0 * float(s.damping[i, j]), "+.3f"))
            rows.append((*(mode if j == 0 else ("", "", "")), p.name, *by))
    caption = (
        "How much does each parameter affect each mode? Analytical derivatives; central differences deviate "
        f"by at most {s.difference:.1g}."
    )
    heads = ("mode", "f [Hz]", "ζ [%]", "parameter θ", "∂ ln f/∂ ln θ [-]", "∂ζ/∂ ln θ [%]")
    return Table(caption, heads, tuple(rows))


def _locus(found: Exploration, locus: Locus) -> tuple[Block, ...]:
    p = locus.parameter
    several = p.name not in [one.name for one in found.model.parameters]
    together = (
        " The parameters of all tie groups vary by one factor; that of the first is shown." if several else ""
    )
    low, high = (quantity(value, p.unit, digits=3) for value in (p.low, p.high))
    caption = (
        f"Where do the poles go as {p.name} varies from {low} to {high}? "
        f"Each branch is tracked from the explored point.{together}"
    )
    name = f"root_locus_{p.name}"
    return Plot(name, caption, figures.root_locus(locus, found.labels)), locus_table(found, locus)


def locus_table(found: Exploration, locus: Locus) -> Table:
    """Return the ends of every branch, and its point of largest damping."""
    rows = []
    for i, (mode, label) in enumerate(zip(locus.modes, found.labels, strict=True)):
        f, zeta = locus.frequency_hz[:, i], locus.damping_ratio[:, i]
        value, most = locus.most_damped(i)
        lost = np.flatnonzero(np.isnan(f))
        rows.append(
            (
                words(label),
                str(mode),
                *(text for k in (0, locus.origin, -1) for text in (frequency(f[k]), percent(zeta[k]))),
                percent(most),
                quantity(value, locus.parameter.unit, digits=3),
                "" if not lost.size else f"no oscillation in {lost.size} of {f.size} points",
            )
        )
    name = locus.parameter.name
    heads = ["mode", "no."]
    for where in ("lower end", "here", "upper end"):
        heads += [f"{where}: f [Hz]", "ζ [%]"]
    heads += ["largest damping [%]", f"at {name}", ""]
    caption = f"How far can {name} change each mode, and how much damping can it add?"
    return Table(caption, tuple(heads), tuple(rows))
