"""``jackettwin update``: the supports of a twin under one law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import click
import numpy as np

from jackettwin.cli.cache import keeping
from jackettwin.cli.console import Reply, answers, numbers_of, output, progress, say, say_all, show_table
from jackettwin.errors import InputError, require
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.report import Table, cell, words

if TYPE_CHECKING:
    from jackettwin.study import DampingExcess, MeasuredMode, TwinResult
    from jackettwin.updating import Update


DEFAULT_TWIN = "openfast_pile"


@click.command("update")
@click.argument("twin", default=DEFAULT_TWIN)
@click.option(
    "--law",
    help="Only this law; prony: with as many branches as the data support; default: the first of the twin "
    "file.",
)
@click.option("--all-laws", is_flag=True, help="Fit every law of the twin file and rank them.")
@click.option(
    "--start",
    "points",
    multiple=True,
    metavar="NAME=VALUE,…",
    help="A starting point of the search, e.g. k=2.5e9,c=7.6e8; may be repeated.",
)
@click.option("--fresh", is_flag=True, help="Ignore stored identifications and fits of earlier runs.")
@answers
def update_command(twin: str, law: str | None, all_laws: bool, points: tuple[str, ...], fresh: bool) -> Reply:
    """Update TWIN's supports under one law or all; writes nothing."""
    from jackettwin.soil import family, members
    from jackettwin.study import count_steps, ranking_document, run_twin, update_document
    from jackettwin.twin import read_twin

    config = read_twin(twin)
    if law is not None:
        for name in members([law]):
            family(name, field="--law")
    require(law is None or not all_laws, "one law or all", field="--law", value=law, remedy="leave one out")
    if points:
        config = replace(
            config, update=config.update.model_copy(update={"starts": tuple(map(_point, points))})
        )
    laws = config.update.laws if all_laws else (law or config.update.laws[0],)
    with progress(count_steps(config, laws), config.name) as step:
        result = run_twin(config, laws=laws, progress=step, keep=keeping(fresh=fresh))
    if points and not any(u.search.begun for u in result.updates):
        raise InputError(
            "a starting point has no parameter of the law",
            field="--start",
            value=points[0],
            allowed=", ".join(p.name for p in result.updates[0].problem.parameters),
        )
    document = update_document(result, 0)
    if all_laws:
        document = {
            "law_ranking": ranking_document(result.updates),
            "updates": [update_document(result, i) for i in range(len(result.updates))],
        }
    return Reply(document, lambda: print_updates(result))


def _point(text: str) -> dict[str, float]:
    """Return the point of ``--start NAME=VALUE,…``."""
    point = {}
    for part in text.split(","):
        name, _, value = part.partition("=")
        (number,) = numbers_of(value, "--start", "NAME=VALUE,…", (1,), given=text)
        require(number > 0.0, "not positive", field="--start", value=part, allowed="> 0")
        point[name.strip()] = number
    return point


def print_updates(result: TwinResult, *, only: str = "") -> None:
    """Print parameters and modes of all laws or one, unexplained damping, and warnings."""
    from jackettwin.study import series_sentence

    fitted = {m.label for m in result.measured if m.fits_frequency}
    if chosen := series_sentence(result):
        output.print(f"  {chosen}")
    for u, excess in zip(result.updates, result.excess, strict=True):
        if only and u.law != only:
            continue
        output.print(f"\n[bold]{u.law}[/bold]")
        show_table(_parameters(u))
        show_table(_modes(result.measured, u))
        if len(u.solutions) > 1 or u.best.locked_damper or u.best.locks_within:
            show_table(_solutions(u))
        if u.search.begun:
            show_table(_begun(u))
        for line in (u.search.statement, *_status(u), *_relaxations(result, u), *_leg_scatter(u)):
            say(f"  {line}")
        for e in excess:
            if e.label in fitted and not e.explained:
                say(f"  {words(e.label)}: {_unexplained(e)}")
    output.print()
    if len(result.updates) > 1 and not result.updates[0].problem.weighted:
        show_table(_ranking(result.updates))
    say_all(result.warnings, "warning")


def _ranking(updates: Sequence[Update]) -> Table:
    """Return all fitted laws by cost, with the damping of the shown modes."""
    from jackettwin.updating import ranked

    of = {u.law: u for u in updates}
    first = updates[0]
    rows = []
    for r in ranked(updates):
        zeta = (cell(100.0 * z, ".2f") for z in of[r.law].modes.damping_ratio)
        rows.append(
            (r.place, r.law, r.parameters, f"{r.cost:.3g}", r.solutions, *zeta, "locked" if r.locked else "")
        )
    cost = "cost (8.4)" if first.problem.relative else "χ²"
    modes = (f"ζ{mode} [%]" for mode in first.shown)
    return Table("", ("place", "law", "parameters", cost, "solutions", *modes, "damper"), rows)


def _begun(u: Update) -> Table:
    """Return the results of the searches from given points."""
    rows = [
        (
            ", ".join(f"{x:.3g}" for x in b.start),
            ", ".join(f"{x:.3g}" for x in b.end),
            f"{b.cost:.3g}",
            "" if b.settled else "stalled",
        )
        for b in u.search.begun
    ]
    names = ", ".join(p.name for p in u.problem.parameters)
    return Table("", (f"from ({names})", "to", "cost", ""), rows)


def _parameters(u: Update) -> Table:
    from jackettwin.answers import Span
    from jackettwin.report import span_words, value_words
    from jackettwin.soil import parameter_words

    rows = []
    for i, (p, best) in enumerate(zip(u.problem.parameters, u.best.theta, strict=True)):
        text, verdict = value_words(Span(float(best)), p.unit), "–"
        if u.uncertainty is not None:
            low, high = map(float, u.uncertainty.interval_90[i])
            text = span_words(Span(float(u.uncertainty.median[i]), low, high), p.unit)
            verdict = u.uncertainty.verdicts[i].verdict
        bound = ", on its bound" if p.name in u.best.at_bound else ""
        rows.append((parameter_words(p.name), p.name, text, verdict + bound))
    known = "best fit" if u.uncertainty is None else "median (90 % interval)"
    return Table("", ("parameter", "key", known, "verdict"), rows)


def _solutions(u: Update) -> Table:
    """Return every solution, best first."""
    rows = []
    for i, s in enumerate(u.solutions, start=1):
        locked = "locked" if s.locked_damper else "may lock" if s.locks_within else ""
        rows.append((i, *(f"{x:.3g}" for x in s.theta), f"{s.cost:.3g}", s.found, locked))
    names = (p.name for p in u.problem.parameters)
    return Table("", ("solution", *names, "cost", "starts", "damper"), rows)


def _status(u: Update) -> list[str]:
    """Return the reason for a missing posterior."""
    if u.uncertainty is None and u.problem.weighted:
        return [
            "The law was fitted without intervals: `jackettwin run --all-laws` samples the posterior of "
            "every law."
        ]
    if u.uncertainty is None:
        return ["There are no intervals, which need the standard deviation of every target."]
    if u.uncertainty.status == "ok":
        return []
    return [f"No posterior: {u.uncertainty.status}. The intervals are by Laplace's method."]


def _relaxations(result: TwinResult, u: Update) -> list[str]:
    """Return a line for each measured real pole with the model's nearest."""
    lines = []
    for r, rate in zip(result.relaxations, u.best.rates, strict=True):
        spread = "" if r.rate_std_rad_s is None else f" ± {NORMAL_90 * r.rate_std_rad_s:.2g} (90 %)"
        lines.append(
            f"real pole {r.name}: measured {r.rate_rad_s:.3g}{spread} 1/s, the model's {rate:.3g} 1/s"
        )
    return lines


def _leg_scatter(u: Update) -> list[str]:
    """Return a line for each parameter with the scatter between legs."""
    from jackettwin.updating import leg_scatter

    found = () if u.uncertainty is None else leg_scatter(u.problem.prior, u.uncertainty.log_theta)
    lines = []
    for s in found:
        low, middle, high = np.quantile(s.draws, QUANTILES)
        lines.append(
            f"{s.name} has a standard deviation of {middle:.2g} of its logarithm between the legs ({low:.2g} "
            f"… {high:.2g} in 90 %; prior {s.before[0]:.2g} … {s.before[1]:.2g})"
        )
    return lines


def _modes(measured: tuple[MeasuredMode, ...], u: Update) -> Table:
    columns = (measured, u.central_hz, u.central_undamped_hz, u.central_damping)
    rows = [
        (
            m.mode,
            words(m.label),
            _measured(m.frequency_hz, m.frequency_std_hz, 1.0, 4, m.fits_frequency),
            cell(f, ".4f"),
            cell(f0, ".4f"),
            _measured(m.damping_ratio, m.damping_ratio_std, 100.0, 2, m.fits_damping),
            cell(100 * zeta, ".2f"),
        )
        for m, f, f0, zeta in zip(*columns, strict=True)
    ]
    known = "best fit" if u.uncertainty is None else "median"
    heads = (
        "mode",
        "",
        "measured f, 90 % [Hz]",
        f"{known} f [Hz]",
        f"{known} undamped",
        "measured ζ, 90 % [%]",
        f"{known} ζ [%]",
    )
    return Table("", heads, rows)


def _measured(value: float | None, std: float | None, scale: float, decimals: int, fitted: bool) -> str:
    """Return value ± half the 90 % interval, in brackets if it was not fitted."""
    if value is None:
        return "–"
    text = " ± ".join(f"{scale * v:.{decimals}f}" for v in (value, std and NORMAL_90 * std) if v is not None)
    return text if fitted else f"({text})"


def _unexplained(e: DampingExcess) -> str:
    points = f"{100 * abs(e.excess):.2f} % of critical"
    if e.excess < 0.0:
        return f"{points} less than that of steel and soil in the model"
    if e.carried:
        return (
            f"{points} more than that of steel and soil in the model: the rotor's dashpot explains it "
            f"({100 * e.rotor:.2f} %)"
        )
    part = f", {100 * e.rotor:.2f} % of it by the rotor" if e.rotor > 0.1 * e.excess else ""
    return f"{points} more than that of steel and soil in the model{part}"
