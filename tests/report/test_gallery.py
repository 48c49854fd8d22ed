from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest

from jackettwin.report import Plot, Section, build_gallery, explore
from jackettwin.report.gallery import STEPS, thesis_figures
from jackettwin.twin import TwinResult
from jackettwin.updating import Parameter

LISTED = (
    [f"3_{i}" for i in (1, 2, 3)]
    + [f"4_{i}" for i in (1, 2, 3)]
    + ["5_1", "5_2", "5_3", "5_4", "5_5", "5_6", "5_9_density", "5_9_modulus", "5_11", "6_1", "6_2", "7_1"]
    + ["8_1", "8_2", "8_3", "8_4_a", "8_4_b", "8_5", "8_6", "8_7_a", "8_7_b"]
    + [f"11_{i}" for i in (1, 2, 3, 4)]
)


@pytest.fixture(scope="module")
def announced() -> list[str]:
    return []


@pytest.fixture(scope="module")
def sections(announced: list[str]) -> list[Section]:
    return thesis_figures(announced.append)


def test_every_listed_figure_is_there(sections: list[Section], announced: list[str]) -> None:
    names = [b.name for s in sections for b in s.blocks if isinstance(b, Plot)]
    assert names == [f"figure_{n}" for n in LISTED]
    assert len(announced) == STEPS


def test_gallery_axes_have_units(sections: list[Section], assert_units: Callable[[go.Figure], None]) -> None:
    for section in sections:
        for block in section.blocks:
            if isinstance(block, Plot) and not _drawn(block):
                assert_units(block.figure)


def _drawn(plot: Plot) -> bool:
    """Schematics have no axes to name."""
    return plot.name in {f"figure_{n}" for n in ("3_1", "4_3", "5_2", "7_1")}


def test_first_two_modes_of_the_record_are_told_apart(sections: list[Section]) -> None:
    stabilisation = next(
        b.figure for s in sections for b in s.blocks if isinstance(b, Plot) and b.name == "figure_11_1"
    )
    texts = {a.text for a in stabilisation.layout.annotations}
    assert {"fore-aft 1", "side-side 1"} <= texts


def test_gallery_is_one_small_page(sections: list[Section], tmp_path: Path) -> None:
    path = build_gallery(sections, tmp_path, "The thesis's figures")
    assert path.stat().st_size < 12e6
    assert len(list((tmp_path / "figures").glob("*.html"))) == len(LISTED)


def test_root_locus_is_refined_where_poles_move(targets_only: TwinResult) -> None:
    update = targets_only.updates[0]
    path = explore.locus(update.model, update.best.theta, (1,), ("side_side_1",))
    assert (np.diff(path.values) > 0.0).all()
    # Both ends are undamped springs plus the steel's damping: k alone, and pinned feet.
    held = targets_only.numbered.frequency_hz[0]
    assert abs(path.poles[-1, 0]) / (2.0 * np.pi) == pytest.approx(held, rel=1e-4)  # c of 1e14 is not ∞
    undamped = update.model.undamped_hz(update.best.theta, (1,))[0]
    assert abs(path.poles[0, 0]) / (2.0 * np.pi) == pytest.approx(undamped, rel=1e-4)
    steps = np.abs(np.diff(path.poles[:, 0])) / np.abs(path.poles[:, 0] - path.poles[0, 0]).max()
    assert steps.max() < 0.1


def test_root_locus_needs_no_refinement_when_nothing_moves(targets_only: TwinResult) -> None:
    """A soft dashpot on stiff springs: between its bounds the poles all but stand still."""
    update = targets_only.updates[0]
    model = replace(update.model, parameters=(update.model.parameters[0], Parameter("c", 1.0, 1.01, "N·s/m")))
    path = explore.locus(model, update.best.theta, (1,), ("side_side_1",), n=41)
    assert path.values.size == 41
    assert np.isfinite(path.poles).all()
