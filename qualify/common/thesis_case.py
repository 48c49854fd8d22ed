"""A structure of somebody's own with all the files that the page on the thesis names beside it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import date, timedelta
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.optimize import brentq

from jackettwin import Rayleigh, assemble, build_system, damped_modes, read_structure, read_support
from jackettwin.response import mode_kinds, mode_labels, undamped_modes
from jackettwin.structure import Assembly, Structure
from jackettwin.updating import numbered_modes, stages

DECKS = Path(__file__).parents[1] / "decks"
STEEL = {"ratio": 0.006, "frequency_hz": 0.4}
SOFTER, LOSS = 0.985, 0.12
"""First frequency on the feet over that on pins; loss factor of the feet at it."""


def table(path: Path, head: str, rows: Iterable[Iterable[object]]) -> None:
    """Write a CSV file."""
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class ThesisCase:
    """A structure file, and a folder for what is computed from it.

    Parameters
    ----------
    file : of the structure, in any form that ``read_structure`` reads
    folder : an existing one, for the companion files
    """

    file: Path
    folder: Path

    @cached_property
    def structure(self) -> Structure:
        return read_structure(self.file)

    @cached_property
    def assembly(self) -> Assembly:
        return assemble(self.structure)

    @cached_property
    def pinned_hz(self) -> np.ndarray:
        return numbered_modes(self.assembly, 8).frequency_hz

    @cached_property
    def feet(self) -> tuple[float, float]:
        """Return k [N/m] and c [N·s/m] of Kelvin–Voigt feet that the first mode feels."""

        def lowered(log_k: float) -> float:
            support = read_support(f"kelvin-voigt:k={np.exp(log_k):.6g},c=0", self.structure)
            found = undamped_modes(build_system(self.assembly, support), 1)
            return float(found.frequency_hz[0]) / self.pinned_hz[0] - SOFTER

        k = float(f"{np.exp(brentq(lowered, np.log(1e7), np.log(1e13), xtol=0.01)):.2g}")
        return k, float(f"{LOSS * k / (2 * np.pi * self.pinned_hz[0]):.2g}")

    @property
    def law(self) -> str:
        return "kelvin-voigt:k={:g},c={:g}".format(*self.feet)

    @property
    def depth_m(self) -> float:
        lowest = min(self.structure.nodes[node][2] for node in self.structure.reaction_nodes)
        return round(self.structure.sea_level_z_m - lowest, 3)

    @cached_property
    def parts(self) -> list[str]:
        return list(stages(self.structure, 1)[-1].parts)

    @property
    def sensors(self) -> list[dict[str, Any]]:
        """Return accelerometers along x and y at the top, and at three lower heights of the axis."""
        top = self.structure.nodes[self.top][2] - self.structure.sea_level_z_m
        low = max(self.structure.nodes[node][2] for node in self.structure.interface_nodes)
        low -= self.structure.sea_level_z_m
        return [
            {"channel": f"a{k}_{axis}", "height_m": round(float(h), 2), "direction": d, "noise": 1e-4}
            for k, h in enumerate(np.linspace(top, low, 4))
            for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
        ]

    @property
    def scenario(self) -> dict[str, Any]:
        """Return a quiet sea and a wind on the asset on its feet."""
        return {
            "structure": str(self.file),
            "support": self.law,
            "damping": {"rayleigh": STEEL},
            "water": {"depth_m": self.depth_m},
            "waves": {"type": "jonswap", "hs_m": 1.5, "tp_s": 6, "seed": 3},
            "wind": {"speed_m_s": 10, "turbulence": "B", "seed": 5},
            "rotor": {"data": "none"},
            "time": {"duration_s": 60, "step_s": 0.05},
            "sensors": self.sensors,
        }

    @cached_property
    def on_feet(self) -> tuple[np.ndarray, np.ndarray]:
        """Return frequencies [Hz] and damping ratios of eight modes on the feet, without gravity."""
        steel = Rayleigh.minimum(STEEL["ratio"], STEEL["frequency_hz"])
        system = build_system(self.assembly, read_support(self.law, self.structure), rayleigh=steel)
        modes = damped_modes(system, below_hz=1.05 * self.pinned_hz[-1])
        return modes.frequency_hz[:8], modes.damping_ratio[:8]

    @property
    def twin(self) -> dict[str, Any]:
        """Return a twin on frequencies of modes 1, 2 and 4 and the damping of mode 1, as in the thesis."""
        f, zeta = self.on_feet
        targets: list[dict[str, float]] = [{"mode": m, "frequency_hz": float(f[m - 1])} for m in (1, 2, 4)]
        targets[0]["damping_ratio"] = float(zeta[0])
        return {
            "structure": str(self.file),
            "gravity": False,
            "damping": {"rayleigh": STEEL},
            "support": {"law": "kelvin-voigt", "tie": "all"},
            "targets": targets,
            "update": {"weighting": "relative", "starts": 8},
        }

    @property
    def relaxing(self) -> str:
        """Return Zener feet, half as stiff at rest: their relaxation is slow enough to be measured."""
        k, c = self.feet
        return f"zener:k0={0.5 * k:g},c={3.0 * c:g},k1={0.5 * k:g}"

    @property
    def pull(self) -> dict[str, Any]:
        """Return a pull at the top and a release, on Zener feet whose displacements are measured."""
        feet = [
            {
                "channel": f"foot{i}",
                "node": n,
                "direction": [0, 0, 1],
                "quantity": "displacement",
                "noise": 1e-5,
            }
            for i, n in enumerate(self.structure.reaction_nodes)
        ]
        rest = {key: value for key, value in self.scenario.items() if key not in ("waves", "wind")}
        return {
            **rest,
            "support": self.relaxing,
            "start": {"node": self.top, "direction": [1, 0, 0], "force_n": 1.0e6, "release_s": 10},
            "time": {"duration_s": 120, "step_s": 0.05},
            "sensors": [*self.sensors, *feet],
        }

    @property
    def top(self) -> str:
        return self.structure.top_node

    @cached_property
    def changed(self) -> tuple[float, float, list[float], list[float]]:
        """Return a density of the first part, a modulus of the last, and the frequencies of both stages."""
        density, modulus = 1.06, 0.97
        first, last = self.parts[0], self.parts[-1]
        other = self.structure.with_material(first, density=density)
        other = other.with_material(last, youngs_modulus=modulus)
        staged = stages(other, 4)
        return density, modulus, list(staged[0].frequency_hz), list(staged[-1].frequency_hz)

    @property
    def refinement(self) -> dict[str, Any]:
        density, modulus, alone, whole = self.changed
        return {
            "structure": str(self.file),
            "gravity": False,
            "stages": [
                {
                    "parts": self.parts[:1],
                    "frequency_hz": {k + 1: float(f) for k, f in enumerate(alone)},
                    "free": [{"part": self.parts[0], "property": "density", "bounds": [0.5, 2.0]}],
                },
                {
                    "parts": [],
                    "frequency_hz": {k + 1: float(f) for k, f in enumerate(whole)},
                    "free": [{"part": self.parts[-1], "property": "youngs_modulus", "bounds": [0.5, 2.0]}],
                },
            ],
        }

    def prepare(self) -> None:
        """Write every companion file that needs no command."""
        (self.folder / "out").mkdir(exist_ok=True)
        (self.folder / "piles.yaml").write_bytes((DECKS / "piles.yaml").read_bytes())
        self.write("parked.yaml", self.scenario)
        self.write("day.yaml", {**self.scenario, "time": {"duration_s": 600, "step_s": 0.08}})
        self.write("pull.yaml", self.pull)
        self.write("twin.yaml", self.twin)
        self.write("refine.yaml", self.refinement)
        bins = [{"speed_m_s": speed, "hs_m": 0.15 * speed, "tp_s": 6.0} for speed in (8, 10, 12, 14)]
        self.write("set.yaml", {"scenario": "parked.yaml", "bins": bins, "seeds": 1})
        (self.folder / "push.csv").write_text(f"time_s,{self.top}.fx_n\n0,0\n20,2e5\n60,2e5\n")
        rng, t = np.random.default_rng(1), np.arange(0.0, 600.0, 0.1)
        stress = 30e6 * np.sin(2 * np.pi * 0.3 * t) + 8e6 * rng.normal(size=t.size)
        table(self.folder / "stress.csv", "time_s,stress_pa", zip(t, stress, strict=True))
        self.write_history(rng)

    def write_history(self, rng: np.random.Generator) -> None:
        """Write a table of modes, 1.2 % lower from day 430 on."""
        modes = numbered_modes(self.assembly, 4)
        kinds = mode_labels(mode_kinds(self.assembly, modes.shapes, modes.frequency_hz))
        rows = [
            (f"{date(2024, 1, 1) + timedelta(days=day)}T00:00:00Z", kinds[i], f * drop * noise, 2e-3 * f)
            for day in range(500)
            for drop in [0.988 if day >= 430 else 1.0]
            for i, f in enumerate(self.pinned_hz[:4])
            for noise in [1.0 + 2e-3 * rng.normal()]
        ]
        table(self.folder / "modes.csv", "time_utc,label,frequency_hz,frequency_std_hz", rows)

    def write(self, name: str, document: dict[str, Any]) -> Path:
        """Write a YAML file into the folder."""
        path = self.folder / name
        path.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
        return path
