"""``jackettwin law``: storage, loss and time response of support laws."""

from __future__ import annotations

import csv
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.cli.console import FiniteFloat, PageFile, Reply, answers, numbers_of, say, show_table, working
from jackettwin.errors import require

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jackettwin.response import FreeVibration
    from jackettwin.soil import Law, LawCurves


@click.command("law")
@click.argument("laws", nargs=-1, required=True, metavar="NAME:k=…")
@click.option(
    "--band-hz", default="0.01,10", show_default=True, metavar="LOW,HIGH", help="Frequencies of the curves."
)
@click.option(
    "--frequency-hz",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Frequency of the table and of the load cycle; default: the middle of the band.",
)
@click.option(
    "--mass",
    "mass_kg",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Also compute the free vibration of a mass [kg] on each law.",
)
@click.option(
    "--csv", "table", type=click.Path(dir_okay=False, path_type=Path), help="The curves as a table."
)
@click.option("--out", type=PageFile(), help="The page, in a folder that exists; default out/law.html.")
@answers
def law_command(
    laws: tuple[str, ...],
    band_hz: str,
    frequency_hz: float | None,
    mass_kg: float | None,
    table: Path | None,
    out: Path | None,
) -> Reply:
    """Draw creep, relaxation, storage and loss of support laws.

    Each NAME:k=… has the form of --support, e.g. springpot:k=3e9,alpha=0.1,f0=0.18; a page shows all laws.
    """
    from jackettwin.soil import law_curves, read_law

    low, high = numbers_of(band_hz, "--band-hz", "LOW,HIGH", (2,))
    allowed = "0 < LOW < HIGH"
    require(0.0 < low < high, "is no band", field="--band-hz", value=band_hz, allowed=allowed)
    if table is not None:
        there = table.absolute().parent.is_dir()
        require(there, "there is no such folder", field="--csv", value=str(table), remedy="create it first")
    at = sqrt(low * high) if frequency_hz is None else frequency_hz
    read = {text: read_law(text) for text in laws}
    with working("curves of the laws"):
        curves = {text: law_curves(law, low, high) for text, law in read.items()}
        motions = {} if mass_kg is None else _let_go(mass_kg, read)
        # importing the plots takes a second, so only when needed
        from jackettwin.report.pages.law import law_table, motion_table, write_law_page

        path = write_law_page(read, curves, motions, at, out or Path("out") / "law.html")
        if table is not None:
            _write_csv(curves, table)

    def show() -> None:
        show_table(law_table(read, at))
        if motions:
            show_table(motion_table(motions))
        say(f"wrote {path}" + ("" if table is None else f" and {table}"))

    document = {
        "laws": [{"law": name, **_curves(one), **_motion(motions.get(name))} for name, one in curves.items()],
        "mass_kg": mass_kg,
        "page": str(path),
    }
    return Reply(document, show)


def _let_go(mass_kg: float, laws: Mapping[str, Law]) -> dict[str, FreeVibration]:
    """Return the free vibration on each law, for five cycles of the slowest."""
    from jackettwin.response import free_vibration

    own = [free_vibration(mass_kg, law).time_s[-1] for law in laws.values()]
    return {name: free_vibration(mass_kg, law, duration_s=max(own)) for name, law in laws.items()}


def _curves(law: LawCurves) -> dict[str, Any]:
    return {
        "frequency_hz": law.frequency_hz,
        "storage_n_m": law.stiffness.real,
        "loss_n_m": law.stiffness.imag,
        "loss_factor": law.loss_factor,
        "time_s": law.time_s,
        "creep_m_n": law.creep,
        "relaxation_n_m": law.relaxation,
    }


def _motion(motion: FreeVibration | None) -> dict[str, Any]:
    if motion is None:
        return {}
    return {
        "free_vibration": {
            "regime": motion.regime,
            "frequency_hz": motion.frequency_hz,
            "damping_ratio": motion.damping_ratio,
            "logarithmic_decrement": motion.logarithmic_decrement,
            "pole_real_rad_s": motion.poles.real,
            "pole_imag_rad_s": motion.poles.imag,
            "time_s": motion.time_s,
            "displacement": motion.displacement,
        }
    }


def _write_csv(curves: Mapping[str, LawCurves], path: Path) -> None:
    """Write every curve of every law, a row for each frequency and its time 1/2πf."""
    from jackettwin.files import atomic_path

    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        names = tuple(_curves(next(iter(curves.values()))))
        rows.writerow(("law", *names))
        for law, one in curves.items():
            columns = np.array(list(_curves(one).values()), dtype=float)
            rows.writerows((law, *(repr(float(v)) for v in row)) for row in columns.T)
