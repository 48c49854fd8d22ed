"""Identified shapes beside those of a structure: a mode is like itself, and unlike what moves across it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import Sensor, observation_matrix
from jackettwin.structure import Assembly, assemble
from jackettwin.study import beside_model
from jackettwin.updating import numbered_modes

HEIGHTS = (144.0, 77.0, 41.0)
CHANNELS: dict[str, Any] = {
    f"{axis}{height:g}": {
        "quantity": "acceleration", "height_m": height, "node": None, "direction": direction,
    }
    for height in HEIGHTS
    for axis, direction in (("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]))
}  # fmt: skip


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return assemble(read_structure("jacket15"))


def identified(shape: np.ndarray, frequency_hz: float) -> dict[str, Any]:
    values = {name: [float(v), 0.0] for name, v in zip(CHANNELS, shape, strict=True)}
    return {"frequency_hz": frequency_hz, "status": "ok", "mode_shape": values}


def test_a_mode_is_like_itself(assembly: Assembly) -> None:
    model = numbered_modes(assembly, 6)
    sensors = tuple(Sensor(n, tuple(c["direction"]), None, c["height_m"]) for n, c in CHANNELS.items())
    at = observation_matrix(assembly, sensors) @ model.shapes
    modes = [identified(-2.0 * at[:, k], 0.98 * model.frequency_hz[k]) for k in (0, 1, 3)]
    sum_of_pair = identified(at[:, 0] / np.linalg.norm(at[:, 0]) + at[:, 1] / np.linalg.norm(at[:, 1]), 0.18)
    found = beside_model({"channels": CHANNELS, "modes": [*modes, sum_of_pair]}, assembly)
    labels = [one["label"] for one in found["modes"]]
    assert [pair["label"] for pair in found["pairs"][:3]] == [labels[k] for k in (0, 1, 3)]
    assert [pair["mac"] for pair in found["pairs"][:3]] == pytest.approx([1.0] * 3)
    assert [pair["relative_difference"] for pair in found["pairs"][:3]] == pytest.approx([-0.02] * 3)
    # half of each of two shapes across each other: MAC one half with both
    assert found["mac"][3][:2] == pytest.approx([0.5, 0.5], abs=0.01)


def test_of_modes_that_few_channels_cannot_tell_apart_the_nearest_is_taken(assembly: Assembly) -> None:
    """Two channels at the tower top: half the modes move them alike."""
    two = {name: CHANNELS[name] for name in ("x144", "y144")}
    shape = {"x144": [1.0, 0.0], "y144": [0.02, 0.0]}
    modes = [{"frequency_hz": f, "status": "ok", "mode_shape": shape} for f in (0.2, 1.5)]
    found = beside_model({"channels": two, "modes": modes}, assembly)
    assert [pair["label"] for pair in found["pairs"]] == ["fore_aft_1", "fore_aft_3"]
    assert all(pair["modes_as_alike"] >= 2 for pair in found["pairs"])


def test_channels_that_a_mode_lacks_are_left_out(assembly: Assembly) -> None:
    lost = {**identified(np.ones(6), 0.2), "mode_shape": {}}
    found = beside_model({"channels": CHANNELS, "modes": [lost]}, assembly)
    assert found["pairs"] == [None] and found["mac"] == [None]


def test_channels_without_places_are_refused(assembly: Assembly) -> None:
    nowhere = {"a": {"quantity": "acceleration", "height_m": None, "node": None, "direction": [1, 0, 0]}}
    with pytest.raises(InputError, match=r"where it sits and points.*'a'"):
        beside_model({"channels": nowhere, "modes": []}, assembly)
