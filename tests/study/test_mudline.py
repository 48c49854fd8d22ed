"""A twin on one matrix at the mudline finds the planted k_u, k_θ and c, under a jacket and a monopile."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from jackettwin import Rayleigh, assemble, build_system, damped_modes, read_structure, undamped_modes
from jackettwin.cli.main import main
from jackettwin.soil import MUDLINE, read_support, read_supported, tied_at_mudline
from jackettwin.study import run_twin
from jackettwin.twin import read_twin

MONOPILE = """
sea_level_z_m: 30.0
sections:
  pile: {outer_diameter_m: 8.0, thickness_m: 0.08}
  low: {outer_diameter_m: 7.5, thickness_m: 0.05}
  high: {outer_diameter_m: 5.0, thickness_m: 0.025}
nodes: {bed: [0, 0, 0], deck: [0, 0, 45], top: [0, 0, 140]}
members:
  - {nodes: [bed, deck], section: pile, part: foundation}
  - {nodes: [deck, top], sections: [low, high], part: tower}
rna: {mass_kg: 500000, cg_offset_m: [-2, 0, 2], inertia_about_cg_kg_m2: [1.0e8, 6.0e7, 5.0e7, 0, 0, 0]}
reaction_nodes: [bed]
interface_nodes: [deck]
subdivide: 6
"""
JACKET = """
sea_level_z_m: 45.0
jacket:
  lattice:
    {legs: 4, bays: 3, base_width_m: 24.0, top_width_m: 12.0, height_m: 62.0, leg_diameter_m: 1.4,
     leg_thickness_bottom_m: 0.045, leg_thickness_top_m: 0.035,
     brace: {outer_diameter_m: 0.8, thickness_m: 0.02}}
  transition_piece:
    {top_z_m: 70.0, tube: {outer_diameter_m: 2.0, thickness_m: 0.06},
     column: {outer_diameter_m: 7.5, thickness_m: 0.08}}
  tower:
    {height_m: 95.0, elements: 8, bottom: {outer_diameter_m: 7.5, thickness_m: 0.045},
     top: {outer_diameter_m: 5.5, thickness_m: 0.025}}
  rna: {mass_kg: 675000.0, cg_offset_m: [-2.5, 0.0, 3.0],
        inertia_about_cg_kg_m2: [1.7e8, 1.0e8, 1.0e8, 0.0, 0.0, 0.0]}
"""
OWN = {"monopile": MONOPILE, "jacket": JACKET}
TRUTH = {"monopile": (2.5e9, 4e11, 3e7), "jacket": (1.5e9, 9e11, 2e7)}
STEEL = (0.003, 0.25)


def planted(folder: Path, name: str, law: str = "kelvin-voigt", values: str = "", **support: object) -> Path:
    """Write a structure, and a twin whose targets are its exact modes on a known mudline."""
    (folder / "own.yaml").write_text(OWN[name])
    given = values or "k_u={:g},k_theta={:g},c={:g}".format(*TRUTH[name])
    structure, ground = read_supported(f"mudline:{law}:{given}", read_structure(folder / "own.yaml"))
    system = build_system(assemble(structure, gravity=True), ground, rayleigh=Rayleigh.minimum(*STEEL))
    found = damped_modes(system, below_hz=4.0)
    # the order on rigid feet, which numbers modes, is that on the ground as far as this
    numbers = (1, 2, 3, 4, 5) if name == "jacket" else (1, 2, 3)
    targets = [
        {
            "mode": mode,
            "frequency_hz": float(found.frequency_hz[mode - 1]),
            "frequency_std_hz": 1e-3 * float(found.frequency_hz[mode - 1]),
            "damping_ratio": float(found.damping_ratio[mode - 1]),
            "damping_ratio_std": 0.05 * float(found.damping_ratio[mode - 1]),
        }
        for mode in numbers
    ]
    twin = {
        "structure": "own.yaml",
        "damping": {"rayleigh": {"ratio": STEEL[0], "frequency_hz": STEEL[1]}},
        "support": {"tie": MUDLINE, **support},
        "targets": targets,
        "tolerances": "none",
        "update": {"laws": [law], "damping_of": "all", "starts": 12},
    }
    (folder / "twin.yaml").write_text(yaml.safe_dump(twin))
    return folder / "twin.yaml"


@pytest.mark.parametrize("name", OWN)
def test_the_planted_truth_is_found_by_name(name: str, tmp_path: Path) -> None:
    """From the command line; the fit is of exact data, so it ends where the truth is."""
    path = planted(tmp_path, name)
    reply = CliRunner().invoke(main, ["update", str(path), "--json"])
    assert reply.exit_code == 0, reply.output
    found = json.loads(reply.stdout)["parameters"]
    assert list(found) == ["k_u", "k_theta", "c"]
    assert [found[p]["unit"] for p in found] == ["N/m", "N·m/rad", "N·s/m"]
    for (name_, one), truth in zip(found.items(), TRUTH[name], strict=True):
        assert one["best_fit"] == pytest.approx(truth, rel=1e-4), name_  # a search ends within 1e-6 of ln θ
        low, high = one["interval_90"]
        assert low < truth < high
    # rocking is what the first bending modes feel of a foundation
    assert found["k_theta"]["interval_90"][1] < 1.3 * found["k_theta"]["interval_90"][0]


def test_other_laws_have_one_loss_for_both(tmp_path: Path) -> None:
    values = "k_u=1.5e9,k_theta=9e11,loss_factor=0.08,f0={:.9g}"
    (tmp_path / "own.yaml").write_text(JACKET)
    tied = assemble(tied_at_mudline(read_structure(tmp_path / "own.yaml")), gravity=True)
    clamped = undamped_modes(build_system(tied, read_support("clamped", tied.structure)), 1)
    config = read_twin(
        planted(tmp_path, "jacket", "maxwell-3", values.format(float(clamped.frequency_hz[0])))
    )
    update = run_twin(config, posteriors="none").updates[0]
    assert [p.name for p in update.problem.parameters] == ["k_u", "k_theta", "loss_factor"]
    np.testing.assert_allclose(update.best.theta, (1.5e9, 9e11, 0.08), rtol=1e-4)


def test_piles_under_every_leg_give_the_matrix_its_proportion_and_its_priors(tmp_path: Path) -> None:
    """Their own stiffness is the priors' median: the sum of the legs' heads, and their arms."""
    config = read_twin(planted(tmp_path, "jacket", stiffness="jacket15_records"))
    update = run_twin(config, posteriors="none").updates[0]
    k_u, k_theta = update.model.tie_groups.stiffness or ()
    medians = {p.name: p.median for p in update.problem.parameters}
    assert medians["k_u"] == pytest.approx(k_u) and medians["k_theta"] == pytest.approx(k_theta)
    assert medians["c"] is not None
    (node,) = update.model.assembly.structure.reaction_nodes
    assert node == MUDLINE and len(update.model.tie_groups.masses) == 4


@pytest.mark.parametrize(
    ("key", "value", "match"),
    [
        ("support", {"tie": "mud"}, "support.tie"),
        ("support", {"tie": "mudline", "shared": ["c"]}, "share all parameters already"),
        ("update", {"bounds": {"k_thta": [1.0, 2.0]}, "laws": ["kelvin-voigt"]}, "k_thta"),
    ],
)
def test_wrong_keys_are_named(key: str, value: object, match: str, tmp_path: Path) -> None:
    path = planted(tmp_path, "monopile")
    path.write_text(yaml.safe_dump({**yaml.safe_load(path.read_text()), key: value}))
    reply = CliRunner().invoke(main, ["update", str(path), "--json"])
    assert reply.exit_code == 2 and match in reply.stderr, reply.stderr
