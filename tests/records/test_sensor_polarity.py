"""Signs that a record can tell, and silence where it cannot.

False alarms over many random structures are counted by ``qualify/sensor_faults.py``.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record, assess

UP = (0.0, 0.0, 1.0)


def sign_findings(record: Record) -> dict[str | None, bool]:
    return {f.subject: f.repaired for f in assess(record).findings if f.code.startswith("sign_")}


def two_spans(tower: SimpleNamespace, **place: object) -> Record:
    """Two sensors in either span of a bridge, whose first mode is antisymmetric."""
    rng = np.random.default_rng(1)
    modes = [tower.oscillator(rng.normal(size=24_000), f, 0.01, 20.0)[12_000:] for f in (1.0, 1.56)]
    shapes = np.array([[0.7, 1.0, -1.0, -0.7, -0.9], [0.75, 1.0, 1.0, 0.75, 0.95]])
    data = shapes.T @ (np.array([[5.0], [1.0]]) * modes)
    data += 0.01 * data.std() * rng.normal(size=data.shape)
    names = ("a_z", "b_z", "c_z", "d_z", "e_z")
    return Record(data, 20.0, tuple(Channel(name, direction=UP, **place) for name in names))


@pytest.mark.parametrize("place", [{}, {"height_m": 20.0}])
def test_spans_that_move_against_each_other_are_no_swapped_signs(
    place: dict[str, object], tower: SimpleNamespace
) -> None:
    assert not sign_findings(two_spans(tower, **place))


def test_sensors_without_a_place_are_not_judged(tower: SimpleNamespace) -> None:
    record = tower.record(3)
    nowhere = tuple(replace(channel, height_m=None) for channel in record.channels)
    data = record.data.copy()
    data[1] = -data[1]
    assert not sign_findings(replace(record, data=data, channels=nowhere))


def test_torsion_below_bending_is_no_swapped_sign(tower: SimpleNamespace) -> None:
    """Two sensors a floor on either side of the axis: the heights are there, the axis is not."""
    rng = np.random.default_rng(2)
    modes = [tower.oscillator(rng.normal(size=24_000), f, 0.01, 20.0)[12_000:] for f in (0.4, 0.5)]
    shapes = np.array([[1.0, -0.8, 0.6, 0.55], [0.9, 1.0, 0.5, 0.6]])
    data = shapes.T @ (np.array([[3.0], [1.0]]) * modes)
    data += 0.01 * data.std() * rng.normal(size=data.shape)
    channels = tuple(
        Channel(f"f{i}_x", height_m=h, direction=(1.0, 0.0, 0.0))
        for i, h in enumerate((40.0, 40.0, 20.0, 20.0))
    )
    assert not sign_findings(Record(data, 20.0, channels))


@pytest.mark.parametrize("n_sensors", [2, 3])
def test_sensors_at_one_node_move_together(n_sensors: int, tower: SimpleNamespace) -> None:
    """With a third sensor it is known which one is wrong; a fourth, at another node, does not count."""
    record = tower.record(4).select(["acc_77_x", "acc_41_x"])
    rng = np.random.default_rng(4)
    rows = [sign * record.data[0] for sign in (1.0, -1.0, 1.0)[:n_sensors]] + [-record.data[1]]
    rows += 0.02 * np.std(rows[0]) * rng.normal(size=(len(rows), record.data.shape[1]))
    names = [*(f"leg_{i}_x" for i in range(n_sensors)), "other_x"]
    nodes = ["leg"] * n_sensors + ["other"]
    channels = tuple(
        Channel(name, node=node, direction=(1.0, 0.0, 0.0)) for name, node in zip(names, nodes, strict=True)
    )
    found = sign_findings(Record(np.array(rows), 20.0, channels))
    assert found == ({"leg_1_x": True} if n_sensors == 3 else {next(iter(found)): False})
    assert next(iter(found)).startswith("leg")


def test_a_sensor_on_the_nacelle_is_not_parallel_to_a_fixed_one(tower: SimpleNamespace) -> None:
    record = tower.record(5)
    data = record.data.copy()
    data[0] = -data[0]
    turning = replace(record.channels[0], frame="nacelle")
    assert not sign_findings(replace(record, data=data, channels=(turning, *record.channels[1:])))


@pytest.mark.parametrize(
    ("sea", "second_hz", "second"), [(0.0, 0.91, 0.5), (3.0, 0.91, 0.5), (0.0, 1.8, 200.0)]
)
def test_every_reversed_sensor_of_a_parked_tower_is_found(
    sea: float, second_hz: float, second: float
) -> None:
    """Three levels, two directions, bending modes of either; waves of 5.5 s push at all levels.

    In the third tower the second modes have 6 times the acceleration of the first. No correct one is accused.
    """
    shapes = np.array([np.kron(s, d) for s in ([1.0, 0.6, 0.25], [-0.4, 0.6, 0.7]) for d in np.eye(2)])
    f = np.array([0.33, 0.345, second_hz, 1.1 * second_hz])
    forces = np.diag([1.0, 1.0, second, second]) / np.outer(f, f)
    tower = ModalSystem(f, np.full(4, 0.012), shapes, forces, noise_ratio=0.05)
    swell = ModalSystem(np.array([0.18]), np.array([0.07]), shapes[:1] + shapes[1:2], np.eye(1), 0.0)
    rng = np.random.default_rng(4)
    record, waves = (simulate(s, rng, duration_s=600.0, sample_rate_hz=30.0) for s in (tower, swell))
    data = record.data + sea * 0.3 * record.data.std() * waves.data / waves.data.std()
    channels = tuple(
        Channel(f"acc_{z}_{axis}", height_m=z, direction=direction)
        for z in (90.0, 60.0, 25.0)
        for axis, direction in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
    )
    assert not sign_findings(replace(record, data=data, channels=channels))
    for i, channel in enumerate(channels):
        turned = data.copy()
        turned[i] *= -1.0
        found = assess(replace(record, data=turned, channels=channels)).findings
        assert [one.subject for one in found if one.code == "sign_turned"] == [channel.name]
