"""The page on one record: whole, self-contained, its shapes where the sensors are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest
from numpy.testing import assert_allclose

from jackettwin.identification import Examination, ModalEstimate
from jackettwin.identification.comparison import Comparison
from jackettwin.records import Channel
from jackettwin.report.figures.components import shape_components
from jackettwin.report.figures.measured_shapes import SensorLayout, measured_shapes_3d
from jackettwin.report.pages.identification import _shapes, build_identification_page, mode_names
from jackettwin.report.pages.page import Plot
from jackettwin.report.tables.numbers import UNKNOWN
from jackettwin.report.tables.records import method_table

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
CHANNELS = (
    Channel("top_x", height_m=90.0, direction=X),
    Channel("top_y", height_m=90.0, direction=Y),
    Channel("low_x", height_m=30.0, direction=X),
)


def test_channels_of_one_height_move_one_place() -> None:
    places = SensorLayout.of(CHANNELS)
    assert places.height.tolist() == [30.0, 90.0]
    motion = places.motion(np.array([1.0, 2.0j, -0.5]))
    assert_allclose(motion, [[-0.25, 0, 0], [0.5, 1.0j, 0]])


def test_without_heights_no_tower_is_drawn(assert_units: Callable[[go.Figure], None]) -> None:
    """One bar a channel, whatever phase the shape came with."""
    mode = ModalEstimate(0.3, 0.01, np.array([1.0, 0.0, -0.4]) * np.exp(0.7j), 1.0, 0.0, 1.0)
    figure = shape_components([Channel("a", node="top"), Channel("b"), Channel("c")], [("mode_1", mode)])
    assert_units(figure)
    assert [trace.type for trace in figure.data] == ["bar"]
    assert_allclose(figure.data[0].x, [1.0, 0.0, -0.4], atol=1e-12)
    assert list(figure.data[0].y) == ["a", "b", "c"]


def test_the_page_draws_a_tower_only_with_heights(observation: Examination) -> None:
    found = observation.identification
    names = mode_names(observation)
    (tower,) = _shapes(
        replace(found, channels=tuple(replace(c, height_m=5.0) for c in found.channels)), names
    )
    (bars,) = _shapes(
        replace(found, channels=tuple(replace(c, height_m=None) for c in found.channels)), names
    )
    assert isinstance(tower, Plot)
    assert isinstance(bars, Plot)
    assert tower.figure.data[0].type == "scatter3d"
    assert bars.figure.data[0].type == "bar"


def test_the_shapes_move_through_a_cycle(assert_units: Callable[[go.Figure], None]) -> None:
    mode = ModalEstimate(0.3, 0.01, np.array([1.0, 0.0, 0.4], dtype=complex), 1.0, 0.0, 1.0)
    figure = measured_shapes_3d(CHANNELS, [("fore_aft_1", mode), ("", mode)])
    assert_units(figure)
    top = np.array([frame.data[0].x[1] for frame in figure.frames])
    # a cosine of one period over the frames
    assert_allclose(top, top[0] * np.cos(2 * np.pi * np.arange(len(top)) / len(top)), atol=1e-12)
    assert figure.frames[0].traces == (1, 3)


def test_names_need_the_yaw(observation: Examination) -> None:
    assert [name.rpartition("_")[0] for name in mode_names(observation)] == ["mode", "mode"]
    straight = replace(observation, record=replace(observation.record, conditions={"yaw_deg": 0.0}))
    assert sorted(mode_names(straight)) == ["fore_aft_1", "side_side_1"]


@pytest.fixture(scope="module")
def page(observation: Examination, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("page") / "page.html"
    return build_identification_page(observation, path).read_text(encoding="utf-8")


def test_the_page_is_whole(page: str) -> None:
    for part in ("Record", "Modes", "Mode shapes", "SSI-dat", "stabilisation_damping", "measured_shapes"):
        assert part in page
    assert 'src="http' not in page
    assert "noise &lt;&amp;&gt; modes" in page


def test_a_record_without_modes_has_a_page(observation: Examination, tmp_path: Path) -> None:
    found = replace(observation.identification, modes=())
    none = replace(observation, identification=found, comparison=None)
    text = build_identification_page(none, tmp_path / "page.html").read_text(encoding="utf-8")
    assert "measured_shapes" not in text


def test_methods_stand_side_by_side_with_what_is_known_of_them(observation: Examination) -> None:
    found = observation.identification
    uncertain = replace(found.modes[0], damping_ratio=0.01, damping_ratio_std=0.002)
    silent = replace(found.modes[0], damping_ratio=0.012, damping_ratio_std=None)
    modes = {"ssi-cov": (uncertain,), "plscf": (silent,), "efdd": (None,)}
    compared = Comparison(replace(found, modes=found.modes[:1]), modes, {"ssi-dat": "too many gaps"})
    table = method_table(compared, ["mode_1"])
    (row,) = table.rows
    assert row[2].endswith("/ 1.00 ± 0.33")
    assert row[3].endswith("/ 1.20")
    assert row[4] == UNKNOWN
    assert "SSI-dat not applied: too many gaps." in table.caption
