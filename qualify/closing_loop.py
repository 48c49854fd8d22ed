"""Close the loop: simulated records of a known asset, identified and updated; intervals against its truth.

Writes docs/verification/closing_loop.md: ten updates, each from six records of its own.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from common.command import arguments

from jackettwin.simulate.batch import record_path, run_set
from jackettwin.simulate.scenario.sets import read_set
from jackettwin.study import TwinResult, run_twin
from jackettwin.study.truth import StatedMode, true_modes, true_parameters
from jackettwin.twin import read_twin

GROUPS, GROUP = 10, 6
SET = f"{{scenario: known_feet, bins: [{{speed_m_s: 12, hs_m: 2.0, tp_s: 8.0}}], seeds: {GROUPS * GROUP}}}"
PAGE = Path(__file__).parents[1] / "docs" / "verification" / "closing_loop.md"
SOURCES = {"structure": ("structure",), "soil": ("soil",), "rotor": ("rotor", "water")}
"""What an update calls rotor is all that damps at the nacelle: drag of tower and water with it."""


@dataclass(frozen=True)
class Found:
    """A number that is known, as one update has it.

    Attributes
    ----------
    low, high : of the update's 90 % interval, None if it has none
    """

    name: str
    true: float
    value: float
    low: float | None = None
    high: float | None = None

    @property
    def held(self) -> bool:
        return self.low is not None and self.high is not None and self.low <= self.true <= self.high


@dataclass(frozen=True)
class Outcome:
    """What one update found: parameters, measured frequencies and damping, shares of damping."""

    parameters: tuple[Found, ...]
    frequency: tuple[Found, ...]
    damping: tuple[Found, ...]
    budget: tuple[Found, ...]


def main() -> None:
    given = arguments(__doc__, folder=None)
    with tempfile.TemporaryDirectory() as name:
        folder = given.folder or Path(name)
        folder.mkdir(exist_ok=True)
        (folder / "set.yaml").write_text(SET, encoding="utf-8")
        chosen = read_set(folder / "set.yaml")
        run_set(chosen, folder)
        paths = [record_path(case, folder) for case in chosen.cases]
        twin = read_twin("simulated")
        outcomes = []
        for first in range(0, len(paths), GROUP):
            records = tuple(paths[first : first + GROUP])
            outcomes.append(outcome(run_twin(replace(twin, records=records, targets=()))))
    write_page(outcomes)


def write_page(outcomes: Sequence[Outcome]) -> None:
    lines = [
        "# Closing the loop",
        "",
        "Scenario `known_feet`: Kelvin–Voigt feet, parked rotor at 12 m/s, Hs 2 m, records of ten minutes;",
        f"{len(outcomes)} updates of the twin `simulated`, each from {GROUP} separate records. *Found over",
        "true* is the mean over the updates and its standard error; *held* counts the updates whose 90 %",
        "interval contains the truth (nine of ten expected). Torsion is not used in the fit: its shares are",
        "predictions. `make qualify` writes this page;",
        "[the theory page](../theory/closing_loop.md) describes the method.",
        "",
        *table("parameter", [o.parameters for o in outcomes], "{:.3g}"),
        "",
        *table("measured frequency [Hz]", [o.frequency for o in outcomes], "{:.4f}"),
        "",
        *table("measured damping ratio", [o.damping for o in outcomes], "{:.4f}"),
        "",
        *table("damping ratio, share of", [o.budget for o in outcomes], "{:.4f}"),
    ]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(PAGE.read_text(encoding="utf-8"))


def table(title: str, columns: Sequence[tuple[Found, ...]], form: str) -> list[str]:
    """Return a table of numbers by name, over the updates that have them."""
    names = list(dict.fromkeys(found.name for column in columns for found in column))
    lines = [f"| {title} | true | found over true | held |", "|---|---|---|---|"]
    for name in names:
        found = [one for column in columns for one in column if one.name == name]
        ratio = np.array([one.value / one.true for one in found])
        error = ratio.std(ddof=1) / np.sqrt(ratio.size)
        true = form.format(np.mean([one.true for one in found]))
        held = f"{sum(one.held for one in found)} of {len(found)}"
        lines.append(f"| {name} | {true} | {ratio.mean():.4f} ± {error:.4f} | {held} |")
    return lines


def outcome(result: TwinResult) -> Outcome:
    """Return what an update found beside what is true."""
    parameters = tuple(
        Found(p.name, p.true, p.value, *(p.interval_90 or (None, None))) for p in true_parameters(result)
    )
    known = {true.label: true for true in true_modes(result)}
    frequency, damping = [], []
    for m in result.measured:
        true = known.get(m.label)
        if true is not None and m.frequency_hz and m.frequency_std_hz:
            frequency.append(normal(m.label, true.frequency_hz, m.frequency_hz, m.frequency_std_hz))
        if true is not None and m.damping_ratio and m.damping_ratio_std:
            damping.append(normal(m.label, true.damping_ratio, m.damping_ratio, m.damping_ratio_std))
    shares = [
        share(result, true, k)
        for true in known.values()
        for k, source in enumerate(SOURCES)
        if source != "structure"
    ]
    return Outcome(parameters, tuple(frequency), tuple(damping), tuple(s for s in shares if s is not None))


def normal(name: str, true: float, value: float, std: float) -> Found:
    return Found(name, true, value, value - 1.645 * std, value + 1.645 * std)


def share(result: TwinResult, true: StatedMode, k: int) -> Found | None:
    """Return a source's damping ratio of a mode; None if the update lacks it."""
    source, names = list(SOURCES.items())[k]
    row = [i for i, m in enumerate(result.measured) if m.label == true.label]
    budget = result.updates[0].budget
    if not row or budget.damping_ratio_interval_90 is None:
        return None
    low, high = (float(v) for v in budget.damping_ratio_interval_90[row[0], k])
    stated = sum(true.damping_by_source[name] for name in names)
    return Found(f"{true.label}, {source}", stated, float(budget.damping_ratio[row[0], k]), low, high)


if __name__ == "__main__":
    main()
