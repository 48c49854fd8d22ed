"""Forces below the interface from its motion alone, against the whole structure's own scenario."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.errors import InputError
from jackettwin.records.readers.openfast import read_binary
from jackettwin.response import INTERFACE
from jackettwin.simulate import (
    InterfaceMotion,
    Scenario,
    read_interface_motion,
    read_scenario,
    recovered,
)
from jackettwin.simulate.interface_motion import MOTIONS
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.recovery import internal_motion
from jackettwin.simulate.section_series import ForceSeries, series_of

MEMBERS = ("leg_1_bay_1", "brace_2_2_1", "leg_3_bay_4", "brace_4_4_3", "leg_2_bay_2")
SETTLED = 200


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("recovery") / "storm.yaml"
    path.write_text(
        "structure: jacket15\nsupport: kelvin-voigt:k=2.5e9,c=7.6e8\nwater: {depth_m: 50}\n"
        "waves: {type: jonswap, hs_m: 6, tp_s: 10, seed: 1}\n"
        "damping: {rayleigh: {ratio: 0.01, frequency_hz: 0.3}}\n"
        "time: {duration_s: 60, step_s: 0.05, discard_s: 0}\n"
    )
    return read_scenario(path)


@pytest.fixture(scope="module")
def whole(scenario: Scenario) -> tuple[ForceSeries, InterfaceMotion]:
    """Return the series of the whole structure, and the motion of its interface."""
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    (top,) = scenario.asset.structure.interface_nodes
    blocks = list(deflections(scenario, motion))
    moved = np.vstack([u[:, assembly.dofs(top)] for u, _ in blocks])
    return series_of(assembly, blocks, MEMBERS, motion.step_s), InterfaceMotion(moved, motion.step_s)


def apart(found: ForceSeries, wanted: ForceSeries) -> dict[str, float]:
    """Return each channel's difference over the largest spread of its kind: a brace has little of some."""
    spread = (wanted.values[:, SETTLED:]).std(axis=1)
    kinds = [name.rpartition(".")[2] for name in wanted.names]
    scale = {kind: max(s for k, s in zip(kinds, spread, strict=True) if k == kind) for kind in kinds}
    error = np.sqrt(((found.values - wanted.values)[:, SETTLED:] ** 2).mean(axis=1))
    assert found.names == wanted.names
    return {name: float(e / scale[k]) for name, e, k in zip(found.names, error, kinds, strict=True)}


def test_members_bear_what_they_do_in_the_whole_structure(scenario: Scenario, whole) -> None:
    """Both truncate their modes: feet on springs without rotation have moments of rounding alone."""
    wanted, motion = whole
    found = recovered(scenario, motion, MEMBERS).series
    forces = {n: e for n, e in apart(found, wanted).items() if "reaction.m" not in n}
    assert len(forces) == 12 * len(MEMBERS) + 3 * 4
    assert np.median(list(forces.values())) < 3e-3
    assert max(forces.values()) < 0.02
    # vibration of the foundation itself is part of it, and so are the waves
    quiet = recovered(without_waves(scenario), motion, MEMBERS).series
    assert max(apart(quiet, wanted).values()) > 0.2


def without_waves(scenario: Scenario) -> Scenario:
    return replace(scenario, sea=replace(scenario.sea, waves=None))


def test_pinned_feet_bear_no_moment(whole) -> None:
    """Waves bend a member between its joints: the model's few modes alone left its ends as if clamped."""
    wanted, _ = whole
    spread = dict(zip(wanted.names, wanted.values.std(axis=1), strict=True))
    legs = max(s for n, s in spread.items() if n.startswith("leg") and "bending" in n)
    assert max(s for n, s in spread.items() if "reaction.m" in n) < 0.05 * legs


def test_a_slow_motion_is_static(scenario: Scenario) -> None:
    """Internal coordinates do not answer, whatever the interface does slowly; a fast one moves them."""
    element = recovered(
        without_waves(scenario), InterfaceMotion(np.zeros((3, 6)), 1.0), MEMBERS[:1], number=20
    ).element
    t = np.arange(0.0, 200.0, 0.5)
    for period, moves in ((2000.0, False), (4.0, True)):
        swayed = np.zeros((t.size, 6))
        swayed[:, 0] = 0.1 * np.sin(2.0 * np.pi * t / period)
        q = internal_motion(element, InterfaceMotion(swayed, 0.5), np.zeros((t.size, 20)))
        # the energy inside over that of the interface
        inside = np.einsum("ti,ij,tj->t", q, element.K[INTERFACE:, INTERFACE:], q).max()
        share = inside / (element.interface_stiffness[0, 0] * 0.1**2)
        assert (share > 1e-4) == moves


def test_internal_motion_meets_the_closed_form(scenario: Scenario) -> None:
    """Swayed with e^{iωt}: q = (K − ω²M + iωC)⁻¹ (ω² M_ib − iω C_ib) x_b."""
    element = recovered(
        without_waves(scenario), InterfaceMotion(np.zeros((3, 6)), 1.0), MEMBERS[:1], number=20
    ).element
    b, i, omega = slice(INTERFACE), slice(INTERFACE, None), 2.0 * np.pi * 0.4
    t = np.arange(0.0, 400.0, 0.05)
    direction = np.array([0.1, 0.02, 0.0, 1e-3, -2e-3, 0.0])
    q = internal_motion(
        element, InterfaceMotion(np.outer(np.cos(omega * t), direction), 0.05), np.zeros((t.size, 20))
    )
    F = element.K[i, i] - omega**2 * element.M[i, i] + 1j * omega * element.C[i, i]
    known = np.linalg.solve(F, (omega**2 * element.M[i, b] - 1j * omega * element.C[i, b]) @ direction)
    wanted = (known * np.exp(1j * omega * t[:, None])).real
    # a damped start dies out; straight lines between samples lower an amplitude by (ωh)²/12
    error = np.abs(q - wanted)[-1000:].max(axis=0)
    assert error.max() < 5e-3 * np.abs(wanted).max()


def test_the_command_reads_openfast_and_csv(scenario: Scenario, whole, tmp_path: Path) -> None:
    _, motion = whole
    text = "structure: jacket15\nsupport: kelvin-voigt:k=2.5e9,c=7.6e8\n"
    (tmp_path / "jacket.yaml").write_text(text)
    names = ("PtfmSurge", "PtfmSway", "PtfmHeave", "PtfmRoll", "PtfmPitch", "PtfmYaw")
    units = ("(m)",) * 3 + ("(deg)",) * 3
    t = motion.step_s * np.arange(300)
    rows = np.column_stack([t, motion.values[:300] * np.repeat([1.0, 180.0 / np.pi], 3)])
    lines = ["", "  ".join(("Time", *names)), "  ".join(("(s)", *units))]
    lines += ["  ".join(f"{v:.9e}" for v in row) for row in rows]
    (tmp_path / "run.out").write_text("\n".join(lines))
    csv = ["time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad"]
    csv += [",".join(f"{v:.12g}" for v in (at, *row)) for at, row in zip(t, motion.values, strict=False)]
    (tmp_path / "run.csv").write_text("\n".join(csv))
    tables = []
    for source, out in (("run.out", "a.parquet"), ("run.csv", "b.outb")):
        arguments = ["recover", str(tmp_path / "jacket.yaml"), str(tmp_path / source), "--modes", "20",
                     "--members", "leg_1_bay_1", "--out", str(tmp_path / out), "--json"]  # fmt: skip
        answer = CliRunner().invoke(main, arguments)
        assert answer.exit_code == 0, answer.output
        document = json.loads(answer.stdout)
        assert document["coordinates"] == 26 and document["left_out"]
        tables.append(document["channels"])
    assert [c["max"] for c in tables[0]] == pytest.approx([c["max"] for c in tables[1]], rel=1e-4, abs=5.0)
    first = pq.read_table(tmp_path / "a.parquet")["leg_1_bay_1.start.axial_n"].to_numpy()
    again = read_binary(tmp_path / "b.outb")
    np.testing.assert_allclose(again.data[0], first, atol=1e-4 * np.ptp(first) + 1.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time_s,x_m\n0,0\n1,0\n2,0\n", "columns are missing"),
        (
            "time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0,0,0,0,0,0,0\n1,0,0,0,0,0,0\n3,0,0,0,0,0,0\n",
            "even steps",
        ),
        ("time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0,0,0,0,0,0,0\n1,0,0,0,0,30,0\n2,0,0,0,0,0,0\n", "small"),
        ("time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0,0,0,0,0,0,0\n1,0,,0,0,0,0\n2,0,0,0,0,0,0\n", "a gap"),
        ("time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0,0,0,0,0,0,0\n1,0\n", "other lengths"),
        ("time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n", "no rows"),
        ("", "columns are missing"),
    ],
)
def test_motions_that_are_none_are_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "motion.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_interface_motion(path)


def test_members_above_the_interface_are_refused(scenario: Scenario, whole) -> None:
    with pytest.raises(InputError, match="member below the interface"):
        recovered(scenario, whole[1], ["tower_1"])


BLADED = """FILE\tbase.$21
ACCESS\tD
FORM\tU
RECL\t4
FORMAT\tR*8
CONTENT\t'MOTION'
NDIMENS\t2
DIMENS\t6 50
GENLAB\t'Tower base'
VARIAB\t'Base x' 'Base y' 'Base z' 'Base Rx' 'Base Ry' 'Base Rz'
VARUNIT\tL L L A A A
AXISLAB\t'Time'
AXIUNIT\tT
AXIMETH\t2
MIN\t0.0
STEP\t0.1
"""
SIX = dict(zip(MOTIONS, ("Base x", "Base y", "Base z", "Base Rx", "Base Ry", "Base Rz"), strict=True))


def test_a_motion_of_bladed_has_its_channels_named(tmp_path: Path) -> None:
    values = 1e-3 * np.random.default_rng(1).standard_normal((50, 6))
    path = tmp_path / "base.%21"
    path.write_text(BLADED)
    (tmp_path / "base.$21").write_bytes(values.tobytes())
    found = read_interface_motion(path, SIX)
    np.testing.assert_array_equal(found.values, values)
    assert found.step_s == pytest.approx(0.1)
    # without names, with one missing, one that is not there, and a displacement for a rotation
    for named, said in (
        (None, "--channel x=NAME"),
        ({"x": "Base x"}, "motions without a channel"),
        (SIX | {"z": "Base Z2"}, "no such channel"),
        (SIX | {"rx": "Base x"}, "another unit"),
    ):
        with pytest.raises(InputError, match=said):
            read_interface_motion(path, named)
    done = CliRunner().invoke(main, ["recover", "x.yaml", str(path), "--out", "a.parquet", "--channel", "x"])
    assert done.exit_code == 2 and "MOTION=NAME" in done.stderr
