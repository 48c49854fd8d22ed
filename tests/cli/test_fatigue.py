"""``jackettwin fatigue``: the contract's keys, hand values, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.cli.weld_tables import show_lives


def run(*arguments: str):
    return CliRunner().invoke(main, ["fatigue", *arguments])


def answer(*arguments: str) -> dict:
    found = run(*arguments, "--json")
    assert found.exit_code == 0, found.stderr
    return json.loads(found.stdout)


@pytest.fixture
def stress(tmp_path: Path) -> Path:
    """Return 300 cycles of a range of 80 MPa about a slow cycle of 20 MPa."""
    t = np.arange(0.0, 600.0, 0.05)
    values = 40.0 * np.sin(np.pi * t) + 10.0 * np.sin(2 * np.pi * t / 600.0)
    path = tmp_path / "stress.csv"
    np.savetxt(
        path, np.stack([t, values], axis=1), delimiter=",", header="time_s,leg", comments="", fmt="%.9g"
    )
    return path


def test_a_series_has_the_keys_of_the_contract(stress: Path) -> None:
    found = answer("stress", str(stress), "--column", "leg", "--curve", "T", "--environment", "cathodic")
    assert found["n_eq"] == 1e7 and found["edition"] == "DNV-RP-C203 (2016)"
    assert found["cycles_full"] + 0.5 * found["cycles_half"] == pytest.approx(300.0, abs=2.0)
    # 300 ranges of 80 MPa: the slow cycle lifts the largest to 100
    assert found["largest_range_mpa"] == pytest.approx(100.0, rel=0.01)
    assert found["equivalent_range_mpa"]["m3"] == pytest.approx(80.0 * (300 / 1e7) ** (1 / 3), rel=0.02)
    assert found["damage"] == pytest.approx(300.0 * 80.0**5 / 10.0**16.130, rel=0.05)
    # Rayleigh's ranges have Γ(1 + m/2) of a sine's to the power of m; Dirlik's fit and the slow cycle: 6 %
    for m, sine in ((3, 1.329), (5, 3.323)):
        one = found["equivalent_range_by_spectrum_mpa"][f"m{m}"]
        assert one == pytest.approx(found["equivalent_range_mpa"][f"m{m}"] * sine ** (1.0 / m), rel=0.06)


def test_units_and_thickness(stress: Path) -> None:
    mpa = answer("stress", str(stress), "--column", "leg", "--curve", "D")
    n_mm2 = answer("stress", str(stress), "--column", "leg", "--curve", "D", "--unit", "N/mm^2")
    assert n_mm2["damage"] == mpa["damage"]
    thick = answer("stress", str(stress), "--column", "leg", "--curve", "D", "--thickness-mm", "50")
    # (50/25)^0.2 on every range: 2^0.6 where the slope is 3, 2^1 where it is 5
    assert 2.0**0.6 <= thick["damage"] / mpa["damage"] * (1 + 1e-9) and thick["damage"] / mpa["damage"] <= 2.0
    pascal = answer("stress", str(stress), "--column", "leg", "--curve", "D", "--unit", "Pa")
    assert pascal["damage"] < 1e-20 * mpa["damage"]


def test_the_end_of_a_columns_name_states_its_unit(stress: Path, tmp_path: Path) -> None:
    """A unit elsewhere in the name does not, and an option that contradicts it is refused."""
    mpa = answer("stress", str(stress), "--column", "leg")
    t, values = np.loadtxt(stress, delimiter=",", skiprows=1).T
    path = tmp_path / "pascals.csv"
    columns = np.stack([t, 1e6 * values, values], axis=1)
    np.savetxt(path, columns, delimiter=",", header="time_s,leg_Pa,pa_leg", comments="", fmt="%.9g")
    found = answer("stress", str(path), "--column", "leg_Pa")
    assert found["unit"] == "Pa" and found["damage"] == pytest.approx(mpa["damage"], rel=1e-6)
    assert answer("stress", str(path), "--column", "pa_leg")["unit"] == "MPa"
    refused = CliRunner().invoke(
        main, ["fatigue", "stress", str(path), "--column", "leg_Pa", "--unit", "MPa"]
    )
    assert refused.exit_code == 2 and "states Pa" in refused.output


def test_gaps_are_scaled_and_said(stress: Path, tmp_path: Path) -> None:
    t, values = np.loadtxt(stress, delimiter=",", skiprows=1).T
    values[6000:9000] = np.nan
    path = tmp_path / "gap.csv"
    np.savetxt(path, np.stack([t, values], axis=1), delimiter=",", header="time_s,leg", comments="")
    whole = answer("stress", str(stress), "--column", "leg")
    found = answer("stress", str(path), "--column", "leg")
    assert found["damage"] == pytest.approx(whole["damage"], rel=0.05)
    assert "25 % of the samples are missing" in found["warnings"][0]
    assert found["equivalent_range_by_spectrum_mpa"] is None
    # a logger that stood still leaves no rows at all
    there = np.isfinite(values)
    rows = np.stack([t[there], values[there]], axis=1)
    np.savetxt(path, rows, delimiter=",", header="time_s,leg", comments="")
    assert answer("stress", str(path), "--column", "leg")["damage"] == pytest.approx(
        found["damage"], rel=1e-9
    )


def test_a_factor_beyond_its_range_is_no_headline(capsys: pytest.CaptureFixture[str]) -> None:
    """Its weld stands behind the others, however short its life."""
    row = {
        "brace": "b",
        "side": "chord",
        "position": "crown 0°",
        "environment": "air",
        "largest_range_mpa": 9.0,
    }
    joints = [
        {**row, "joint": "wide", "life_years": 0.1, "beyond_validity": ["β = 0.1"]},
        {**row, "joint": "usual", "life_years": 5.0, "beyond_validity": []},
    ]
    show_lives({"joints": joints, "welds": [], "warnings": []}, "all")
    shown = capsys.readouterr().out
    assert 0 < shown.index("usual") < shown.index("wide")


def test_what_a_column_does_not_state_is_said(tmp_path: Path) -> None:
    """A series in ksi looks like one of weaker stress: what is assumed of it stands beside its damage."""
    path = tmp_path / "columns.csv"
    t = np.arange(0.0, 600.0, 0.05)
    leg = 40.0 * np.sin(np.pi * t)
    spiked = np.where(np.arange(t.size) == 6000, 900.0, leg)
    columns = np.stack([t, leg, leg / 6.894757293168, leg / 6.894757293168e-3, spiked, 0.0 * t], axis=1)
    names = "time_s,leg,leg_ksi,leg_psi,spiked_mpa,dead_mpa"
    np.savetxt(path, columns, delimiter=",", header=names, comments="", fmt="%.12g")
    found = {name: answer("stress", str(path), "--column", name) for name in names.split(",")[1:]}
    assert found["leg"]["warnings"] == ["no unit of leg is stated: MPa is assumed (--unit)"]
    for name in ("leg_ksi", "leg_psi"):
        assert found[name]["warnings"] == []
        assert found[name]["damage"] == pytest.approx(found["leg"]["damage"], rel=1e-8)
    assert "a spike?" in found["spiked_mpa"]["warnings"][0]
    assert "is constant" in found["dead_mpa"]["warnings"][0]


def test_scattered_gaps_lose_no_range(stress: Path, tmp_path: Path) -> None:
    """Every third sample missing: the ranges are those of the series, not of the pieces between gaps."""
    t, values = np.loadtxt(stress, delimiter=",", skiprows=1).T
    values[::3] = np.nan
    path = tmp_path / "scattered.csv"
    np.savetxt(path, np.stack([t, values], axis=1), delimiter=",", header="time_s,leg", comments="")
    found = answer("stress", str(path), "--column", "leg")
    assert found["largest_range_mpa"] == pytest.approx(100.0, rel=0.01)
    assert "bridged" in found["warnings"][0]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--column", "brace"), "leg"),
        (("--column", "leg", "--curve", "Q"), "S-N curve"),
        (("--column", "leg", "--edition", "bs_7608"), "dnv_rp_c203_2016"),
        (("--column", "leg", "--thickness-mm", "-3"), "thickness-mm"),
        (("--column", "leg", "--unit", "ksi", "--environment", "wet"), "environment"),
    ],
)
def test_bad_input_is_said_with_its_remedy(arguments: tuple[str, ...], said: str, stress: Path) -> None:
    found = run("stress", str(stress), *arguments)
    assert found.exit_code == 2
    assert said in found.stderr and "Traceback" not in found.stderr


@pytest.mark.parametrize(("size", "unit"), [(4e7, "Pa"), (4e4, "kPa")])
def test_pascals_taken_for_megapascals_are_refused(tmp_path: Path, size: float, unit: str) -> None:
    path = tmp_path / "stress.csv"
    t = np.arange(0.0, 60.0, 0.05)
    np.savetxt(path, np.stack([t, size * np.sin(t)], axis=1), delimiter=",", header="time_s,leg", comments="")
    found = run("stress", str(path), "--column", "leg")
    assert found.exit_code == 2
    assert f"--unit {unit}\n" in found.stderr


def test_megapascals_taken_for_pascals_are_doubted(stress: Path) -> None:
    found = answer("stress", str(stress), "--column", "leg", "--unit", "Pa")
    assert "--unit" in found["warnings"][0]


@pytest.fixture
def rosette(tmp_path: Path) -> Path:
    """Return a rosette at 0, 45 and 90° of ±40 MPa across a weld, with a drift of 12 µm/m/K and a jump."""
    t = np.arange(0.0, 600.0, 0.05)
    across = 40e6 * np.sin(np.pi * t) / 2.1e11
    warm = 10.0 + 2.0 * np.sin(2 * np.pi * t / 600.0)
    gauges = [across, 0.5 * (1.0 - 0.3) * across, -0.3 * across]
    rows = [t, *(1e6 * g + 12.0 * (warm - 10.0) for g in gauges), warm]
    rows[1][5000:] += 90.0
    path = tmp_path / "rosette.csv"
    np.savetxt(
        path, np.stack(rows, axis=1), delimiter=",", header="time_s,a,b_ue,c,t_steel", comments="", fmt="%.9g"
    )
    return path


def test_a_rosette_has_the_cycles_of_its_stress(rosette: Path) -> None:
    """Uniaxial stress of ±40 MPa: the jump and the heat are taken out and said."""
    three = ("--column", "a", "--column", "b_ue", "--column", "c", "--angles", "0,45,90")
    found = answer("strain", str(rosette), *three, "--temperature", "t_steel", "--per-kelvin", "12")
    assert found["largest_range_mpa"] == pytest.approx(80.0, rel=5e-3)
    assert [len(one["jumps_um_m"]) for one in found["gauges"]] == [1, 0, 0]
    assert found["gauges"][0]["jumps_um_m"][0] == pytest.approx(90.0, rel=0.02)
    assert "1 jumps of its zero" in found["warnings"][0]
    hot = answer("strain", str(rosette), *three, "--scf", "2")
    assert hot["largest_range_mpa"] > 160.0
    alone = answer("strain", str(rosette), "--column", "a", "--temperature", "t_steel")
    assert alone["gauges"][0]["per_kelvin_um_m"] == pytest.approx(12.0, rel=0.02)
    assert alone["largest_range_mpa"] == pytest.approx(80.0, rel=0.02)
    assert "real stress" in alone["warnings"][1]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--column", "d"), "t_steel"),
        (("--column", "a", "--column", "c"), "three or four"),
        (("--column", "a", "--column", "b_ue", "--column", "c"), "angle for each gauge"),
        (("--column", "a", "--angles", "45"), "along itself"),
        (("--column", "a", "--column", "b_ue", "--column", "c", "--angles", "0,0,90"), "rosette"),
        (("--column", "a", "--unit", "m/m"), "no steel resists"),
        (("--column", "b_ue", "--unit", "m/m"), "states"),
        (("--column", "a", "--per-kelvin", "12"), "--temperature"),
        (("--column", "a", "--poisson", "0.7"), "poisson"),
        (("--column", "a", "--curve", "Q"), "S-N curve"),
    ],
)
def test_gauges_that_cannot_be_are_refused(arguments: tuple[str, ...], said: str, rosette: Path) -> None:
    found = run("strain", str(rosette), *arguments)
    assert found.exit_code == 2
    assert said in found.stderr and "Traceback" not in found.stderr


def test_an_unknown_first_word_is_no_twin() -> None:
    found = run("strss", "leg.csv", "--column", "leg")
    assert found.exit_code == 2
    assert "did you mean 'stress'?" in found.stderr and "Traceback" not in found.stderr


def test_a_joint_has_the_keys_of_the_contract(tmp_path: Path) -> None:
    brace = {"diameter_m": 0.6, "thickness_m": 0.02, "angle_deg": 45.0}
    said = {"chord_diameter_m": 1.2, "chord_thickness_m": 0.04, "chord_length_m": 9.0, "fixity": 0.7}
    path = tmp_path / "joint.json"
    path.write_text(json.dumps(said | {"class": "y", "braces": [brace]}))
    (row,) = answer("scf", str(path))["braces"]
    assert set(row["axial"]) == {"chord_saddle", "chord_crown", "brace_saddle", "brace_crown"}
    assert set(row["in_plane"]) == {"chord_crown", "brace_crown"}
    assert set(row["out_of_plane"]) == {"chord_saddle", "brace_saddle"}
    path.write_text(json.dumps(said | {"class": "k", "braces": [brace, brace], "gap_m": 0.1}))
    found = answer("scf", str(path))
    assert found["warnings"] == []
    assert set(found["braces"][0]["axial"]) == set(found["braces"][0]["out_of_plane"]) == {"chord", "brace"}
    assert "stress concentration" in run("scf", str(path)).stdout


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"chord_thickness_m": -0.04}, "chord_thickness_m"),
        ({"chord_diameter_m": 0.5}, "diameter_m"),
        ({"class": "dk"}, "class"),
        ({"class": "kt"}, "gaps_m"),
        ({"chord_diameter_m": 1200.0, "chord_thickness_m": 40.0}, "unit"),
    ],
)
def test_a_joint_that_cannot_be_is_refused(changed: dict[str, object], said: str, tmp_path: Path) -> None:
    joint = {
        "class": "y", "chord_diameter_m": 1.2, "chord_thickness_m": 0.04, "chord_length_m": 9.0,
        "braces": [{"diameter_m": 0.6, "thickness_m": 0.02, "angle_deg": 45.0}],
    }  # fmt: skip
    path = tmp_path / "joint.json"
    path.write_text(json.dumps(joint | changed))
    found = run("scf", str(path))
    assert found.exit_code == 2
    assert said in found.stderr and "Traceback" not in found.stderr


def test_a_scenario_tells_the_life_of_every_weld(tmp_path: Path) -> None:
    scenario = tmp_path / "short.yaml"
    scenario.write_text(
        "structure: jacket15\nfoundation: jacket15\npile_model: members\nrotor: {state: parked}\n"
        "wind: {speed_m_s: 12, seed: 1}\ntime: {duration_s: 60, step_s: 0.05}\n"
    )
    details = tmp_path / "details.yaml"
    details.write_text("details: [{name: base flange, member: tower_1, position: 0, curve: F, scf: 1.3}]")
    found = answer("scenario", str(scenario), "--details", str(details))
    welds = found["welds"]
    assert {one["kind"] for one in welds} == {"butt weld", "detail"}
    (flange,) = (one for one in welds if one["kind"] == "detail")
    assert (flange["weld"], flange["curve"], flange["scf"]) == ("base flange", "F", 1.3)
    assert flange["damage"] == max(flange["damage_by_point"]) > 0.0
    piles = [one for one in welds if one["weld"].startswith("girth at")]
    assert all(one["scf"] == 1.0 if one in piles else one["scf"] > 1.0 for one in welds)
    # a pile bends most in the ground's first metres, and hardly at its tip
    by_depth = sorted(piles, key=lambda one: -float(one["z_m"]))
    largest = [
        max(row["damage"] for row in half)
        for half in (by_depth[: len(piles) // 2], by_depth[len(piles) // 2 :])
    ]
    assert len(piles) > 40 and largest[0] > 100.0 * largest[1] > 0.0
    joints = found["joints"]
    lives = [row["life_years"] for row in joints if row["life_years"] is not None]
    assert lives == sorted(lives) and len(joints) > 100
    first = joints[0]
    assert first["damage"] == max(first["damage_by_point"]) and len(first["damage_by_point"]) == 8
    low, high = first["damage_interval_90"]
    assert low < high and sum(first["variance_shares"].values()) == pytest.approx(1.0)
    assert {row["environment"] for row in joints} == {"air", "cathodic", "free-corrosion"}
    assert any("crack growth" in one["what"] for one in found["left_out"])


def test_details_that_cannot_be_are_refused_before_anything_is_simulated(tmp_path: Path) -> None:
    details = tmp_path / "details.yaml"
    details.write_text("details: [{name: grout, member: leg, position: 0, curve: Q}]")
    found = run("scenario", "parked", "--details", str(details))
    assert found.exit_code == 2
    assert "S-N curve" in found.stderr and "Traceback" not in found.stderr


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of two accelerometers and the wind."""
    t = np.arange(0.0, 120.0, 0.05)
    rows = [t, np.sin(1.1 * t), np.cos(1.2 * t), 12.0 + np.sin(0.1 * t)]
    path = tmp_path_factory.mktemp("motion") / "motion.csv"
    np.savetxt(
        path, np.stack(rows, axis=1), delimiter=",", header="time_s,acc_x,acc_y,wind_speed", comments=""
    )
    return path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("no_such_twin", "{motion}"), "no_such_twin"),
        (("simulated", "no_such_record.parquet"), "no_such_record"),
        (("simulated", "{motion}"), "acc_x"),
        (("simulated", "{motion}", "--curve", "Q"), "S-N curve"),
        (("simulated", "{motion}", "--draws", "0"), "draws"),
        (("simulated", "{motion}", "--report", "life.txt"), "life.txt"),
        (("simulated", "{motion}", "--details", "{details}"), "details.0.member"),
        # a twin without data of its own is updated by the record
        (("{bare}", "{motion}", "--details", "{details}"), "details.0.member"),
        (("record", "simulated"), "RECORD"),
    ],
)
def test_a_record_that_does_not_fit_is_refused_before_anything_is_updated(
    arguments: tuple[str, ...], said: str, motion: Path, tmp_path: Path
) -> None:
    details = tmp_path / "details.yaml"
    details.write_text("details: [{name: flange, member: twer_1, position: 0, curve: F}]")
    bare = tmp_path / "bare.yaml"
    bare.write_text("structure: jacket15\nsupport: {law: kelvin-voigt}\n")
    found = run(*(text.format(motion=motion, details=details, bare=bare) for text in arguments))
    assert found.exit_code == 2
    assert said in found.stderr and "Traceback" not in found.stderr


def test_a_site_has_lives_by_bin_and_variant_and_writes_its_basis(tmp_path: Path) -> None:
    scenario = {
        "structure": "jacket15",
        "support": "kelvin-voigt:k=1.2e9,c=2e7",
        "damping": {"rayleigh": {"ratio": 0.006, "frequency_hz": 0.3}},
        "water": {"depth_m": 72.0},
        "wind": {"turbulence": "B"},
        "rotor": {"data": "iea15"},
        "time": {"duration_s": 40.0, "step_s": 0.1},
    }
    parked = {"share": 0.8, "state": "parked", "speed_m_s": 14.0, "hs_m": 2.0, "tp_s": 7.0, "seeds": 1}
    site = {"scenario": "s.yaml", "bins": [parked], "variants": {"pinned": {"support": "pinned"}}}
    (tmp_path / "s.yaml").write_text(json.dumps(scenario))
    (tmp_path / "site.yaml").write_text(json.dumps(site | {"age_years": 20.0, "years": 25.0}))
    page = tmp_path / "basis.md"
    found = answer("site", str(tmp_path / "site.yaml"), "--basis", str(page), "--design-factor", "2")
    worst = found["joints"][0]
    assert worst["life_years"] == pytest.approx(0.5 / worst["damage_per_year"])
    assert worst["life_years_by_variant"]["as stated"] == pytest.approx(worst["life_years"])
    assert set(worst["life_years_by_variant"]) == {"as stated", "pinned"}
    assert len(worst["reliability_index_by_year"]) == 6 and worst["damage_by_state"] == {"parked": 1.0}
    assert sum(worst["variance_shares"].values()) == pytest.approx(1.0)
    said = " ".join(found["warnings"])
    assert "80 % of all time" in said and "one simulation" in said
    assert found["design_basis"]["inputs"][1]["sha256"] in page.read_text()
    (tmp_path / "site.yaml").write_text(json.dumps(site | {"bins": [parked | {"share": 1.2}]}))
    refused = run("site", str(tmp_path / "site.yaml"))
    assert refused.exit_code == 2 and "bins.0.share" in refused.stderr
