"""The page on support laws: stored and lost energy, behaviour in time, and free vibration of a mass."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jackettwin.report.figures import law as figures
from jackettwin.report.pages.page import Block, PageSection, Plot, write_page
from jackettwin.report.table import Table
from jackettwin.report.tables.numbers import quantity, scientific
from jackettwin.response import FreeVibration
from jackettwin.soil import Law, LawCurves
from jackettwin.version import __version__


def write_law_page(
    laws: Mapping[str, Law],
    curves: Mapping[str, LawCurves],
    motions: Mapping[str, FreeVibration],
    frequency_hz: float,
    path: Path,
) -> Path:
    """Write one self-contained HTML file; return its path.

    Parameters
    ----------
    laws, curves : laws and their curves, by the text that the user gave
    motions : free vibration of a mass on each law; empty without a mass
    frequency_hz : frequency of the load cycle and of the numbers in the table

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    harmonic: tuple[Block, ...] = (
        law_table(laws, frequency_hz),
        Plot("moduli", "What does each law store and lose?", figures.moduli(curves), fits=True),
        Plot(
            "cycle",
            f"One load cycle at {frequency_hz:g} Hz: the enclosed area is the energy lost per cycle.",
            figures.cycle(laws, frequency_hz),
            fits=True,
        ),
    )
    after = "What is the response to a step? A dashpot in parallel adds an impulse at zero, not drawn."
    said = ", ".join(laws)
    sections = [
        PageSection("Harmonic motion", harmonic),
        PageSection("In time", (Plot("transients", after, figures.transients(curves), fits=True),)),
    ]
    if motions:
        question = "How does a mass on each law move after release from unit displacement?"
        drawn = Plot("let_go", question, figures.let_go(motions), fits=True)
        sections.append(PageSection("A mass on it", (motion_table(motions), drawn)))
    return write_page(sections, path, title="Support laws", subtitle=f"{said} · jackettwin {__version__}")


def law_table(laws: Mapping[str, Law], frequency_hz: float) -> Table:
    """Return storage and loss of each law at a frequency, and its static stiffness."""
    rows = []
    for name, law in laws.items():
        D = complex(law.stiffness(2j * np.pi * frequency_hz))
        eta = D.imag / D.real if D.real > 0.0 else float("nan")
        moduli = (quantity(one, "N/m", digits=3) for one in (law.static_stiffness, D.real, D.imag))
        rows.append((name, *moduli, scientific(eta)))
    heads = ("law", "at rest", "storage", "loss", "loss factor [-]")
    return Table(f"What does each law store and lose at {frequency_hz:g} Hz?", heads, tuple(rows))


def motion_table(motions: Mapping[str, FreeVibration]) -> Table:
    """Return poles and regime of a mass on each law."""
    rows = [
        (
            name,
            motion.regime,
            scientific(motion.frequency_hz),
            scientific(None if motion.damping_ratio is None else 100.0 * motion.damping_ratio),
            scientific(motion.logarithmic_decrement),
            ", ".join(f"{rate:.4g}" for rate in _rates(motion)) or "–",
        )
        for name, motion in motions.items()
    ]
    heads = ("law", "regime", "f [Hz]", "ζ [%]", "logarithmic decrement [-]", "real poles: rates [rad/s]")
    return Table("Does the mass oscillate?", heads, tuple(rows), text_columns=2)


def _rates(motion: FreeVibration) -> list[float]:
    """Return the rates of the real poles, with rounding errors relative to the fastest pole set to zero."""
    least = 1e-12 * float(np.abs(motion.poles).max())
    real = [float(-pole.real) for pole in motion.poles if pole.imag == 0.0]
    return [rate if abs(rate) > least else 0.0 for rate in real]
