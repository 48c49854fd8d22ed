from __future__ import annotations

from collections.abc import Callable

import numpy as np
import plotly.graph_objects as go
import pytest

from gallery.modes_3d import Shape, mode_shapes_3d
from gallery.structure_3d import structure_3d
from jackettwin.records import Record
from jackettwin.report import Plot
from jackettwin.report.build import report_sections
from jackettwin.report.figures.record import envelope, time_series
from jackettwin.report.figures.style import direction_colour, law_look, mode_look
from jackettwin.study import TwinResult


@pytest.fixture(scope="module")
def plots(complete: TwinResult) -> list[Plot]:
    return [b for s in report_sections(complete) for b in s.blocks if isinstance(b, Plot)]


def test_every_axis_has_quantity_and_unit(
    plots: list[Plot], assert_units: Callable[[go.Figure], None]
) -> None:
    assert len(plots) >= 7
    for plot in plots:
        assert_units(plot.figure)


def test_legends_stand_outside_the_axes(plots: list[Plot]) -> None:
    for plot in plots:
        legend = plot.figure.layout.legend
        beside = legend.x is not None and all(
            not axis.domain[0] <= legend.x <= axis.domain[1]
            for axis in plot.figure.select_xaxes()
            if axis.domain is not None
        )
        assert legend.y >= 1.0 or legend.y < 0.0 or beside, plot.name


def test_laws_and_modes_differ_without_colour() -> None:
    laws = [law_look(name) for name in ("kelvin-voigt", "zener", "maxwell-3", "springpot")]
    assert len({look.symbol for look in laws}) == len({look.dash for look in laws}) == len(laws)
    modes = [
        mode_look(label) for label in ("fore_aft_1", "fore_aft_2", "side_side_1", "side_side_2", "torsion_1")
    ]
    assert len({look.symbol for look in modes}) == len(modes)
    unnamed = [mode_look(f"mode_{n}") for n in range(1, 13)]
    assert len({(look.colour, look.symbol) for look in unnamed}) == len(unnamed)
    assert (
        mode_look("fore_aft_1").colour == mode_look("fore_aft_3").colour == direction_colour((1.0, 0.0, 0.0))
    )


def test_structure_has_equal_axes(complete: TwinResult) -> None:
    scene = structure_3d(complete.assembly, complete.sensors).layout.scene
    spans = [float(np.ptp(axis.range)) for axis in (scene.xaxis, scene.yaxis, scene.zaxis)]
    ratios = [scene.aspectratio.x, scene.aspectratio.y, scene.aspectratio.z]
    np.testing.assert_allclose(np.divide(ratios, spans) * spans[2] / ratios[2], 1.0, rtol=1e-12)


def test_mode_shape_starts_at_its_largest_and_returns_through_rest(complete: TwinResult) -> None:
    shape = Shape("f", "fore_aft_1", complete.numbered.shapes[:, 1].astype(complex))
    figure = mode_shapes_3d(complete.assembly, [shape])
    rest, moving = figure.data[0], figure.data[1]
    height = np.ptp(complete.assembly.mesh.coordinates[:, 2])
    start = np.nanmax(np.abs(moving.x - rest.x))
    assert start == pytest.approx(0.10 * height, rel=1e-4)  # float32 coordinates
    quarter = figure.frames[len(figure.frames) // 4].data[0]
    assert np.nanmax(np.abs(quarter.x - rest.x)) < 1e-4 * start
    half = figure.frames[len(figure.frames) // 2].data[0]
    np.testing.assert_allclose(half.x - rest.x, rest.x - moving.x, atol=1e-4)


def test_measured_arrows_of_a_perfect_measurement_end_on_the_model(complete: TwinResult) -> None:
    from jackettwin.response.sensors import observation_matrix

    damped = complete.numbered.shapes[:, 0].astype(complex)
    seen = 7.0 * np.exp(0.3j) * (observation_matrix(complete.assembly, complete.sensors) @ damped)
    shape = Shape("f", "side_side_1", damped, measured=seen)
    figure = mode_shapes_3d(complete.assembly, [shape], complete.sensors)
    arrows = figure.data[2]
    top = [s.channel for s in complete.sensors].index("acc_top_y")
    height = np.ptp(complete.assembly.mesh.coordinates[:, 2])
    assert abs(arrows.y[3 * top + 1] - arrows.y[3 * top]) == pytest.approx(0.10 * height, rel=1e-3)


def test_envelope_keeps_extremes_and_gaps() -> None:
    rng = np.random.default_rng(0)
    y = rng.standard_normal(60_000)
    y[1234] = 50.0
    t, shown = envelope(y, 100.0)
    assert shown.size < 2000
    assert shown.max() == 50.0 and t[np.argmax(shown)] == 12.34
    assert shown.min() == y.min()
    assert (np.diff(t) >= 0.0).all()
    y[30_000:31_000] = np.nan
    t, shown = envelope(y, 100.0)
    missing = t[np.isnan(shown)]
    assert missing.min() >= 299.0 and missing.max() <= 311.0


def test_chosen_channels_only(record: Record) -> None:
    figure = time_series(record, channels=["acc_mid_y", "acc_top_x"])
    assert [trace.name for trace in figure.data] == ["acc_mid_y", "acc_top_x"]
