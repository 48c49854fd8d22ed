"""``jackettwin fatigue forces``: another program's section forces give the lives that its own would."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from numpy.testing import assert_allclose

from jackettwin.cli import main
from jackettwin.decks import member_outputs, read_structure, write_subdyn
from jackettwin.simulate import given_sections
from jackettwin.simulate.section_series import ForceSeries, write_force_series
from jackettwin.structure import assemble

SCENARIO = (
    "structure: jacket15\nfoundation: jacket15\nrotor: {state: parked}\n"
    "wind: {speed_m_s: 12, seed: 1}\ntime: {duration_s: 60, step_s: 0.05}\n"
)


def run(*arguments: str):
    return CliRunner().invoke(main, list(arguments))


def answer(*arguments: str) -> dict:
    found = run(*arguments, "--json")
    assert found.exit_code == 0, found.stderr
    return json.loads(found.stdout)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, Path]:
    """Lives of a scenario, and the forces at both ends of all members."""
    folder = tmp_path_factory.mktemp("forces")
    scenario, forces = folder / "short.yaml", folder / "forces.parquet"
    scenario.write_text(SCENARIO)
    names = ",".join(m.name for m in read_structure("jacket15").members)
    answer(
        "simulate",
        str(scenario),
        "--section-forces",
        str(forces),
        "--members",
        names,
        "--out",
        str(folder / "r.parquet"),
    )
    return answer("fatigue", "scenario", str(scenario)), forces


def by_weld(document: dict) -> dict[tuple[str, ...], float]:
    return {(row["joint"], row["brace"], row["side"]): row["damage"] for row in document["joints"]}


def test_forces_of_a_simulation_give_its_own_damage(simulated: tuple[dict, Path]) -> None:
    whole, path = simulated
    found = answer("fatigue", "forces", "jacket15", str(path))
    own, theirs = by_weld(whole), by_weld(found)
    assert found["unknown"] == [] and own.keys() == theirs.keys()
    assert_allclose([theirs[key] for key in own], list(own.values()), rtol=1e-9)
    # butt welds stand at members' ends, where forces are given and not interpolated
    tubes = {row["weld"]: row["damage"] for row in whole["welds"]}
    assert_allclose([row["damage"] for row in found["welds"]], [tubes[r["weld"]] for r in found["welds"]])


def test_joints_without_all_of_their_braces_are_named(simulated: tuple[dict, Path], tmp_path: Path) -> None:
    whole, path = simulated
    table = pq.read_table(path)
    joint = next(row["joint"] for row in whole["joints"] if row["damage"] > 0.0)
    braces = {row["brace"] for row in whole["joints"] if row["joint"] == joint}
    kept = ["time_s", *(n for n in table.column_names if n.split(".")[0] in braces)]
    few = tmp_path / "few.parquet"
    pq.write_table(table.select(kept), few)
    found = answer("fatigue", "forces", "jacket15", str(few))
    assert joint in {row["joint"] for row in found["joints"]} and len(found["unknown"]) > 20
    own = by_weld(whole)
    assert_allclose(list(by_weld(found).values()), [own[key] for key in by_weld(found)], rtol=1e-9)
    without = table.select([n for n in kept if not n.endswith("bending_z_nm")])
    pq.write_table(without, few)
    refused = run("fatigue", "forces", "jacket15", str(few))
    assert refused.exit_code == 2 and "without bending_z" in refused.stderr


def test_kilonewtons_gaps_and_openfasts_binary(simulated: tuple[dict, Path], tmp_path: Path) -> None:
    whole, path = simulated
    table = pq.read_table(path)
    names = table.column_names[1:]
    values = np.array([table[name].to_numpy() for name in names])
    binary = tmp_path / "forces.outb"
    write_force_series(ForceSeries(tuple(names), values, 0.05), binary)
    found, own = by_weld(answer("fatigue", "forces", "jacket15", str(binary))), by_weld(whole)
    worst = sorted(own, key=lambda key: -own[key])[:10]
    # 16-bit integers round a range of one in ten thousand
    assert_allclose([found[key] for key in worst], [own[key] for key in worst], rtol=0.01)
    values[:, 400:500] = np.nan
    kilo = [n.replace("_n", "_kn") if n.endswith("_n") else n.replace("_nm", "_knm") for n in names]
    columns = {"time_s": table["time_s"], **dict(zip(kilo, 1e-3 * values, strict=True))}
    gap = tmp_path / "gap.parquet"
    pq.write_table(pa.table(columns), gap)
    bridged = answer("fatigue", "forces", "jacket15", str(gap))
    assert "incomplete" in bridged["warnings"][0]
    assert by_weld(bridged)[worst[0]] == pytest.approx(own[worst[0]], rel=0.4)
    # kilonewtons and more under the names of newtons, and the other way round
    for size in (1e-3, 1e6):
        wrong = {"time_s": table["time_s"], **dict(zip(names, size * values, strict=True))}
        pq.write_table(pa.table(wrong), gap)
        refused = run("fatigue", "forces", "jacket15", str(gap))
        if size < 1.0:
            assert refused.exit_code == 0 and "are the forces in the units" in refused.stderr.replace(
                "\n", " "
            )
    assert refused.exit_code == 2 and "no steel resists" in refused.stderr


def test_subdyns_channels_stand_where_its_deck_says(tmp_path: Path) -> None:
    """A moment about an axis of the world is the same, whose local axes it was told in."""
    structure = read_structure("jacket15")
    deck = tmp_path / "deck.dat"
    write_subdyn(structure, deck)
    names = [m.name for m in structure.bars]
    brace = next(i for i, m in enumerate(structure.bars) if m.name.startswith("brace"))
    text = deck.read_text()
    at = text.index("           0   NMOutputs")
    deck.write_text(
        f"{text[:at]}1   NMOutputs\nMemberID NOutCnt NodeCnt\n(-) (-) (-)\n{brace + 1} 2 1 2\nEND\n"
    )
    read = read_structure(deck)
    outputs = member_outputs(deck, read)
    assert [(one.prefix, one.member, one.position) for one in outputs] == [
        ("M1N1", str(brace + 1), 0.0),
        ("M1N2", str(brace + 1), 1.0 if (read.subdivide or 1) == 1 else 1.0 / read.subdivide),
    ]
    channels = ["M1N1FKze", "M1N1MKxe", "M1N1MKye"]
    data = np.array([[1.0, 2.0], [3.0, 0.0], [0.0, 5.0]])
    assembly = assemble(read)
    given = given_sections(assembly, channels, data, outputs[:1])
    axial, y, z = given.forces[str(brace + 1)][0]
    mine = int(
        np.flatnonzero(assembly.mesh.member == [m.name for m in read.members].index(str(brace + 1)))[0]
    )
    world = np.outer(assembly.mesh.axes[mine][1], y) + np.outer(assembly.mesh.axes[mine][2], z)
    assert_allclose(axial, data[0])
    assert_allclose(world, outputs[0].axes.T @ data[1:], atol=1e-12)
    assert names[brace] and given.known[mine].tolist()[0]


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"x": [0.0, 1.0]}, "no column is a section force"),
        ({"legg.start.axial_n": [0.0, 1.0]}, "legg"),
        ({"leg_1_bay_1.start.axial_nm": [0.0, 1.0]}, "not a unit of this"),
        ({"leg_1_bay_1.start.axial_n": [0.0, 1.0]}, "without bending_y, bending_z"),
        (
            {f"leg_1_bay_1.start.{p}": [0.0, 1.0] for p in ("axial_n", "bending_y_nm", "bending_z_nm")},
            "all braces",
        ),
    ],
)
def test_what_is_no_section_is_refused(columns: dict[str, list[float]], said: str, tmp_path: Path) -> None:
    path = tmp_path / "forces.parquet"
    pq.write_table(pa.table({"time_s": [0.0, 0.1], **columns}), path)
    found = run("fatigue", "forces", "jacket15", str(path))
    assert found.exit_code == 2
    assert said in found.stderr and "Traceback" not in found.stderr
