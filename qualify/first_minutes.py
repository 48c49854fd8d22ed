"""From a deck and a folder of CSV files to a verdict, by the commands of a new user: ``init`` and ``run``.

Three fictitious symmetric jackets have records from ``simulate`` on known feet, in the formats of loggers.
Each command runs in its own process; the cache is empty, so that ``run`` also compiles the kernels. Measured:
time, CPU, first line, longest silence, false modes with status ``ok``, and whether the interval contains the
known stiffness or the page states that the model does not fit.

Limits: ten minutes and 90 CPU-s (where a dense 800 × 800 ``eig`` takes 0.8) a jacket, first line of a command
within 1 s, no silence over 2 s, no false mode.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from time import perf_counter, process_time
from typing import IO, Any

import numpy as np
import yaml
from common.command import arguments
from common.page import write_page

from jackettwin.records import Record, read_record

SLOW_EIG_S = 0.8
FALSE = 0.04
"""Relative distance from every true frequency from which a mode is none: more than four σ of any here."""
G = 9.80665


@dataclass(frozen=True)
class Jacket:
    """A jacket, the truth its records are made of, and how its logger writes them."""

    name: str
    lattice: dict[str, Any]
    tower_m: float
    rna_kg: float
    stiffness: float
    sea_level_z_m: float
    depth_m: float
    german: bool
    growth_m: float = 0.0
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def structure(self) -> dict[str, Any]:
        lattice = self.lattice
        top = lattice.get("base_z_m", 0.0) + lattice["height_m"] + 4.5
        return {
            "name": self.name,
            "sea_level_z_m": self.sea_level_z_m,
            "jacket": {
                "lattice": lattice,
                "transition_piece": {"top_z_m": top, "tube": tube(1.2, 0.04), "column": tube(5.6, 0.06)},
                "tower": {
                    "height_m": self.tower_m, "elements": 12,
                    "bottom": tube(5.6, 0.032), "top": tube(4.0, 0.03),
                },
                "rna": {
                    "mass_kg": self.rna_kg, "cg_offset_m": [0.0, 0.0, 1.9],
                    "inertia_about_cg_kg_m2": [2.5e7, 2.5e7, 2.5e7, 0.0, 0.0, 0.0],
                },
                **self.more,
            },
        }  # fmt: skip

    def scenario(self, seed: int) -> dict[str, Any]:
        top = self.structure["jacket"]["transition_piece"]["top_z_m"] - self.sea_level_z_m
        growth = [{"top_z_m": 0, "bottom_z_m": -0.8 * self.depth_m, "thickness_m": self.growth_m}]
        return {
            "structure": "jacket.yaml",
            "gravity": True,
            "support": f"kelvin-voigt:k={self.stiffness},c={self.stiffness / 50.0}",
            "damping": {"rayleigh": {"ratio": 0.005, "frequency_hz": 0.3}},
            "water": {"depth_m": self.depth_m} | ({"marine_growth": growth} if self.growth_m else {}),
            "waves": {"type": "jonswap", "hs_m": 1.5, "tp_s": 6, "spreading": 10, "seed": seed},
            "wind": {"speed_m_s": 11, "turbulence": "B", "seed": seed},
            "rotor": {"data": "none"},
            "time": {"duration_s": 600},
            "sensors": [
                {
                    "channel": f"ACC_{h:.0f}m_{d}",
                    "height_m": round(h),
                    "direction": list(axis),
                    "noise": 1.0e-3,
                }
                for h in (top + self.tower_m - 1.0, top + 0.5 * self.tower_m, top + 1.0)
                for d, axis in {"E": (1, 0, 0), "N": (0, 1, 0)}.items()
            ],
            "sensor_seed": seed,
        }


def tube(diameter: float, wall: float) -> dict[str, float]:
    return {"outer_diameter_m": diameter, "thickness_m": wall}


FOUR_LEGS = {
    "legs": 4, "bays": 4, "base_width_m": 12.0, "top_width_m": 8.0, "height_m": 65.65,
    "leg_diameter_m": 1.2, "leg_thickness_bottom_m": 0.05, "leg_thickness_top_m": 0.035,
    "brace": tube(0.8, 0.02), "mud_braces": True,
}  # fmt: skip
THREE_LEGS = FOUR_LEGS | {
    "legs": 3, "bays": 3, "base_width_m": 22.0, "top_width_m": 12.0, "height_m": 55.0, "base_z_m": -40.0,
    "leg_diameter_m": 1.4, "brace": [tube(0.9, 0.025), tube(0.8, 0.02), tube(0.7, 0.02)],
}  # fmt: skip
LANDING = {"mass_kg": 40e3, "bottom_z_m": -2.0, "top_z_m": 8.0, "legs": [1, 2, 3]}
JACKETS = (
    Jacket("four legs", FOUR_LEGS, 68.0, 350e3, 6e8, 50.0, 50.0, german=True),
    Jacket(
        "three legs, z = 0 at sea", THREE_LEGS, 80.0, 450e3, 5e8, 0.0, 40.0, german=False,
        more={"appurtenances": {"landing": LANDING}},
    ),
    Jacket("growth nobody stated", FOUR_LEGS, 68.0, 350e3, 6e8, 50.0, 50.0, german=True, growth_m=0.05),
)  # fmt: skip


@dataclass
class Run:
    """A command: its output, when lines came, what it cost."""

    text: str
    seconds: float
    cpu_s: float
    first_line_s: float
    silence_s: float


def command(folder: Path, *arguments: str) -> Run:
    """Run a command of the program as a user would, with caches of its own."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    lines: list[tuple[float, str]] = []
    environment = dict(os.environ, XDG_CACHE_HOME=str(folder / "cache"), PYTHONUNBUFFERED="1")
    process = subprocess.Popen(
        [sys.executable, "-m", "jackettwin", *arguments], cwd=folder, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
    )  # fmt: skip

    def listen(stream: IO[str]) -> None:
        for line in stream:
            lines.append((perf_counter() - start, line))

    ears = [Thread(target=listen, args=(s,)) for s in (process.stdout, process.stderr) if s is not None]
    for ear in ears:
        ear.start()
    code = process.wait()
    for ear in ears:
        ear.join()
    text = "".join(line for _, line in lines)
    if code:
        raise RuntimeError(f"{' '.join(arguments)} ended with {code}: {text[-500:]}")
    seconds, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    times = sorted([0.0, *(t for t, _ in lines), seconds])
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(text, seconds, cpu, times[1], float(np.diff(times).max()))


def as_csv(record: Record, path: Path, *, german: bool) -> None:
    """Write a record as a logger does: German in g, its local clock without a zone; or plain in mg."""
    unit, scale, day, zone = ("g", 1.0, "01.06.2025 14", "") if german else ("mg", 1e3, "2025-06-01T12", "Z")
    separator, point = (";", ",") if german else (",", ".")
    lines = [separator.join(["Zeit", *(f"{name} [{unit}]" for name in record.channel_names)])]
    for k, row in enumerate(scale * record.data.T / G):
        minutes, seconds = divmod(k / record.sample_rate_hz, 60.0)
        numbers = [f"{seconds:06.3f}", *(f"{v:.6f}" for v in row)]
        first, *others = (number.replace(".", point) for number in numbers)
        lines.append(separator.join([f"{day}:{int(minutes):02d}:{first}{zone}", *others]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def tried(jacket: Jacket, folder: Path) -> tuple[list[Run], dict[str, Any], list[float]]:
    """Return what ``init`` and ``run`` cost, the run's result, and the true frequencies."""
    (folder / "jacket.yaml").write_text(yaml.safe_dump(jacket.structure))
    true: list[float] = []
    for seed in (1, 2):
        (folder / "scenario.yaml").write_text(yaml.safe_dump(jacket.scenario(seed)))
        command(folder, "simulate", "scenario.yaml", "--out", f"made_{seed}.parquet")
        as_csv(read_record(folder / f"made_{seed}.parquet"), folder / f"A{seed}.csv", german=jacket.german)
        made = json.loads((folder / f"made_{seed}.json").read_text())
        true = [mode["frequency_hz"] for mode in made["true_modes"]]
    zone = ("--timezone", "Europe/Berlin") if jacket.german else ()
    runs = [
        command(folder, "init", "jacket.yaml", "A1.csv", "A2.csv", "--out", "twin.yaml", *zone),
        command(folder, "run", "twin.yaml", "--out", "out"),
        command(folder, "run", "twin.yaml", "--out", "again"),
    ]
    return runs, json.loads((folder / "out" / "result.json").read_text()), true


def row(jacket: Jacket, runs: list[Run], result: dict[str, Any], true: list[float], slow: float) -> str:
    """Return a line of the table."""
    fine = [
        mode["frequency_hz"]
        for record in result["identification"]
        for mode in record["modes"]
        if mode["status"] == "ok"
    ]
    none = [f for f in fine if min(abs(f / t - 1.0) for t in true) > FALSE]
    fit = result["answers"]["fit"]
    stiff = next(g for g in result["answers"]["ground"] if g["kind"] == "stiffness")["value"]
    held = "inside" if stiff["low"] <= jacket.stiffness <= stiff["high"] else "outside"
    said = "fits" if fit["fits"] else "does not fit, and says so"
    init, first, again = runs
    cells = (
        jacket.name,
        f"{init.seconds + first.seconds:.0f}",
        f"{slow * (init.cpu_s + first.cpu_s):.0f}",
        f"{slow * again.cpu_s:.0f}",
        f"{max(r.first_line_s for r in runs):.1f}",
        f"{max(r.silence_s for r in runs):.1f}",
        f"{len(none)} of {len(fine)}",
        f"{jacket.stiffness / 1e6:.0f}",
        f"{stiff['low'] / 1e6:.0f}–{stiff['high'] / 1e6:.0f}, {held}",
        said,
    )
    return f"| {' | '.join(cells)} |"


COLUMNS = (
    "jacket", "to the verdict [s]", "CPU, slow [s]", "again, slow [s]", "first line [s]", "silence [s]",
    'false "ok"', "true k [MN/m]", "stated, 90 % [MN/m]", "the page says: the model",
)  # fmt: skip


def slowness() -> float:
    """Return how much slower than this one the machine of the bars is."""
    start = process_time()
    np.linalg.eig(np.random.default_rng(0).normal(size=(800, 800)))
    return SLOW_EIG_S / (process_time() - start)


def main() -> None:
    arguments(__doc__)
    slow = slowness()
    rows = []
    for jacket in JACKETS:
        with tempfile.TemporaryDirectory() as folder:
            rows.append(row(jacket, *tried(jacket, Path(folder)), slow))
            sys.stderr.write(rows[-1] + "\n")
    assert __doc__ is not None
    table = [
        f"| {' | '.join(COLUMNS)} |",
        "|" + "---|" * len(COLUMNS),
        *rows,
    ]
    write_page("first_minutes", ["# The first ten minutes", "", *__doc__.strip().splitlines(), "", *table])


if __name__ == "__main__":
    main()
