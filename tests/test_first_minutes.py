"""The first ten minutes in small: an own symmetric jacket and a German logger's CSV, to a verdict.

``qualify/first_minutes.py`` does the same at full size, with simulated waves and wind, and measures it.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from click.testing import CliRunner, Result

from jackettwin import assemble, build_system, damped_modes, read_structure, read_support
from jackettwin.cli import main
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Rayleigh

JACKET = """
name: mine
sea_level_z_m: 50
jacket:
  lattice: {legs: 4, bays: 3, base_width_m: 16, top_width_m: 10, height_m: 62, leg_diameter_m: 1.3,
    leg_thickness_bottom_m: 0.05, leg_thickness_top_m: 0.04, mud_braces: true,
    brace: {outer_diameter_m: 0.8, thickness_m: 0.02}}
  transition_piece: {top_z_m: 67, tube: {outer_diameter_m: 1.3, thickness_m: 0.05},
    column: {outer_diameter_m: 5.6, thickness_m: 0.06}}
  tower: {height_m: 70, elements: 8, bottom: {outer_diameter_m: 5.6, thickness_m: 0.032},
    top: {outer_diameter_m: 4, thickness_m: 0.03}}
  rna: {mass_kg: 350000, cg_offset_m: [0, 0, 1.9], inertia_about_cg_kg_m2: [2.5e7, 2.5e7, 2.5e7, 0, 0, 0]}
"""
STIFFNESS, LOSS = 6e8, 1.2e7
HEIGHTS = (86.0, 50.0, 18.0)
SENSORS = tuple(
    Sensor(f"ACC_{h:.0f}m_{d}", axis, None, h)
    for h in HEIGHTS
    for d, axis in {"E": (1.0, 0.0, 0.0), "N": (0.0, 1.0, 0.0)}.items()
)


def modes_of(jacket: Path) -> ModalSystem:
    """Return the first two bending pairs as the sensors see them, under white forces."""
    structure = read_structure(str(jacket))
    assembly = assemble(structure, gravity=True)
    support = read_support(f"kelvin-voigt:k={STIFFNESS},c={LOSS}", structure)
    found = damped_modes(build_system(assembly, support, rayleigh=Rayleigh.minimum(0.005, 0.3)), below_hz=2.0)
    seen = (observation_matrix(assembly, SENSORS) @ found.shapes).real
    lively = np.flatnonzero(np.abs(seen).max(axis=0) > 0.2 * np.abs(seen).max())[:4]
    shapes = (seen[:, lively] / np.abs(seen[:, lively]).max(axis=0)).T
    force = np.diag([1.0, 1.2, 3.0, 3.5])[: lively.size, : lively.size]
    return ModalSystem(found.frequency_hz[lively], found.damping_ratio[lively], shapes, force)


def csv(system: ModalSystem, path: Path, seed: int) -> None:
    record = simulate(system, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=10.0)
    lines = ["Zeit;" + ";".join(f"{s.channel} [g]" for s in SENSORS)]
    for k, row in enumerate(record.data.T / 9.80665):
        minutes, seconds = divmod(k / 10.0, 60.0)
        numbers = [f"{seconds:06.3f}", *(f"{v:.9f}" for v in row)]
        lines.append(f"01.06.2025 14:{int(minutes):02d}:" + ";".join(numbers).replace(".", ","))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def command(*arguments: str) -> Result:
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 0, done.output
    return done


def test_from_a_jacket_and_a_csv_to_a_verdict(tmp_path: Path) -> None:
    jacket, twin, out = tmp_path / "jacket.yaml", tmp_path / "twin.yaml", tmp_path / "out"
    jacket.write_text(JACKET)
    system = modes_of(jacket)
    csv(system, tmp_path / "A1.csv", 1)
    said = command("init", str(jacket), str(tmp_path / "A1.csv"), "--out", str(twin))
    assert "86 m by its name, east by its name" in said.stdout
    assert "the clock does not say its zone" in said.stdout  # never silently UTC
    small = "update:\n  laws: [kelvin-voigt]\n  starts: 4\n  particles: 60\n"
    # the modes made here are those of the jacket in air
    twin.write_text(twin.read_text().replace("water:", "# water:").replace("update:\n", small))
    seen = command("run", str(twin), "--out", str(out))
    result = json.loads((out / "result.json").read_text())
    fine = [m["frequency_hz"] for m in result["identification"][0]["modes"] if m["status"] == "ok"]
    assert fine
    for f in fine:  # no mode is called one that is none
        assert np.abs(system.frequency_hz / f - 1.0).min() < 0.03
    (stiff,) = (g for g in result["answers"]["ground"] if g["kind"] == "stiffness")
    assert result["answers"]["fit"]["fits"]
    assert stiff["value"]["low"] < STIFFNESS < stiff["value"]["high"]
    for question in ("Is the model right?", "Whose damping is it?", "What to do next?"):
        assert question in seen.stdout
    page = (out / "report.html").read_text(encoding="utf-8")
    assert all(question in page for question in result["questions"])
