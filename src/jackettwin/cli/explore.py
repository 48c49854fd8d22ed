"""``jackettwin explore``: effect of a support law's parameters on modes and cost."""

from __future__ import annotations

from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jackettwin.cli.cache import keeping
from jackettwin.cli.console import PageFile, Reply, answers, progress, say, show_table
from jackettwin.errors import InputError, require

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jackettwin.progress import Progress
    from jackettwin.study import Exploration, ExploreSettings

_OWN_STEPS = 3
"""Number of steps besides those of a run: the cost, the modes and the page."""


@click.command("explore")
@click.argument("twin")
@click.option("--law", help="Law of the twin's supports; default: the first of its file.")
@click.option(
    "--modes", metavar="1,2,4", help="Mode numbers on rigid feet; default: 1 to 5 and the measured ones."
)
@click.option(
    "--along", multiple=True, metavar="PARAMETER", help="Root locus along it; default: all; may be repeated."
)
@click.option("--over", metavar="P,Q", help="The two parameters of the cost surface; default: the first two.")
@click.option(
    "--grid",
    default=49,
    show_default=True,
    type=click.IntRange(5, 301),
    help="Points of the cost surface along each side.",
)
@click.option(
    "--starts",
    default=8,
    show_default=True,
    type=click.IntRange(0, 1000),
    help="Starts of the search to show.",
)
@click.option(
    "--start",
    "points",
    multiple=True,
    metavar="P=VALUE,…",
    help="A further starting point to show; may be repeated.",
)
@click.option(
    "--method",
    default="least-squares",
    show_default=True,
    type=click.Choice(["least-squares", "nelder-mead"]),
    help="Method of the paths: that of the update, or the thesis's simplex.",
)
@click.option("--at", metavar="P=VALUE,…", help="Explore this point; default: the best solution.")
@click.option("--support", metavar="LAW:…", help="Take TWIN as a structure on this law; shows modes only.")
@click.option("--rayleigh", metavar="ZETA,F_HZ", help="Rayleigh damping of that structure's steel.")
@click.option(
    "--out", type=PageFile(), help="The page, in a folder that exists; default out/NAME_explore.html."
)
@click.option("--fresh", is_flag=True, help="Ignore stored identifications and fits of earlier runs.")
@answers
def explore_command(
    twin: str,
    law: str | None,
    modes: str | None,
    along: tuple[str, ...],
    over: str | None,
    grid: int,
    starts: int,
    points: tuple[str, ...],
    method: str,
    at: str | None,
    support: str | None,
    rayleigh: str | None,
    out: Path | None,
    fresh: bool,
) -> Reply:
    """Show the effect of TWIN's law parameters on modes and cost.

    The page shows the cost surface, root loci, sensitivities, and the path of the search from every starting
    point. TWIN is a shipped name or a YAML file, or a structure if --support gives its law.
    """
    from jackettwin.study import ExploreSettings, exploration_document

    settings = ExploreSettings(
        modes=() if modes is None else _modes(modes),
        along=along,
        over=() if over is None else _two(over),
        grid=grid,
        starts=starts,
        points=tuple(_values(text, "--start") for text in points),
        method="least-squares" if method == "least-squares" else "nelder-mead",
        at={} if at is None else _values(at, "--at"),
    )
    if support is None:
        require(rayleigh is None, "applies to a structure", field="--rayleigh", remedy="also give --support")
        found, path = _of_twin(twin, law, settings, out, fresh)
    else:
        for option, given in (("--law", law), ("--at", at), ("--over", over), ("--start", points or None)):
            require(given is None, "applies to a twin", field=option, remedy="omit it or --support")
        found, path = _of_structure(twin, support, rayleigh, settings, out)
    document = {**exploration_document(found), "page": str(path)}
    return Reply(document, lambda: _show(found, path))


def _of_twin(
    twin: str, law: str | None, settings: ExploreSettings, out: Path | None, fresh: bool
) -> tuple[Exploration, Path]:
    from jackettwin.soil import family
    from jackettwin.study import count_steps, explore
    from jackettwin.twin import read_twin

    with _said_of_structures(twin):
        config = read_twin(twin)
    if law is not None:
        family(law, field="--law")
    steps = count_steps(config, (law or config.update.laws[0],)) + _OWN_STEPS
    with progress(steps, config.name) as step:
        found = explore(config, settings, law=law, progress=step, keep=keeping(fresh=fresh))
        return found, _page(found, out, step)


@contextmanager
def _said_of_structures(name: str) -> Iterator[None]:
    """Add to the error for a structure in place of a twin how to explore it."""
    try:
        yield
    except InputError:
        from jackettwin.decks import read_structure

        try:
            read_structure(name)
        except InputError:
            is_structure = False
        else:
            is_structure = True
        remedy = "name its law: --support kelvin-voigt:k=…,c=…"
        require(not is_structure, "is a structure, not a twin", field="TWIN", value=name, remedy=remedy)
        raise


def _of_structure(
    name: str, support: str, rayleigh: str | None, settings: ExploreSettings, out: Path | None
) -> tuple[Exploration, Path]:
    from jackettwin.cli.modes import rayleigh_option
    from jackettwin.decks import read_structure
    from jackettwin.soil import MUDLINE, read_family, tied_at_mudline
    from jackettwin.structure import assemble
    from jackettwin.study import explore_model
    from jackettwin.updating import support_model

    family, theta, at_mudline = read_family(support)
    steel = rayleigh_option(rayleigh)
    with progress(_OWN_STEPS, name) as step:
        step("assemble the structure")
        structure = read_structure(name)
        assembly = assemble(tied_at_mudline(structure) if at_mudline else structure)
        tie = MUDLINE if at_mudline else "all"
        model = support_model(assembly, family=family, rayleigh=steel, tie=tie, highest_mode=5)
        step("modes along the parameters")
        found = explore_model(assembly.structure.name, model, theta, settings)
        return found, _page(found, out, step)


def _page(found: Exploration, out: Path | None, step: Progress) -> Path:
    step("page")
    # importing the plots takes a second, so only when needed
    from jackettwin.report.pages.explore import write_explore_page

    return write_explore_page(found, out or Path("out") / f"{found.name}_explore.html")


def _modes(text: str) -> tuple[int, ...]:
    parts = text.split(",")
    known = all(part.strip().isdigit() and int(part) > 0 for part in parts)
    require(
        known, "are numbers from 1", field="--modes", value=text, allowed="numbers joined by commas, as 1,2,4"
    )
    return tuple(dict.fromkeys(int(part) for part in parts))


def _two(text: str) -> tuple[str, str]:
    names = [name.strip() for name in text.split(",")]
    require(len(names) == 2, "not two parameters", field="--over", value=text, allowed="two names, as k,c")
    return names[0], names[1]


def _values(text: str, option: str) -> Mapping[str, float]:
    """Return the values of ``k=2.5e9,c=7e8``."""
    form = "values joined by commas, as k=2.5e9,c=7e8"
    found: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (piece.strip() for piece in part.partition("="))
        require(name not in found, "a parameter is given twice", field=option, value=text)
        try:
            found[name] = float(value)
        except ValueError:
            raise InputError("not a value", field=option, value=text, allowed=form) from None
        require(isfinite(found[name]), "not a finite number", field=option, value=text, allowed=form)
    return found


def _show(found: Exploration, path: Path) -> None:
    from jackettwin.report.pages.explore import locus_table, paths_table, sensitivity_table, solutions_table

    say(f"{found.name}, {found.model.family.name}")
    if found.landscape is not None:
        say(found.landscape.update.search.statement)
        show_table(solutions_table(found.landscape))
        if found.landscape.paths:
            show_table(paths_table(found.landscape))
    show_table(sensitivity_table(found))
    for locus in found.loci:
        show_table(locus_table(found, locus))
    say(f"wrote {path}")
