"""Section forces and reactions as series, out to other programs and in from them."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.errors import InputError
from jackettwin.records.readers.openfast import read_binary
from jackettwin.simulate import force_series, read_scenario, scenario_uses, write_force_series

PUSH = "time_s,tower_top.fx_n,tower_top.fz_n\n0,0,0\n5,1e6,-2e6\n60,1e6,-2e6\n"


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    """A tower that is pushed slowly, and stays pushed."""
    (tmp_path / "push.csv").write_text(PUSH)
    path = tmp_path / "push.yaml"
    path.write_text(
        "structure: jacket15\nsupport: kelvin-voigt:k=2.5e9,c=7.6e8\nforces: push.csv\n"
        "damping: {rayleigh: {ratio: 0.2, frequency_hz: 0.2}}\n"
        "time: {duration_s: 40, step_s: 0.1, discard_s: 0}\n"
    )
    return path


def test_reactions_balance_what_pushes_and_weighs(scenario: Path) -> None:
    """At rest in the end: Σ F = push and weight, and the push's moment about the feet by their lever arms."""
    found = force_series(read_scenario(scenario))
    last = dict(zip(found.names, found.values[:, -30:].mean(axis=1), strict=True))
    first = dict(zip(found.names, found.values[:, 0], strict=True))

    def total(values: dict[str, float], part: str) -> float:
        return sum(v for name, v in values.items() if name.endswith(f".reaction.{part}"))

    assert total(last, "fx_n") == pytest.approx(1e6, rel=0.02)
    # the first instant is rest under the weight: jacket15 weighs some 2,500 t
    assert total(last, "fz_n") - total(first, "fz_n") == pytest.approx(-2e6, rel=0.02)
    assert total(first, "fz_n") < -1.5e7
    assert abs(total(last, "fy_n")) < 1e3


def test_series_peak_where_the_check_s_envelope_does(scenario: Path) -> None:
    chosen = read_scenario(scenario)
    worst = next(one for one in scenario_uses(chosen).members if one.member == "tower_1")
    found = force_series(chosen, ["tower_1"])
    bending = np.hypot(*(found.values[found.names.index(f"tower_1.start.bending_{k}_nm")] for k in "yz"))
    at = worst.worst.end_forces[0]
    assert bending.max() == pytest.approx(np.hypot(at[4], at[5]), rel=1e-6)


def test_files_hold_the_series(scenario: Path, tmp_path: Path) -> None:
    found = force_series(read_scenario(scenario), ["tower_1"])
    write_force_series(found, tmp_path / "forces.parquet")
    table = pq.read_table(tmp_path / "forces.parquet")
    assert table.column_names == ["time_s", *found.names]
    np.testing.assert_array_equal(table.column("tower_1.end.axial_n").to_numpy(), found.values[6])
    write_force_series(found, tmp_path / "forces.outb")
    again = read_binary(tmp_path / "forces.outb")
    assert again.names == found.names
    assert again.times_s is not None
    np.testing.assert_allclose(np.diff(again.times_s), found.step_s)
    # sixteen bits of each channel's range, and single precision of its offset
    span = np.ptp(found.values, axis=1) + 1e-6 * np.abs(found.values).max(axis=1)
    assert (np.abs(again.data - found.values).max(axis=1) <= 2e-5 * span + 1e-6).all()
    assert {
        again.channels["tower_1.start.axial_n"].unit,
        again.channels["tower_1.start.torsion_nm"].unit,
    } == {
        "(N)",
        "(N-m)",
    }
    with pytest.raises(InputError, match="unknown kind of file"):
        write_force_series(found, tmp_path / "forces.xlsx")


OUTPUT = """made by another program

Time TwrBsFxt TwrBsMyt Wind1VelX
(s) (kN) (kN-m) (m/s)
0.0 0.0 0.0 8.0
10.0 500.0 0.0 8.0
15.0 1000.0 2000.0 8.0
70.0 1000.0 2000.0 8.0
"""


def test_another_program_s_interface_loads_come_in(tmp_path: Path) -> None:
    (tmp_path / "run.out").write_text(OUTPUT)
    path = tmp_path / "interface.yaml"
    text = (
        "structure: jacket15\nsupport: clamped\nforces: {file: run.out, node: tp_top, discard_s: 10, "
        "channels: {fx_n: TwrBsFxt, my_n_m: TwrBsMyt}}\ntime: {duration_s: 40, step_s: 0.1}\n"
    )
    path.write_text(text)
    forces = read_scenario(path).forces
    assert forces is not None and forces.nodes == ("tp_top",)
    np.testing.assert_allclose(forces.at(np.array([0.0, 2.5, 20.0]))[:, 0, 0], [5e5, 7.5e5, 1e6])
    np.testing.assert_allclose(forces.at(np.array([20.0]))[0, 0, 4], 2e6)
    for old, new, message in (
        ("TwrBsFxt,", "TwrBsFxp,", "no such channel|channel"),
        ("fx_n: TwrBsFxt", "fx_n: Wind1VelX", "wrong unit for force"),
        ("tp_top", "tp_tip", "tp_tip"),
        ("run.out", "gone.out", "no such file"),
        ("discard_s: 10", "discard_s: 100", "nothing is left"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(InputError, match=message):
            read_scenario(path)


def test_the_command_writes_them(scenario: Path, tmp_path: Path) -> None:
    def run(*arguments: str):
        return CliRunner().invoke(main, ["simulate", str(scenario), "--out", str(tmp_path / "r"), *arguments])

    path = tmp_path / "f.outb"
    done = run("--section-forces", str(path), "--members", "tower_1", "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["section_forces"] == str(path)
    assert "tower_1.start.axial_n" in read_binary(path).names
    for arguments, message in (
        (("--members", "tower_1"), "needs --section-forces"),
        (("--section-forces", str(path), "--members", "tower_99"), "tower_99"),
    ):
        refused = run(*arguments)
        assert refused.exit_code == 2
        assert message in refused.stderr
