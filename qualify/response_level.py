"""Levels of simulated acceleration beside those of records made by an independent aeroelastic program.

Writes docs/verification/response_level.md: the shipped OpenFAST records, and simulations of their assets in
wind of the same speed and class with the default settings.
"""

from __future__ import annotations

import tempfile
from importlib.resources import files
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml
from common.command import arguments
from common.page import write_page

from jackettwin.records import Record, read_record
from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.scenario.scenario import Scenario

FloatArray = npt.NDArray[np.float64]

DATA = Path(str(files("jackettwin") / "data"))
RECORDS = {
    "pile_U8_s302": ("parked", 8),
    "pile_U10_s304": ("parked", 10),
    "pile_U12_s301": ("parked", 12),
    "pile_U12_s308": ("parked", 12),
    "pile_U16_s303": ("parked", 16),
    "kv_U8_s312": ("known_feet", 8),
    "kv_U12_s311": ("known_feet", 12),
}
"""The shipped records with rigid blades: scenario of the same asset, and wind [m/s]."""
SEEDS = 12
BANDS = {
    "0.14–0.21 Hz, the first pair": (0.14, 0.21),
    "0.3–0.6 Hz, between the modes": (0.3, 0.6),
    "0.6–1.0 Hz, the second pair": (0.6, 1.0),
    "0.70–0.73 Hz, the lower flank of the second pair": (0.70, 0.73),
}
DIRECTIONS = {"fore-aft": "x", "side-side": "y"}
SECOND = {"fore-aft": "fore_aft_2", "side-side": "side_side_2"}


def main() -> None:
    arguments(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        simulated = {case: levels_of(Path(folder), *case) for case in dict.fromkeys(RECORDS.values())}
    levels = {case: found for case, (found, _) in simulated.items()}
    modes = {case: known for case, (_, known) in simulated.items()}
    write_page("response_level", [*introduction(), *tables(levels), "", *second_pair(modes)])


def power(record: Record) -> FloatArray:
    """Return the mean square of the acceleration at the tower top [cm²/s⁴], (bands, directions)."""
    rows = [record.data[record.channel_names.index(f"acc_top_{axis}")] for axis in DIRECTIONS.values()]
    f = np.fft.rfftfreq(rows[0].size, 1.0 / record.sample_rate_hz)
    spectra = [2.0 * np.abs(np.fft.rfft(row - row.mean())) ** 2 / row.size**2 for row in rows]
    return 1e4 * np.array(
        [[s[(f > low) & (f < high)].sum() for s in spectra] for low, high in BANDS.values()]
    )


def levels_of(folder: Path, scenario: str, speed: int) -> tuple[FloatArray, Record]:
    """Return the powers of some seeds, (seeds, bands, directions), and one of the records."""
    found = []
    for seed in range(SEEDS):
        # seeds of its own for every case: the same would err alike in all of them
        first = 100 * list(dict.fromkeys(RECORDS.values())).index((scenario, speed))
        record = simulate(case_of(folder, scenario, speed, 1000 + first + seed)).record
        found.append(power(record))
    return np.array(found), record


def case_of(folder: Path, scenario: str, speed: float, seed: int, **time: float) -> Scenario:
    """Return the records' asset in wind without waves; ``time`` changes the clock."""
    data = yaml.safe_load((DATA / "scenarios" / f"{scenario}.yaml").read_text(encoding="utf-8"))
    data = {key: value for key, value in data.items() if key not in ("waves", "water")}
    # 0.57 % of the first modes without wind, as the records' own linearised model has
    data["damping"] = {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.183}}
    data["time"] = {"duration_s": 600, "step_s": 0.05, **time}
    data["wind"] = {"speed_m_s": speed, "turbulence": "B", "seed": seed}
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return read_scenario(path)


def introduction() -> list[str]:
    return [
        "# Level of response",
        "",
        "Root mean square of the acceleration at the tower top [cm/s²]: the seven shipped OpenFAST records",
        f"with rigid blades, and {SEEDS} simulations of the same asset in wind of the same speed and class,",
        "with the default settings (`wind.coherence: u`, `grid_m: 19.1`, `tower_drag: 0.5`). The interval is",
        "what one record may show, by the scatter of the simulations' logarithms. The mean ratio is that of",
        "the powers: one record of a lightly damped mode has its power χ² distributed, and the mean of such",
        "logarithms lies below the logarithm of the mean (by 5 % of the level for ten degrees of freedom).",
        "`make qualify` writes this page.",
        "",
    ]


def tables(simulated: dict[tuple[str, int], FloatArray]) -> list[str]:
    lines = []
    for band, title in enumerate(BANDS):
        for side, name in enumerate(DIRECTIONS):
            lines += [
                f"**{title}, {name}**",
                "",
                "| record | OpenFAST | simulated | 90 % of records | ratio |",
            ]
            lines.append("|---|---|---|---|---|")
            shares, scatter = [], []
            for record, case in RECORDS.items():
                seen = np.sqrt(power(read_record(DATA / "records" / f"{record}.parquet"))[band, side])
                levels = simulated[case][:, band, side]
                level, spread = np.sqrt(levels.mean()), 0.5 * np.log(levels).std(ddof=1)
                shares.append((seen / level) ** 2)
                # records and simulations of one case are strangers: each has the scatter of its power
                scatter.append(levels.std(ddof=1) / levels.mean() * np.sqrt(1.0 + 1.0 / levels.size))
                low, high = level * np.exp(1.645 * spread * np.array([-1.0, 1.0]))
                lines.append(
                    f"| {record} | {seen:.2f} | {level:.2f} | {low:.2f}–{high:.2f} | {level / seen:.2f} |"
                )
            mean = 1.0 / np.sqrt(np.mean(shares))
            error = 0.5 * np.sqrt(np.mean(np.square(scatter)) / len(shares))
            lines += [f"| mean ratio | | | | **{mean:.2f}** ± {mean * error:.2f} |", ""]
    return lines[:-1]


def second_pair(simulated: dict[tuple[str, int], Record]) -> list[str]:
    """Return the second pair of both programs, and what its f and ζ alone make of the level."""
    bands = list(BANDS.items())[2:]
    lines = [
        "**The second pair itself**: the linear models of both programs, and the ratio of levels that",
        "f and ζ alone would make, one mode driven by the same white force.",
        "",
        "| record | | OpenFAST f [Hz], ζ [%] | simulated f [Hz], ζ [%] | "
        + " | ".join(name.partition(",")[0] for name, _ in bands)
        + " |",
        "|---|---|---|---|" + "---|" * len(bands),
    ]
    for record, case in RECORDS.items():
        known = read_record(DATA / "records" / f"{record}.parquet")
        for direction, label in SECOND.items():
            (f, zeta), (own_f, own_zeta) = (mode(one, label) for one in (known, simulated[case]))
            ratios = [
                np.sqrt(amplified(own_f, own_zeta, *limits) / amplified(f, zeta, *limits))
                for _, limits in bands
            ]
            lines.append(
                f"| {record} | {direction} | {f:.4f}, {100 * zeta:.2f} | {own_f:.4f}, {100 * own_zeta:.2f} | "
                + " | ".join(f"{ratio:.2f}" for ratio in ratios)
                + " |"
            )
    return lines


def mode(record: Record, label: str) -> tuple[float, float]:
    """Return f [Hz] and ζ of a mode that a record states as true."""
    one = next(mode for mode in record.metadata["true_modes"] if mode["label"] == label)
    return float(one["frequency_hz"]), float(one["damping_ratio"])


def amplified(f: float, zeta: float, low: float, high: float) -> float:
    """Return the mean square of a mode's acceleration under a white force, between two frequencies."""
    at = np.linspace(low, high, 4001)
    return float(np.mean(at**4 / ((f**2 - at**2) ** 2 + (2.0 * zeta * f * at) ** 2)))


if __name__ == "__main__":
    main()
