"""Random parameter sets over the whole bounds: condensed poles against the full model.

Writes docs/verification/condensed_poles.md. Bars: nothing missed, duplicated or spurious; 1e-8 relative in λ,
judged where the full model itself is that exact.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from jackettwin.errors import NumericalError
from jackettwin.response.certified import all_modes
from jackettwin.response.modal import damped_modes
from jackettwin.structure import Rayleigh, assemble, read_structure
from jackettwin.updating import SupportModel, family, support_model

REPORT = Path(__file__).parents[1] / "docs" / "verification" / "condensed_poles.md"
CASES = [
    ("kelvin-voigt", "all", 0.35),
    ("zener", "all", 0.35),
    ("zener", "horizontal-vertical", 0.1),
    ("maxwell-3", "all", 0.15),
    ("springpot", "all", 0.05),
]
"""Law, tie and its share of the sets (the full model of a springpot is the slowest)."""


@dataclass
class Tally:
    """What one case came to."""

    sets: int = 0
    uncertified: int = 0
    missed: int = 0
    surplus: int = 0
    real: int = 0
    oracle_failed: int = 0
    locked: int = 0
    error: list[float] = field(default_factory=list)


def run(model: SupportModel, n: int, rng: np.random.Generator) -> Tally:
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    tally = Tally()
    for theta in np.exp(low + (high - low) * rng.random((n, low.size))):
        points = model.points(theta[None])
        found = all_modes(model.condensed, points.rows[0], points.rayleigh[0])
        tally.sets += 1
        tally.uncertified += not found.certified
        try:
            exact = damped_modes(model.system(theta), below_hz=found.radius / (2.0 * np.pi))
        except NumericalError:
            tally.oracle_failed += 1
            continue
        count = exact.eigenvalues.size
        tally.missed += max(count - found.poles.size, 0)
        tally.surplus += max(found.poles.size - count, 0)
        if found.n_real is not None:
            tally.real += found.n_real != exact.real_poles.size
        if found.poles.size == count and count:
            tally.error.append(float(np.abs(found.poles / exact.eigenvalues - 1.0).max()))
            tally.locked += model.undamped_hz(theta, (1,))[0] < 0.95 * np.abs(found.poles[0]) / (2 * np.pi)
    return tally


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--sets", type=int, default=10_000)
    n = options.parse_args().sets
    assembly = assemble(read_structure("jacket15"))
    steel = Rayleigh.minimum(0.01, 0.1832)
    lines = [
        "# Condensed poles against the full model",
        "",
        f"{n} random parameter sets, log-uniform over the thesis's bounds (8.6)–(8.10), seed 1; jacket15,",
        "all poles with |λ|/2π below 0.86–0.95 Hz. `make qualify` writes this page.",
        "",
        "| law | tie | sets | locked | uncertified | missed | duplicated or spurious | real poles differ"
        " | full model failed | error median | 99 % | largest |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    rng = np.random.default_rng(1)
    for law, tie, share in CASES:
        model = support_model(assembly, family=family(law), rayleigh=steel, tie=tie, highest_mode=5)
        t = run(model, round(share * n), rng)
        median, high = np.quantile(t.error, [0.5, 0.99])
        lines.append(
            f"| {law} | {tie} | {t.sets} | {t.locked} | {t.uncertified} | {t.missed} | {t.surplus} "
            f"| {t.real} | {t.oracle_failed} | {median:.0e} | {high:.0e} | {max(t.error):.0e} |"
        )
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text("\n".join([*lines, ""]))


if __name__ == "__main__":
    main()
