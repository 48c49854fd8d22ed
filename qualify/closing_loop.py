"""Close the loop: simulated records of a known asset, identified and updated; intervals against its truth.

Writes docs/verification/closing_loop.md. Ten groups of three records give ten updates, all thirty one more.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from jackettwin.simulate.batch import record_path, run_set
from jackettwin.simulate.sets import read_set
from jackettwin.twin import TwinResult, read_twin, run_twin
from jackettwin.twin.truth import true_modes, true_parameters

RECORDS, GROUP = 30, 3
SET = f"{{scenario: known_feet, bins: [{{speed_m_s: 12, hs_m: 2.0, tp_s: 8.0}}], seeds: {RECORDS}}}"
PAGE = Path(__file__).parents[1] / "docs" / "verification" / "closing_loop.md"


def updated(paths: list[Path]) -> TwinResult:
    return run_twin(replace(read_twin("simulated"), records=tuple(paths), targets=()))


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "set.yaml").write_text(SET, encoding="utf-8")
        chosen = read_set(folder / "set.yaml")
        run_set(chosen, folder)
        paths = [record_path(case, folder) for case in chosen.cases]
        groups = [updated(paths[i : i + GROUP]) for i in range(0, RECORDS, GROUP)]
        whole = updated(paths)
    lines = ["# Closing the loop", "", *introduction(), *parameters(groups, whole), "", *modes(whole)]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(PAGE.read_text(encoding="utf-8"))


def introduction() -> list[str]:
    return [
        f"Scenario `known_feet`: Kelvin–Voigt feet, parked rotor at 12 m/s, Hs 2 m; {RECORDS} records",
        "of ten minutes; twin `simulated`. `make qualify` writes this page.",
        "",
    ]


def parameters(groups: list[TwinResult], whole: TwinResult) -> list[str]:
    inside = f"groups of {GROUP} whose interval holds it"
    lines = [f"| parameter | true | all {RECORDS} | 90 % interval | {inside} |", "|---|---|---|---|---|"]
    for k, p in enumerate(true_parameters(whole)):
        held = sum(bool(true_parameters(g)[k].covered) for g in groups)
        low, high = p.interval_90 or (float("nan"),) * 2
        row = [
            p.name,
            f"{p.true:.4g}",
            f"{p.value:.4g}",
            f"{low:.4g} – {high:.4g}",
            f"{held} of {len(groups)}",
        ]
        lines.append(f"| {' | '.join(row)} |")
    return lines


def modes(whole: TwinResult) -> list[str]:
    heads = ["mode", "true f [Hz]", "measured", "updated", "true ζ [%]", "measured", "updated"]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    place = {m.label: i for i, m in enumerate(whole.measured)}
    for true in true_modes(whole):
        i = place[true.label]
        m, u = whole.measured[i], whole.updates[0].modes
        f, zeta, std = m.frequency_hz or 0.0, m.damping_ratio or 0.0, m.damping_ratio_std or 0.0
        row = [true.label, f"{true.frequency_hz:.4f}", f"{f:.4f}", f"{u.frequency_hz[i]:.4f}"]
        row += [f"{100 * true.damping_ratio:.2f}", f"{100 * zeta:.2f} ± {100 * std:.2f}"]
        lines.append(f"| {' | '.join([*row, f'{100 * u.damping_ratio[i]:.2f}'])} |")
    return lines


if __name__ == "__main__":
    main()
