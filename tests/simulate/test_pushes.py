"""Forces at nodes from a file, a pull that is let go, and its logarithmic decrement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, nodal_load, static_displacement
from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.soil import read_support
from jackettwin.structure import assemble

FEET = "kelvin-voigt:k=2.5e9,c=7.6e8"
SENSORS = [
    {"channel": "u", "node": "tower_top", "direction": [1, 0, 0], "quantity": "displacement"},
    {"channel": "v", "node": "leg_1_2", "direction": [0, 1, 0], "quantity": "displacement"},
]


def written(folder: Path, **keys: object) -> Path:
    data = {"structure": "jacket15", "support": FEET, "sensors": SENSORS, **keys}
    path = folder / "s.yaml"
    path.write_text(yaml.safe_dump(data))
    return path


def pull(**keys: object) -> dict[str, object]:
    return {"node": "tower_top", "direction": [1, 0, 0], **keys}


def test_a_pull_stands_where_the_whole_model_does_under_the_same_force(tmp_path: Path) -> None:
    """The reduced model keeps the pulled node: its static flexibility is the full model's."""
    start = {"node": "leg_1_2", "direction": [0, 2, 0], "force_n": 3.0e6, "release_s": 5.0}
    data = simulate(read_scenario(written(tmp_path, start=start, time={"duration_s": 10.0}))).record.data
    assembly = assemble(read_structure("jacket15"), gravity=True)
    support = read_support(FEET, assembly.structure)
    system = build_system(assembly, support)
    u = static_displacement(system, nodal_load(assembly, {"leg_1_2": (0.0, 3.0e6, 0.0)}))
    expected = u[assembly.dofs("leg_1_2")[1]]
    np.testing.assert_allclose(data[1, :500], expected, rtol=1e-6)  # at rest until it is let go
    assert np.abs(data[1, 600:] - expected).max() > 0.5 * abs(expected)


def test_a_release_at_the_start_and_a_late_one_decay_alike(tmp_path: Path) -> None:
    time = {"duration_s": 20.0, "step_s": 0.01, "load_step_s": 0.01}
    first = read_scenario(written(tmp_path, start=pull(displacement_m=0.2), time=time))
    now = simulate(first).record.data[0]
    late = read_scenario(written(tmp_path, start=pull(displacement_m=0.2, release_s=5.0), time=time))
    after = simulate(late).record.data[0]
    assert now[0] == pytest.approx(0.2, rel=1e-9)
    np.testing.assert_allclose(after[:501], 0.2, rtol=1e-9)
    # it is let go evenly within one step of 0.01 s: half a step late, 2πf₁·0.005 s = 0.6 % of a radian
    np.testing.assert_allclose(after[501:], 0.5 * (now[:1499] + now[1:1500]), atol=2e-4)


@pytest.mark.parametrize("ratio", [0.01, 0.03])
def test_the_decrement_is_the_poles(tmp_path: Path, ratio: float) -> None:
    keys = {"damping": {"rayleigh": {"ratio": ratio, "frequency_hz": 0.18}}, "time": {"duration_s": 150.0}}
    motion = simulate_motion(read_scenario(written(tmp_path, start=pull(displacement_m=0.2), **keys)))
    found = motion.decrement
    assert found is not None and found.pole_share > 0.95
    pole = min(motion.modes, key=lambda m: abs(m.frequency_hz - found.pole_frequency_hz))
    assert pole.label == "fore_aft_1"
    assert found.pole_damping_ratio == pytest.approx(pole.damping_ratio, rel=1e-9)
    # what is left of higher modes after the first cycle moves the peaks by less than this
    assert found.damping_ratio == pytest.approx(pole.damping_ratio, rel=0.01)
    assert found.logarithmic_decrement == pytest.approx(2 * np.pi * pole.damping_ratio, rel=0.01)


def test_what_no_mode_carries_has_no_decrement_and_far_pulls_are_said(tmp_path: Path) -> None:
    keys = {"damping": {"rayleigh": {"ratio": 0.01, "frequency_hz": 0.18}}, "time": {"duration_s": 60.0}}
    foot = {"node": "foot_1", "direction": [0, 1, 0], "displacement_m": 0.01}
    done = simulate(read_scenario(written(tmp_path, start=foot, **keys)))
    assert done.record.metadata["decrement"] is None
    (note,) = done.notes
    assert note.startswith("release of foot_1: no logarithmic decrement, since no mode carries 10 % of")
    done = simulate(read_scenario(written(tmp_path, start=pull(displacement_m=40.0), **keys)))
    assert done.record.metadata["decrement"] is not None
    (note,) = done.notes
    assert note.startswith("pull of tower_top: the structure turns by up to")


def test_a_held_node_cannot_be_pulled(tmp_path: Path) -> None:
    start = {"node": "foot_1", "direction": [0, 1, 0], "displacement_m": 0.01}
    keys = {"support": "pinned", "start": start, "time": {"duration_s": 10.0}}
    with pytest.raises(InputError, match=r"start\.node: is held in this direction"):
        simulate(read_scenario(written(tmp_path, **keys)))


def test_a_force_from_a_file_is_the_one_that_pulls(tmp_path: Path) -> None:
    """A force that grows slowly and stays is in the end the static one; both columns act."""
    (tmp_path / "f.csv").write_text(
        "time_s,tower_top.fx_n,leg_1_2.fy_n\n0,0,0\n100,1e5,2e5\n400,1e5,2e5\n", encoding="utf-8"
    )
    keys = {"damping": {"rayleigh": {"ratio": 0.05, "frequency_hz": 0.18}}, "time": {"duration_s": 400.0}}
    data = simulate(read_scenario(written(tmp_path, forces="f.csv", **keys))).record.data
    assembly = assemble(read_structure("jacket15"), gravity=True)
    system = build_system(assembly, read_support(FEET, assembly.structure))
    load = nodal_load(assembly, {"tower_top": (1e5, 0.0, 0.0), "leg_1_2": (0.0, 2e5, 0.0)})
    u = static_displacement(system, load)
    assert data[0, -1] == pytest.approx(u[assembly.dofs("tower_top")[0]], rel=1e-4)
    assert data[1, -1] == pytest.approx(u[assembly.dofs("leg_1_2")[1]], rel=1e-4)


def test_no_decrement_under_other_loads(tmp_path: Path) -> None:
    waves = {"type": "airy", "height_m": 2.0, "period_s": 8.0}
    keys = {"waves": waves, "time": {"duration_s": 16.0}, "start": pull(force_n=1e5)}
    assert simulate_motion(read_scenario(written(tmp_path, **keys))).decrement is None


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"start": pull()}, "start.displacement_m: needs either"),
        ({"start": pull(force_n=1.0, displacement_m=1.0)}, "start.displacement_m: needs either"),
        ({"start": {"node": "top", "direction": [1, 0, 0], "force_n": 1.0}}, "start.node: no such node"),
        (
            {"start": {"node": "tower_top", "direction": [0, 0, 0], "force_n": 1.0}},
            "has no length",
        ),
        ({"start": pull(force_n=1.0, release_s=600.0)}, "release_s: is not let go"),
        ({"forces": "none.csv"}, "none.csv"),
        ({"forces": "time.csv"}, "times must grow"),
        ({"forces": "unit.csv"}, "is no force at a node"),
        ({"forces": "node.csv"}, "no such node"),
        ({"forces": "word.csv"}, "not a number"),
        ({"forces": "nan.csv"}, "is no force"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, keys: dict[str, object], message: str) -> None:
    for name, text in {
        "time": "time_s,tower_top.fx_n\n1,1\n0,1\n",
        "unit": "time_s,tower_top.fx_kn\n0,1\n1,1\n",
        "node": "time_s,tip.fx_n\n0,1\n1,1\n",
        "word": "time_s,tower_top.fx_n\n0,one\n1,1\n",
        "nan": "time_s,tower_top.fx_n\n0,nan\n1,1\n",
    }.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_scenario(written(tmp_path, **keys))
    assert message in str(caught.value)


def test_steps_finer_than_the_loads_are_refused(tmp_path: Path) -> None:
    (tmp_path / "f.csv").write_text("time_s,tower_top.fx_n\n0,0\n0.01,1\n0.02,0\n", encoding="utf-8")
    with pytest.raises(InputError, match="load_step_s: 0.01"):
        simulate(read_scenario(written(tmp_path, forces="f.csv", time={"duration_s": 10.0})))


def test_what_flows_cannot_be_pulled(tmp_path: Path) -> None:
    keys = {
        "support": "maxwell:k0=0,branches=1e9/1",
        "start": pull(force_n=1e5),
        "time": {"duration_s": 10.0},
    }
    with pytest.raises(InputError, match="falls over"):
        simulate(read_scenario(written(tmp_path, **keys)))
