"""Close the loop: simulated records of a known asset, identified and updated; intervals against its truth.

Writes docs/verification/closing_loop.md. Five groups of six records give five updates, all thirty one more.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from jackettwin.simulate.batch import record_path, run_set
from jackettwin.simulate.sets import read_set
from jackettwin.twin import TwinResult, read_twin, run_twin
from jackettwin.twin.truth import TrueMode, true_modes, true_parameters

RECORDS, GROUP = 30, 6
SET = f"{{scenario: known_feet, bins: [{{speed_m_s: 12, hs_m: 2.0, tp_s: 8.0}}], seeds: {RECORDS}}}"
PAGE = Path(__file__).parents[1] / "docs" / "verification" / "closing_loop.md"
SOURCES = {"structure": ("structure",), "soil": ("soil",), "rotor": ("rotor", "water")}
"""What an update calls rotor is all that damps at the nacelle: drag of tower and water with it."""

Interval = tuple[float, float]


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(name)
        folder.mkdir(exist_ok=True)
        (folder / "set.yaml").write_text(SET, encoding="utf-8")
        chosen = read_set(folder / "set.yaml")
        run_set(chosen, folder)
        paths = [record_path(case, folder) for case in chosen.cases]
        groups = [updated(paths[i : i + GROUP]) for i in range(0, RECORDS, GROUP)]
        whole = updated(paths)
    lines = ["# Closing the loop", "", *introduction(), *parameters(groups, whole), "", *modes(whole)]
    lines += ["", *budget(groups, whole)]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(PAGE.read_text(encoding="utf-8"))


def updated(paths: list[Path]) -> TwinResult:
    return run_twin(replace(read_twin("simulated"), records=tuple(paths), targets=()))


def introduction() -> list[str]:
    return [
        f"Scenario `known_feet`: Kelvin–Voigt feet, parked rotor at 12 m/s, Hs 2 m; {RECORDS} records of ten",
        "minutes; twin `simulated`. Intervals are the update's own 90 %. `make qualify` writes this page.",
        "",
    ]


def parameters(groups: list[TwinResult], whole: TwinResult) -> list[str]:
    lines = [
        f"| parameter | true | all {RECORDS} | interval | groups of {GROUP} whose interval holds it |",
        "|---|---|---|---|---|",
    ]
    for k, p in enumerate(true_parameters(whole)):
        held = sum(bool(true_parameters(g)[k].covered) for g in groups)
        low, high = p.interval_90 or (float("nan"),) * 2
        row = [p.name, f"{p.true:.4g}", f"{p.value:.4g}", f"{low:.4g} – {high:.4g}"]
        lines.append(f"| {' | '.join([*row, f'{held} of {len(groups)}'])} |")
    return lines


def modes(whole: TwinResult) -> list[str]:
    heads = ["mode", "true f [Hz]", "measured", "updated", "true ζ [%]", "measured", "updated"]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    place = {m.label: i for i, m in enumerate(whole.measured)}
    for true in true_modes(whole):
        i = place[true.label]
        m, u = whole.measured[i], whole.updates[0].modes
        f, f_std = m.frequency_hz or 0.0, m.frequency_std_hz or 0.0
        zeta, std = m.damping_ratio or 0.0, m.damping_ratio_std or 0.0
        row = [true.label, f"{true.frequency_hz:.4f}", f"{f:.4f} ± {f_std:.4f}", f"{u.frequency_hz[i]:.4f}"]
        row += [f"{100 * true.damping_ratio:.2f}", f"{100 * zeta:.2f} ± {100 * std:.2f}"]
        lines.append(f"| {' | '.join([*row, f'{100 * u.damping_ratio[i]:.2f}'])} |")
    return lines


def budget(groups: list[TwinResult], whole: TwinResult) -> list[str]:
    heads = ["mode", "source", "true ζ [%]", f"all {RECORDS}", "interval", f"groups of {GROUP} that hold it"]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for true in true_modes(whole):
        for k, source in enumerate(SOURCES):
            truth, found = share(true, source), part(whole, true.label, k)
            if found is None or source == "structure":
                continue
            value, (low, high) = found
            held = sum(holds(part(g, true.label, k), share_in(g, true.label, source)) for g in groups)
            row = [true.label, source, f"{100 * truth:.2f}", f"{100 * value:.2f}"]
            row += [f"{100 * low:.2f} – {100 * high:.2f}", f"{held} of {len(groups)}"]
            lines.append(f"| {' | '.join(row)} |")
    return lines


def share(true: TrueMode, source: str) -> float:
    return sum(true.damping_by_source[name] for name in SOURCES[source])


def share_in(result: TwinResult, label: str, source: str) -> float | None:
    found = [t for t in true_modes(result) if t.label == label]
    return share(found[0], source) if found else None


def part(result: TwinResult, label: str, k: int) -> tuple[float, Interval] | None:
    """Return a source's damping ratio of a mode and its interval; None if the update lacks it."""
    row = [i for i, m in enumerate(result.measured) if m.label == label]
    found = result.updates[0].budget
    if not row or found.damping_ratio_interval_90 is None:
        return None
    low, high = found.damping_ratio_interval_90[row[0], k]
    return float(found.damping_ratio[row[0], k]), (float(low), float(high))


def holds(found: tuple[float, Interval] | None, truth: float | None) -> bool:
    return found is not None and truth is not None and found[1][0] <= truth <= found[1][1]


if __name__ == "__main__":
    main()
