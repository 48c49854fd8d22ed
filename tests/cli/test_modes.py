"""``jackettwin modes``: the contract's keys, numbers, and refusals."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main


def run(*arguments: str):
    return CliRunner().invoke(main, ["modes", *arguments])


def document(*arguments: str) -> dict:
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def test_json_has_the_keys_of_the_contract() -> None:
    found = document("jacket15", "--number", "6")
    assert {"mass_kg", "center_of_mass_m", "n_dof", "modes", "real_poles_rad_s"} <= set(found)
    frequencies = [mode["frequency_hz"] for mode in found["modes"]]
    assert frequencies == pytest.approx([0.1832, 0.1859, 0.5720, 0.7489, 0.7941, 0.9145], rel=2e-3)
    assert [mode["mode"] for mode in found["modes"]] == [1, 2, 3, 4, 5, 6]
    assert found["mass_kg"] == pytest.approx(3578e3, rel=2e-4)


def test_thesis_point_1_of_kelvin_voigt() -> None:
    """Tables 8.1 and 8.2: f within 0.6 %, ζ1 within 2 %, ζ4 within 2.5 %."""
    found = document("jacket15", "--support", "kelvin-voigt:k=2.5e9,c=7.6e8", "--rayleigh", "0.01,0.1832")
    by_number = {mode["mode"]: mode for mode in found["modes"]}
    assert [by_number[m]["frequency_hz"] for m in (1, 2, 4)] == pytest.approx(
        [0.1812, 0.1845, 0.7362], rel=6e-3
    )
    assert by_number[1]["damping_ratio"] == pytest.approx(0.01277, rel=0.02)
    assert by_number[4]["damping_ratio"] == pytest.approx(0.04237, rel=0.025)
    assert len(found["real_poles_rad_s"]) == 12


def test_a_nearly_locked_damper_does_not_shift_the_numbering() -> None:
    """Table 8.3: damped f near pinned, undamped far below."""
    found = document("jacket15", "--support", "kelvin-voigt:k=1.1e8,c=1e11")
    first = found["modes"][0]
    assert first["mode"] == 1
    assert first["frequency_hz"] == pytest.approx(0.1827, rel=6e-3)
    assert first["undamped_frequency_hz"] == pytest.approx(0.1506, rel=6e-3)


def test_the_table_is_for_people() -> None:
    result = run("jacket15", "--number", "3")
    assert result.exit_code == 0
    assert "side_side_1" in result.stdout
    assert "0.1832" in result.stdout
    assert "support: the structure's own: 4 nodes held in x, y, z" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["jacket51"], "did you mean 'jacket15'"),
        (["gone.yaml"], "no such structure file"),
        (["jacket15", "--support", "kelvinvoigt:k=1,c=1"], "did you mean 'kelvin-voigt'"),
        (["jacket15", "--support", "kelvin-voigt:k=1"], "argument is missing"),
        (["jacket15", "--support", "kelvin-voigt:k=-1,c=1"], "must not be negative"),
        (["jacket15", "--support", "kelvin-voigt:k=x,c=1"], "not a finite number"),
        (["jacket15", "--rayleigh", "0.01"], "not ZETA,F_HZ"),
        (["jacket15", "--number", "0"], "Invalid value for '--number'"),
        (["jacket15", "--nonsense"], "No such option"),
    ],
)
def test_bad_input_exits_2_with_one_message(arguments: list[str], message: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr.replace("\n", " ")
    assert "Traceback" not in result.stderr
    assert result.stdout == ""


def test_free_motions_are_no_modes(tmp_path: Path) -> None:
    spar = tmp_path / "spar.yaml"
    spar.write_text(
        "nodes: {a: [0, 0, 0], b: [0, 0, 50], c: [0, 0, 100]}\n"
        "materials: {steel: {youngs_modulus_pa: 2.1e11, poisson_ratio: 0.3, density_kg_m3: 7850}}\n"
        "sections: {tube: {outer_diameter_m: 4, thickness_m: 0.05}}\n"
        "members:\n"
        "  - {name: ab, nodes: [a, b], section: tube, material: steel}\n"
        "  - {name: bc, nodes: [b, c], section: tube, material: steel}\n"
    )
    result = document(str(spar), "--number", "2", "--subdivide", "8")
    assert result["free_motions"] == 6
    assert len(result["real_poles_rad_s"]) == 0
    # a free beam's first bending: (4.7300/L)² √(EI/ρA)/2π
    ei_over_m = 2.1e11 / 7850 * (4.0**2 + 3.9**2) / 16.0
    f = (4.73004 / 100.0) ** 2 * ei_over_m**0.5 / (2 * 3.141592653589793)
    for mode in result["modes"]:
        assert abs(mode["frequency_hz"] / f - 1.0) < 1e-4  # sixteen elements


def test_damping_by_mode_and_at_two_frequencies() -> None:
    """On pinned feet the named modes have their ratios, the others those of the two points."""
    steel = ("--rayleigh", "0.003,0.18,0.004,0.75", "--mode-damping", "1=0.005,4=0.01")
    found = document("jacket15", "--support", "pinned", *steel, "--number", "5")["modes"]
    modes = {m["mode"]: m for m in found}
    assert abs(modes[1]["damping_ratio"] / 0.005 - 1.0) < 1e-6
    assert abs(modes[4]["damping_ratio"] / 0.01 - 1.0) < 1e-6
    # α, β of the two points by hand
    w = [2 * 3.141592653589793 * f for f in (0.18, 0.75, modes[2]["undamped_frequency_hz"])]
    beta = 2 * (0.004 * w[1] - 0.003 * w[0]) / (w[1] ** 2 - w[0] ** 2)
    alpha = 2 * 0.003 * w[0] - beta * w[0] ** 2
    assert abs(modes[2]["damping_ratio"] / (0.5 * (alpha / w[2] + beta * w[2])) - 1.0) < 1e-6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1=x", "--mode-damping: not MODE=ZETA"),
        ("one=0.01", "--mode-damping: not MODE=ZETA"),
        ("1=1.5", "out of range"),
    ],
)
def test_wrong_damping_by_mode_is_refused(text: str, message: str) -> None:
    result = CliRunner().invoke(main, ["modes", "jacket15", "--mode-damping", text])
    assert result.exit_code == 2, result.output
    assert message in " ".join(result.stderr.split())


def test_what_is_left_out_is_said() -> None:
    """Each option takes its own line away."""

    def left(*options: str) -> str:
        answer = CliRunner().invoke(main, ["modes", "jacket15", "--number", "1", *options, "--json"])
        assert answer.exit_code == 0, answer.output
        return " ".join(one["what"] for one in json.loads(answer.stdout)["left_out"])

    bare, told = left(), left("--gravity", "--rayleigh", "0.01,0.18")
    assert "P-Δ" in bare and "damping of the steel" in bare
    assert "P-Δ" not in told and "damping of the steel" not in told and "water" in told
