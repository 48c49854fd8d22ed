"""From a known asset through its records back to the asset."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.change.modal_table import read_modal_table
from jackettwin.cli import main
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.system import build_system
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.model import asset_model, true_modes
from jackettwin.structure import assemble
from jackettwin.study.truth import TrueParameter

SCENARIO = """
structure: jacket15
rna:
  mass_kg: 808927.9809066091
  static_moment_kg_m: [-5897995.222981686, 0.0, 3725437.7988097044]
  inertia_about_node_kg_m2: [370198119.87857413, 247189039.48680547, 248749307.04428777, 0.0, 0.0, 0.0]
gravity: true
support: kelvin-voigt:k=2.5e9,c=7.6e8
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.183}}
wind: {speed_m_s: 12, turbulence: B}
time: {duration_s: 1200, step_s: 0.05, discard_s: 200}
sensors:
  - {channel: acc_top_x, height_m: 144, direction: [1, 0, 0]}
  - {channel: acc_top_y, height_m: 144, direction: [0, 1, 0]}
  - {channel: acc_g41_x, height_m: 41, direction: [1, 0, 0]}
  - {channel: acc_g41_y, height_m: 41, direction: [0, 1, 0]}
"""


def test_the_loop_closes(tmp_path: Path) -> None:
    """Asset → records → modes → supports: frequencies within 1 %, k and c inside their own 90 % intervals."""
    (tmp_path / "base.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "set.yaml").write_text(
        "{scenario: base.yaml, bins: [{speed_m_s: 12}], seeds: 2, start_utc: 2025-03-01T06:00:00Z, "
        "every_hours: 12}",
        encoding="utf-8",
    )
    result = CliRunner().invoke(
        main,
        ["run", "--simulate", "--set", str(tmp_path / "set.yaml"), "--out", str(tmp_path / "out"), "--json"],
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    truth = {mode["label"]: mode for mode in document["truth"]["modes"]}
    measured = {mode["label"]: mode for mode in document["modes"]}
    for label in ("fore_aft_1", "side_side_1"):
        assert measured[label]["frequency_hz"] == pytest.approx(truth[label]["frequency_hz"], rel=0.01)
    parameters = {p["name"]: p for p in document["truth"]["parameters"]}
    assert {name: p["true"] for name, p in parameters.items()} == {"k": 2.5e9, "c": 7.6e8}
    # the seeds are fixed; over many, qualify/closing_loop.py counts how often the intervals hold the truth
    assert all(p["covered"] for p in parameters.values()), parameters
    for p in parameters.values():
        low, high = p["interval_90"]
        assert high / low < 20.0  # an interval over the whole prior would hold anything
    assert (tmp_path / "out" / "records" / "manifest.json").exists()
    in_time = read_modal_table(tmp_path / "out" / "modes_in_time.csv").history
    np.testing.assert_allclose(in_time.days, [0.25, 0.75], rtol=1e-12)
    assert {"fore_aft_1", "side_side_1"} <= {*in_time.labels}
    assert in_time.state_names == ("parked",)
    assert "Mean true values stated by these records" in (tmp_path / "out" / "report.html").read_text(
        encoding="utf-8"
    )


def test_coverage_is_said_only_of_intervals() -> None:
    assert TrueParameter("kelvin-voigt", "k", 2.0, 3.0, (1.0, 4.0)).covered is True
    assert TrueParameter("kelvin-voigt", "k", 5.0, 3.0, (1.0, 4.0)).covered is False
    assert TrueParameter("kelvin-voigt", "k", 5.0, 3.0, None).covered is None


def test_the_simulated_model_has_the_modes_of_the_twin() -> None:
    """Same steel, same feet, still air, modes below 5 Hz kept: frequencies are the full model's to 1e-4."""
    scenario = read_scenario("known_feet")
    asset = scenario.asset
    system = build_system(
        assemble(asset.structure, gravity=asset.gravity), asset.support, rayleigh=asset.rayleigh
    )
    full = damped_modes(system, below_hz=0.8)
    simulated = true_modes(asset_model(asset), below_hz=0.8)
    assert len(simulated) == 5
    for mode, pole in zip(simulated, full.eigenvalues, strict=True):
        assert mode.frequency_hz == pytest.approx(abs(pole) / (2.0 * math.pi), rel=1e-4)
        assert mode.damping_ratio == pytest.approx(-pole.real / abs(pole), rel=1e-3)
