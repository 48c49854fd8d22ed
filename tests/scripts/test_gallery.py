"""The thesis's figures are all there, with units on their axes, on one page of modest size."""

from __future__ import annotations

from pathlib import Path

import pytest
from figure_units import assert_units_of

from gallery.__main__ import write_gallery
from gallery.thesis_figures import STEPS, thesis_figures
from jackettwin.report import PageSection, Plot

LISTED = (
    [f"3_{i}" for i in (1, 2, 3)]
    + ["4_1", "4_2_models", "4_2", "4_3"]
    + ["5_1", "5_2", "5_3", "5_4", "5_5", "5_6", "5_9_density", "5_9_modulus", "5_11", "6_1", "6_2", "7_1"]
    + ["8_1", "8_2", "8_3", "8_4_a", "8_4_b", "8_5", "8_6", "8_7_a", "8_7_b"]
    + [f"11_{i}" for i in (1, 2, 3, 4)]
)


@pytest.fixture(scope="module")
def announced() -> list[str]:
    return []


@pytest.fixture(scope="module")
def sections(announced: list[str]) -> list[PageSection]:
    return thesis_figures(announced.append)


def test_every_listed_figure_is_there(sections: list[PageSection], announced: list[str]) -> None:
    names = [b.name for s in sections for b in s.blocks if isinstance(b, Plot)]
    assert names == [f"figure_{n}" for n in LISTED]
    assert len(announced) == STEPS


def test_gallery_axes_have_units(sections: list[PageSection]) -> None:
    for section in sections:
        for block in section.blocks:
            if isinstance(block, Plot) and not _drawn(block):
                assert_units_of(block.figure)


def _drawn(plot: Plot) -> bool:
    """Schematics have no axes to name."""
    return plot.name in {f"figure_{n}" for n in ("3_1", "4_3", "5_2", "7_1")}


def test_first_two_modes_of_the_record_are_told_apart(sections: list[PageSection]) -> None:
    stabilisation = next(
        b.figure for s in sections for b in s.blocks if isinstance(b, Plot) and b.name == "figure_11_1"
    )
    texts = {a.text for a in stabilisation.layout.annotations}
    assert {"fore-aft 1", "side-side 1"} <= texts


def test_gallery_is_one_small_page(sections: list[PageSection], tmp_path: Path) -> None:
    path = write_gallery(sections, tmp_path)
    assert path.stat().st_size < 12e6
    assert len(list((tmp_path / "figures").glob("*.html"))) == len(LISTED)
