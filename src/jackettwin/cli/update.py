"""``jackettwin update``: the supports of a twin under one law."""

from __future__ import annotations

import click
from rich.table import Table

from jackettwin.cli.console import number, output, print_json, progress
from jackettwin.twin import DampingExcess, TwinResult, count_steps, read_twin, run_twin, update_document

DEFAULT_TWIN = "openfast_pile"


@click.command("update")
@click.argument("twin", default=DEFAULT_TWIN)
@click.option("--law", help="Only this law; default: the first of the twin file.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def update_command(twin: str, law: str | None, as_json: bool) -> None:
    """Update the supports of TWIN under one law; writes nothing."""
    config = read_twin(twin)
    laws = (law or config.update.laws[0],)
    with progress(count_steps(config, laws), config.name) as step:
        result = run_twin(config, laws=laws, step=step)
    if as_json:
        print_json(update_document(result, 0))
    else:
        print_updates(result)


def print_updates(result: TwinResult) -> None:
    """Print one table a law, then what no support explains and what to beware of."""
    for u, excess in zip(result.updates, result.excess, strict=True):
        values = ", ".join(
            f"{p.name} = {value:.3g} {p.unit}"
            for p, value in zip(u.model.parameters, u.best.theta, strict=True)
        )
        table = Table(
            "mode",
            "label",
            "measured f [Hz]",
            "f [Hz]",
            "undamped f [Hz]",
            "measured ζ [%]",
            "ζ [%]",
            title=f"{u.law}: {values}",
            title_justify="left",
        )
        for m, f, f0, zeta in zip(
            result.measured, u.modes.frequency_hz, u.modes.undamped_hz, u.modes.damping_ratio, strict=True
        ):
            table.add_row(
                str(m.mode),
                m.label,
                number(m.frequency_hz) + ("" if m.fits_frequency else " (not fitted)"),
                f"{f:.4f}",
                f"{f0:.4f}",
                number(None if m.damping_ratio is None else 100 * m.damping_ratio, 3)
                + ("" if m.fits_damping or m.damping_ratio is None else " (not fitted)"),
                f"{100 * zeta:.2f}",
            )
        output.print(table)
        fitted = {m.label for m in result.measured if m.fits_frequency}
        for e in excess:
            if e.label in fitted and not e.explained:
                output.print(f"  {e.label}: {_unexplained(e)}")
    for warning in result.warnings:
        output.print(f"warning: {warning}")


def _unexplained(e: DampingExcess) -> str:
    points = f"{100 * abs(e.excess):.2f} % of critical"
    if e.excess < 0.0:
        return f"{points} less than the model has: its steel damping is too high there"
    if e.carried:
        return f"{points} that no support can explain: the rotor's dashpot carries it ({100 * e.rotor:.2f} %)"
    part = f", {100 * e.rotor:.2f} % of it the rotor's" if e.rotor > 0.1 * e.excess else ""
    return f"{points} that no support can explain{part}"
