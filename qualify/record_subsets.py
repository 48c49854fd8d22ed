"""The shipped OpenFAST pile records, a few at a time: the truths must be inside whatever a user brings.

Usage: python qualify/record_subsets.py
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
from common.cases import Result, cases
from common.command import arguments
from common.page import write_page

from jackettwin.study import run_twin
from jackettwin.study.truth import true_modes
from jackettwin.twin import read_twin
from jackettwin.updating.budget import SOURCES

STIFFNESS = 4.1e9
"""k_v of the pile heads: √(k EA)·(tanh λL + κ)/(1 + κ tanh λL), κ = tip/√(k EA) [N/m]."""
CALM = {"side_side_1": 0.0057, "fore_aft_1": 0.0057}
"""Damping ratios without wind (README of the records): what more there is, is the rotor's."""


def subsets(records: tuple[Path, ...]) -> list[tuple[Path, ...]]:
    """Return each record alone, some pairs, all but each, and all."""
    n = len(records)
    pairs = list(combinations(records, 2))[::3]
    return [*((r,) for r in records), *pairs, *combinations(records, n - 1), records]


def subset(chosen: tuple[Path, ...]) -> Result:
    """Return the 90 % intervals of the default law beside the truths."""
    start = time.process_time()
    result = run_twin(replace(read_twin("openfast_pile"), records=chosen), laws=("maxwell-3",))
    update, true = result.updates[0], {m.label: m.damping_ratio for m in true_modes(result)}
    names = [p.name for p in update.problem.parameters]
    assert update.uncertainty is not None and update.budget.damping_ratio_interval_90 is not None
    k = update.uncertainty.interval_90[names.index("k_vertical")]
    rotor = update.budget.damping_ratio_interval_90[:, SOURCES.index("rotor")]
    sources = {
        m.label: [true[m.label] - CALM[m.label], *map(float, interval)]
        for m, interval in zip(result.measured, rotor, strict=True)
        if m.label in CALM
    }
    return {
        "records": [path.stem.removeprefix("pile_") for path in chosen],
        "k": [STIFFNESS, *map(float, k)],
        "cpu_s": time.process_time() - start,
        **sources,
    }


def cell(values: list[float] | None, scale: float, digits: int) -> tuple[str, bool | None]:
    """Return truth and interval as text, and whether it is inside."""
    if values is None or not np.isfinite(values).all():
        return "not seen", None
    true, low, high = (scale * v for v in values)
    inside = low <= true <= high
    text = f"{true:.{digits}f}: {low:.{digits}f}–{high:.{digits}f}"
    return text if inside else f"**{text}**", inside


def main() -> None:
    arguments(__doc__)
    chosen = subsets(read_twin("openfast_pile").records)
    found = cases("record_subsets", len(chosen), lambda case: subset(chosen[case]), whole=True)
    columns = (("k", 1e-9, 1), ("side_side_1", 100.0, 2), ("fore_aft_1", 100.0, 2))
    rows, inside = [], {name: [] for name, _, _ in columns}
    for r in found:
        cells = []
        for name, scale, digits in columns:
            text, held = cell(r.get(name), scale, digits)
            cells.append(text)
            inside[name].append(held)
        rows.append(f"| {', '.join(r['records'])} | {' | '.join(cells)} |")
    counts = [
        f"{sum(h is True for h in held)} of {sum(h is not None for h in held)}" for held in inside.values()
    ]
    write_page(
        "record_subsets",
        [
            "# Subsets of the OpenFAST records",
            "",
            "`python qualify/record_subsets.py`: `jackettwin run openfast_pile` under the default law with",
            "some of its records. True value and 90 % interval; bold if it is outside. Subsets share",
            "records, so that their errors are not independent.",
            "",
            "| records | k_v [GN/m] | rotor's part of side-side 1 [%] | of fore-aft 1 [%] |",
            "|---|---|---|---|",
            *rows,
            f"| inside | {' | '.join(counts)} |",
        ],
    )


if __name__ == "__main__":
    main()
