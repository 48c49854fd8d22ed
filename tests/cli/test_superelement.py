"""``jackettwin superelement``: the contract's keys and refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"


def run(*arguments: str):
    return CliRunner().invoke(main, ["superelement", *arguments])


def test_json_has_the_keys_of_the_contract(tmp_path: Path) -> None:
    out = tmp_path / "jacket.npz"
    result = run(str(DECK), "--modes", "6", "--reference", "0,0,30", "--out", str(out), "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert np.shape(found["interface_stiffness"]) == np.shape(found["interface_mass"]) == (6, 6)
    assert len(found["guyan_frequency_hz"]) == len(found["fixed_interface_frequency_hz"]) == 6
    # SubDyn's own summary of this deck
    assert found["guyan_frequency_hz"][0] == pytest.approx(1.425245, rel=1e-5)
    with np.load(out) as data:
        assert {"M", "C", "K", "T"} <= set(data)
        assert data["T"].shape[1] == 12
        np.testing.assert_allclose(data["K"][:6, :6], found["interface_stiffness"], rtol=1e-12)


def test_strong_dashpots_beside_plain_craig_bampton(tmp_path: Path) -> None:
    feet = "kelvin-voigt:k=2.5e9,c=7.6e8"
    result = run("jacket15", "--support", feet, "--out", str(tmp_path / "se.dat"), "--json")
    found = json.loads(result.stdout)
    second = found["modes"][3]
    assert second["reduced_damping_ratio"] == pytest.approx(second["damping_ratio"], rel=0.01)
    assert second["plain_craig_bampton_damping_ratio"] > 2.0 * second["damping_ratio"]
    assert found["warnings"] == []  # version 5 couples implicitly
    assert (tmp_path / "se_ExtPtfm.dat").exists()


def test_a_superelement_goes_from_format_to_format(tmp_path: Path) -> None:
    """Deck to ExtPtfm to npz: the same interface stiffness to sixteen digits."""
    dat, npz = tmp_path / "se.dat", tmp_path / "se.npz"
    first = json.loads(run(str(DECK), "--modes", "4", "--out", str(dat), "--json").stdout)
    result = run(str(dat), "--out", str(npz), "--json")
    assert result.exit_code == 0, result.stderr
    again = json.loads(result.stdout)
    np.testing.assert_allclose(again["interface_stiffness"], first["interface_stiffness"], rtol=1e-14)
    held = first["fixed_interface_frequency_hz"]
    np.testing.assert_allclose(again["fixed_interface_frequency_hz"], held, rtol=1e-9)
    assert "coordinates" in run(str(npz), "--out", str(tmp_path / "third.dat")).stdout


def test_a_tower_goes_inside_and_leaves_its_top_to_the_turbine(tmp_path: Path) -> None:
    """The interface is the tower's top: every mode of the whole is there, the turbine's mass is not."""
    feet = ("--support", "kelvin-voigt:k=2.5e9,c=7.6e8", "--gravity")
    out = tmp_path / "se.npz"
    found = json.loads(run("jacket15", *feet, "--tower-inside", "--out", str(out), "--json").stdout)
    outside = json.loads(run("jacket15", *feet, "--out", str(tmp_path / "o.npz"), "--json").stdout)
    assert found["reference_m"][2] == pytest.approx(216.0)
    assert found["largest_frequency_error"] < 1e-4
    for inside, other in zip(found["modes"], outside["modes"], strict=False):
        assert inside["frequency_hz"] == pytest.approx(other["frequency_hz"], rel=1e-9)
        assert inside["reduced_damping_ratio"] == pytest.approx(inside["damping_ratio"], rel=0.02, abs=1e-5)
    # the top carries no turbine: 809 t less
    top, whole = found["interface_mass"], outside["interface_mass"]
    assert 0.0 < top[0][0] < 809e3
    assert np.shape(whole) == (6, 6)
    refused = run("jacket15", *feet, "--tower-inside", "--interface", "tp_top", "--out", str(out))
    assert refused.exit_code == 2
    assert "given twice" in refused.stderr


def test_a_small_foundation_keeps_all_that_it_has(tmp_path: Path) -> None:
    """A tripod of three tubes has six degrees of freedom at its top and nine rotations of its pinned feet."""
    own = tmp_path / "tripod.yaml"
    own.write_text(TRIPOD)
    document = json.loads(run(str(own), "--out", str(tmp_path / "t.npz"), "--json").stdout)
    assert len(document["fixed_interface_frequency_hz"]) == 8
    refused = run(str(own), "--modes", "9", "--out", str(tmp_path / "t.npz"))
    assert refused.exit_code == 2 and "(got 9); allowed: 0 to 8" in refused.stderr.replace("\n", " ")


TRIPOD = """\
sections: {leg: {outer_diameter_m: 1.0, thickness_m: 0.03}}
nodes: {a: [8, 0, 0], b: [-4, 7, 0], c: [-4, -7, 0], top: [0, 0, 20]}
members: [{nodes: [a, top], section: leg}, {nodes: [b, top], section: leg}, {nodes: [c, top], section: leg}]
reaction_nodes: [a, b, c]
interface_nodes: [top]
"""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["jacket15", "--out", "se.txt"], "unknown format of a superelement"),
        (["jacket15", "--reference", "1,2", "--out", "se.npz"], "not X,Y,Z"),
        (["jacket51", "--out", "se.npz"], "did you mean 'jacket15'"),
    ],
)
def test_bad_input_exits_2(arguments: list[str], message: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr.replace("\n", " ")


def test_a_decks_own_damping(tmp_path: Path) -> None:
    """JDampings on the internal coordinates, GuyanDampMod 1 on the interface: SubDyn's C."""
    text = DECK.read_text()
    deck = tmp_path / "deck.dat"
    lines = text.splitlines()
    for at, line in enumerate(lines):
        if line.split()[1:2] == ["GuyanDampMod"]:
            lines[at] = "1 GuyanDampMod"
        if "RayleighDamp" in line.split():
            lines[at] = "0.01, 0.002  RayleighDamp"
        if "JDampings" in line.split():
            lines[at] = "2, 1.5   JDampings"
    deck.write_text("\n".join(lines))
    (tmp_path / "Jacket_Kzz.txt").write_text((DECK.parent / "Jacket_Kzz.txt").read_text())
    out = tmp_path / "jacket.npz"
    result = run(str(deck), "--modes", "3", "--deck-damping", "--out", str(out), "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    expected = 0.01 * np.array(found["interface_mass"]) + 0.002 * np.array(found["interface_stiffness"])
    np.testing.assert_allclose(found["interface_damping"], expected, rtol=1e-12)
    with np.load(out) as data:
        inner = 2 * np.array([0.02, 0.015, 0.015]) * np.sqrt(np.diag(data["K"])[6:])
        np.testing.assert_allclose(np.diag(data["C"])[6:], inner, rtol=1e-12)
    refused = run("jacket15", "--deck-damping", "--out", str(out))
    assert refused.exit_code == 2
    assert "only a SubDyn deck" in refused.stderr


def test_what_floats_is_reduced_and_missing_modes_are_said(tmp_path: Path) -> None:
    """A deck without reaction joints moves freely with its interface: a floater's, or one that hangs."""
    deck = tmp_path / "floats.dat"
    text = DECK.read_text(encoding="utf-8")
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if "NReact" in line)
    n = int(lines[at].split()[0])
    lines[at] = lines[at].replace(str(n), "0", 1)
    del lines[at + 3 : at + 3 + n]
    deck.write_text("\n".join(lines), encoding="utf-8")
    few, many = (
        run(str(deck), "--modes", number, "--out", str(tmp_path / "f.npz"), "--json")
        for number in ("2", "40")
    )
    assert few.exit_code == many.exit_code == 0, few.stderr + many.stderr
    assert "of the band are missing" in few.stderr
    found = json.loads(many.stdout)
    assert max(found["guyan_frequency_hz"]) < 1e-3
    assert not found["warnings"]
    # forty fixed-interface modes of a jacket whose first five free ones are asked for
    assert found["largest_frequency_error"] < 0.01


@pytest.mark.parametrize(
    ("name", "layout", "warned"),
    [("a.npz", "openfast5", False), ("a.dat", "openfast5", False), ("a.dat", "openfast4", True)],
)
def test_only_who_integrates_explicitly_is_warned_of_fast_poles(
    name: str, layout: str, warned: bool, tmp_path: Path
) -> None:
    """Version 5 couples implicitly and is stable at 0.01 s (docs/verification/openfast.md)."""
    arguments = [
        "--support",
        "kelvin-voigt:k=2.5e9,c=7.6e8",
        "--layout",
        layout,
        "--out",
        str(tmp_path / name),
    ]
    answer = CliRunner().invoke(main, ["superelement", "jacket15", *arguments, "--json"])
    assert answer.exit_code == 0, answer.stderr
    assert any("explicitly" in warning for warning in json.loads(answer.stdout)["warnings"]) is warned
