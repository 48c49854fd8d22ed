"""Groups of piles and cycles along their axis, by hand."""

from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.soil.foundation import build_foundation, read_foundation
from jackettwin.soil.ground.profile import Clay, Layer, Sand, SoilProfile
from jackettwin.soil.piles.capacity import axial_capacity, pushover
from jackettwin.soil.piles.group import AxialCycles, PileGroup
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.reaction_curves import pile_curves
from jackettwin.soil.piles.soil_curves import CurveOptions

D = 2.0
PILE = Pile(30.0, D, 0.05)
CLAY = SoilProfile((Layer(60.0, 9e3, clay=Clay((4e4, 4e4))),))
SAND = SoilProfile((Layer(60.0, 9e3, Sand(35.0)),))


@pytest.mark.parametrize(
    ("place", "heading", "factor"),
    [
        # three diameters ahead, behind and beside, by hand
        ((6.0, 0.0), 0.0, 0.48 * 3**0.38),
        ((-6.0, 0.0), 0.0, 0.7 * 3**0.26),
        ((0.0, 6.0), 0.0, 0.64 * 3**0.34),
        ((0.0, -6.0), 0.0, 0.64 * 3**0.34),
        ((0.0, 6.0), 90.0, 0.48 * 3**0.38),
        # ahead, 30° off the load
        (
            (6.0 * cos(radians(30.0)), 6.0 * sin(radians(30.0))),
            0.0,
            np.sqrt((0.48 * 3**0.38) ** 2 * 0.75 + (0.64 * 3**0.34) ** 2 * 0.25),
        ),
        # each of the three has its own reach: 7, 4 and 3.75 diameters
        ((14.0, 0.0), 0.0, 1.0),
        ((-8.0, 0.0), 0.0, 1.0),
        ((0.0, 7.5), 0.0, 1.0),
        ((13.0, 0.0), 0.0, 0.48 * 6.5**0.38),
    ],
)
def test_a_neighbour_weakens_the_ground_by_its_place(
    place: tuple[float, float], heading: float, factor: float
) -> None:
    assert PileGroup((place,), heading).p_multiplier(D) == pytest.approx(factor, rel=1e-12)


def test_neighbours_multiply_and_the_worst_direction_counts() -> None:
    """A corner of a square of four: the worst load has both sides' piles and the diagonal one ahead."""
    square = ((6.0, 0.0), (0.0, 6.0), (6.0, 6.0))
    ahead, behind, beside = 0.48 * 3**0.38, 0.7 * 3**0.26, 0.64 * 3**0.34
    diagonal = 3.0 * np.sqrt(2.0)
    # along x: one ahead, one beside, the third askew by 45°
    askew = np.sqrt(0.5 * (0.48 * diagonal**0.38) ** 2 + 0.5)
    assert PileGroup(square, 0.0).p_multiplier(D) == pytest.approx(ahead * beside * askew)
    # the other way round: one behind, one beside, and the third behind at more than four diameters
    assert PileGroup(square, 180.0).p_multiplier(D) == pytest.approx(behind * beside)
    worst = PileGroup(square).p_multiplier(D)
    every = [PileGroup(square, heading).p_multiplier(D) for heading in range(0, 360, 15)]
    assert worst <= min(every) + 1e-12
    # whichever way the group is turned
    c, s = cos(radians(40.0)), sin(radians(40.0))
    turned = tuple((c * x - s * y, s * x + c * y) for x, y in square)
    assert PileGroup(turned).p_multiplier(D) == pytest.approx(worst, rel=1e-4)


def test_reactions_scale_with_the_group() -> None:
    group = PileGroup(((6.0, 0.0),), 0.0)
    alone, beside = (pile_curves(PILE, SAND, CurveOptions(group=one)) for one in (None, group))
    factor = group.p_multiplier(D)
    for one, other in zip(alone.py, beside.py, strict=True):
        assert other.force(0.03) == pytest.approx(factor * one.force(0.03))
    assert [curve.capacity for curve in beside.tz] == [curve.capacity for curve in alone.tz]
    weak, strong = (pushover(PILE, curves, steps=2).ultimate_n for curves in (beside, alone))
    assert factor < weak / strong < 1.0  # the steel is not weaker
    both = pile_curves(PILE, SAND, CurveOptions(group=group, p_multiplier=0.5))
    assert both.py[5].capacity == pytest.approx(0.5 * beside.py[5].capacity)
    assert beside.block is None  # no block in sand


def test_a_block_of_clay_fails_as_one() -> None:
    """Four piles, two diameters apart: perimeter 4 × 4 m + πD, by hand."""
    group = PileGroup(((4.0, 0.0), (0.0, 4.0), (4.0, 4.0)))
    found = axial_capacity(PILE, pile_curves(PILE, CLAY, CurveOptions(group=group)))
    alone = axial_capacity(PILE, pile_curves(PILE, CLAY))
    perimeter, area = 16.0 + pi * D, 16.0 + 16.0 * 1.0 + pi
    assert found.block is not None
    assert found.block.shaft_n == pytest.approx(perimeter * 30.0 * 4e4 / 4.0)
    assert found.block.base_n == pytest.approx(9.0 * 4e4 * area / 4.0)
    assert found.alone_n == pytest.approx(alone.compression_n)
    assert found.compression_n == pytest.approx(
        min(alone.compression_n, found.block.shaft_n + found.block.base_n)
    )
    # many close piles: the block governs, in tension too
    close = tuple((2.2 * i, 2.2 * j) for i in range(8) for j in range(8) if (i, j) != (0, 0))
    many = axial_capacity(PILE, pile_curves(PILE, CLAY, CurveOptions(group=PileGroup(close))))
    assert many.block is not None
    assert many.compression_n == many.block.shaft_n + many.block.base_n < many.alone_n
    assert many.tension_n == many.block.shaft_n < many.shaft_n
    # two piles: a hull without area
    two = axial_capacity(PILE, pile_curves(PILE, CLAY, CurveOptions(group=PileGroup(((4.0, 0.0),)))))
    assert two.block is not None
    assert two.block.shaft_n == pytest.approx((8.0 + pi * D) * 30.0 * 4e4 / 2.0)


@pytest.mark.parametrize("profile", [CLAY, SAND])
def test_the_curves_of_iso_19901_4_are_api_s(profile: SoilProfile) -> None:
    names = dict.fromkeys(("sand_tz", "clay_tz", "sand_qz", "clay_qz"), "iso19901-4")
    one, other = (pile_curves(PILE, profile, CurveOptions(**chosen)) for chosen in (names, {}))
    assert (one.tz, one.qz) == (other.tz, other.qz)


def test_cycles_along_the_axis_weaken_sand_alone() -> None:
    """1 − 0.126 (0.4 − 0.1) 100^0.45 by hand."""
    cycles = AxialCycles(0.4, 100.0)
    assert cycles.friction_left == pytest.approx(1.0 - 0.126 * 0.3 * 100.0**0.45)
    # below a tenth of the static capacity cycles do no harm, however many
    assert AxialCycles(0.1, 1e9).friction_left == AxialCycles(0.05, 1e6).friction_left == 1.0
    for profile, left in ((SAND, cycles.friction_left), (CLAY, 1.0)):
        before, after = (
            axial_capacity(PILE, pile_curves(PILE, profile, CurveOptions(axial_cycles=one)))
            for one in (None, cycles)
        )
        assert after.shaft_n == pytest.approx(left * before.shaft_n)
    with pytest.raises(InputError, match="leave no friction") as refused:
        AxialCycles(0.5, 1e5)
    assert "cycles of this amplitude" in str(refused.value)
    assert AxialCycles(0.5, 0.999 * AxialCycles(0.5, 1.0).most).friction_left == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("group", "message"),
    [
        (lambda: PileGroup(()), "a group has other piles"),
        (lambda: PileGroup(((1.9, 0.0),)).p_multiplier(D), "overlap"),
        (lambda: PileGroup(((0.0, 0.0),)).p_multiplier(D), "overlap"),
        (lambda: PileGroup(((6.0, 0.0), (6.0, 1.0))).p_multiplier(D), "overlap"),
        (lambda: PileGroup(((np.nan, 3.0),)), "out of range"),
        (lambda: PileGroup(((1e6, 3.0),)), "out of range"),
        (lambda: PileGroup(((4.0, 3.0),), np.nan), "out of range"),
        (lambda: AxialCycles(1.2, 10.0), "out of range"),
        (lambda: AxialCycles(0.2, 0.0), "out of range"),
    ],
)
def test_what_cannot_be_is_refused(group: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        group()  # type: ignore[operator]


def test_a_file_gives_group_and_cycles_and_close_feet_are_noticed(tmp_path) -> None:
    content = {
        "pile": {"length_m": 30.0, "outer_diameter_m": 2.0, "thickness_m": 0.05},
        "soil": {
            "layers": [
                {"thickness_m": 60.0, "effective_weight_n_m3": 9e3, "clay": {"strength_pa": [4e4, 8e4]}}
            ]
        },
        "curves": {"group": {"others_m": [[5, 0], [0, 5]]}, "axial_cycles": {"amplitude": 0.2, "number": 50}},
    }
    found = build_foundation(content, tmp_path / "group.yaml")
    assert found.options.group == PileGroup(((5.0, 0.0), (0.0, 5.0)))
    assert any("weaken sand alone" in note for note in found.notes)
    jacket = read_structure("jacket15")
    assert not any("diameters apart" in note for note in read_foundation("jacket15").heads(jacket).notes)
    narrow = replace(jacket, nodes={name: (0.2 * x, 0.2 * y, z) for name, (x, y, z) in jacket.nodes.items()})
    assert any("diameters apart" in note for note in read_foundation("jacket15").heads(narrow).notes)
    content["curves"]["group"]["others_m"] = [[1, 0]]
    with pytest.raises(InputError, match="overlap"):
        build_foundation(content, tmp_path / "group.yaml")
