"""A SACS deck in fixed columns: joints in feet and inches, groups with segments, what is not read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.decks import read_structure
from jackettwin.decks.sacs import sacs_remarks
from jackettwin.errors import InputError
from jackettwin.structure import assemble, check


def joint(name: str, x: float, y: float, z: float, dy: float, held: str = "") -> str:
    return f"JOINT {name:>4} {x:7.2f}{y:7.2f}{z:7.2f}{0.0:7.3f}{dy:7.3f}{0.0:7.3f} {held}"


def load(name: str, fz: float) -> str:
    return f"LOAD   {name:>4}     {0.0:7.1f}{0.0:7.1f}{fz:7.1f}".ljust(60) + "GLOB JOIN   DEAD"


DECK = f"""\
OPTIONS      EN  SDUC   2 1
SECT BR1       TUB                               16.0000.625
SECT WF1       WF                                24.0000.500
GRUP
GRUP LG1         42.000 1.375 29.0011.6050.00 1    1.001.00     0.500N490.005.00
GRUP LG1         41.250 1.000 29.0011.6036.00 1    1.001.00     0.500N490.00
GRUP BR1 BR1                  29.0011.6036.00 1    1.001.00     0.500N490.00
GRUP W01 WF1                  29.0011.6036.00 1    1.001.00     0.500N490.00
MEMBER
MEMBER  101 201 LG1
MEMBER  101 301 BR1
MEMBER  301 201 BR1
MEMBER  201 301 W01
MEMBER OFFSETS    1.0
JOINT
{joint("101", -24, -50, -261, -3, "PILEHD")}
{joint("201", -24, -50, -200, -3)}
{joint("301", 24, -50, -261, -3, "111000")}
PGRUP P01 0.3500I29.000 0.25036.000
{load("201", -100.0)}
END
"""


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    path = tmp_path / "sacinp.jacket"
    path.write_text(DECK)
    return path


def test_joints_are_feet_and_inches(deck: Path) -> None:
    x, y, z = read_structure(deck).nodes["101"]
    assert (x, z) == pytest.approx((-24 * 0.3048, -261 * 0.3048))
    assert y == pytest.approx(-50 * 0.3048 - 3 * 0.0254)


def test_a_group_of_two_lines_cuts_its_members(deck: Path) -> None:
    structure = read_structure(deck)
    legs = [m for m in structure.members if m.part == "LG1"]
    assert [m.section_start.outer_diameter_m for m in legs] == pytest.approx([42 * 0.0254, 41.25 * 0.0254])
    ends = [np.array(structure.nodes[n]) for n in (legs[0].start, legs[0].end)]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(5 * 0.3048)


def test_mass_is_that_of_the_cards(deck: Path) -> None:
    """π(D−t)tρL by hand, and 100 kips on a joint."""
    rho, inch, foot = 490 * 16.01846337, 0.0254, 0.3048

    def tube(D: float, t: float, length: float) -> float:
        return float(np.pi * (D - t) * t * inch**2 * rho * length)

    legs = tube(42.0, 1.375, 5 * foot) + tube(41.25, 1.0, 56 * foot)
    brace = tube(16.0, 0.625, 48 * foot) + tube(16.0, 0.625, float(np.hypot(48, 61)) * foot)
    weight = 100 * 4448.2216152605 / 9.80665
    assert check(assemble(read_structure(deck))).mass_kg == pytest.approx(legs + brace + weight, rel=1e-6)


METRIC = (Path(__file__).parents[1] / "data" / "sacs" / "tripod.sacs").read_text(encoding="utf-8")


@pytest.fixture
def metric(tmp_path: Path) -> Path:
    path = tmp_path / "JACKET.sacs"
    path.write_text(METRIC)
    return path


def test_a_metric_deck_reads_as_public_ones_are_written(metric: Path) -> None:
    """The columns and the exponents without letter are those of sacs2abaqus (MIT) and of two public decks."""
    structure = read_structure(metric)
    assert structure.nodes["1"] == pytest.approx((0.0, -1.41433, 90.5))
    assert structure.nodes["601L"] == pytest.approx((-6.0, -4.0 + 1.091e-6, 12.2))
    by = {m.part: m for m in structure.members}
    cone = by["002"]
    assert (cone.section_start.outer_diameter_m, cone.section_end.outer_diameter_m) == (4.006, 4.092)
    assert cone.material.youngs_modulus_pa == pytest.approx(2.1e11)
    assert by["052"].material.density_kg_m3 == pytest.approx(1.0)
    assert by["LG2"].section_start.thickness_m == pytest.approx(0.15)  # fills all six columns
    ends = (by["L07"].section_start.outer_diameter_m, by["L07"].section_end.outer_diameter_m)
    assert ends == pytest.approx((4.006, 6.0))  # cards B and E are one cone, not two segments
    assert [m.name for m in structure.members if m.part == "L07"] == ["003P-601L"]


def test_joints_kept_in_a_dynamic_analysis_are_not_held(metric: Path) -> None:
    held = {r.node: r.fixed[:3] for r in read_structure(metric).reactions}
    assert held == {"001P": (True,) * 3, "002P": (True,) * 3, "003P": (True,) * 3}


def test_a_member_s_ends_lie_beside_its_joints_and_move_with_them(metric: Path) -> None:
    """56.401 cm in x at one end, −56.40 at the other, in columns 36 to 41 and 54 to 59; rigid between."""
    structure = read_structure(metric)
    leg = next(m for m in structure.members if m.name == "001P-601L")
    links = {link.follower: link.leader for link in structure.rigid_links}
    assert links == {leg.start: "001P", leg.end: "601L"}
    for end, joint, shift in ((leg.start, "001P", 0.56401), (leg.end, "601L", -0.5640)):
        moved = np.subtract(structure.nodes[end], structure.nodes[joint])
        np.testing.assert_allclose(moved, [shift, 0.0, 0.0], atol=1e-12)
    assert next(m for m in structure.members if m.name == "002P-601L").end == "601L"
    in_own_axes = METRIC.replace("MEMBER1001P601L", "MEMBER2001P601L")
    metric.write_text(in_own_axes)
    assert read_structure(metric).rigid_links == ()
    assert any("axes of the member" in remark for remark in sacs_remarks(metric))


def test_a_weight_repeated_for_every_direction_counts_once(metric: Path) -> None:
    (mass,) = read_structure(metric).masses
    assert mass.mass_kg == pytest.approx(8200e3 / 9.80665)
    assert any("NACL, N090, CRAN are taken as 836.2 t" in remark for remark in sacs_remarks(metric))


def test_every_reader_of_a_deck_hears_what_is_not_read(
    metric: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level("WARNING"):
        read_structure(metric)
    said = " ".join(caplog.messages)
    assert all(word in said for word in ("releases", "current", "WGTJT cards, weights, are not read"))
    result = CliRunner().invoke(main, ["modes", str(metric), "--json"])
    assert result.exit_code == 0
    assert result.stderr.count("members' end releases are not read") == 1
    assert "releases" not in result.stdout


def test_what_holds_a_joint_is_read(deck: Path) -> None:
    held = {r.node: r.fixed for r in read_structure(deck).reactions}
    assert held == {"101": (True,) * 3 + (False,) * 3, "301": (True,) * 3 + (False,) * 3}


def test_what_is_not_understood_is_listed(deck: Path) -> None:
    said = " ".join(sacs_remarks(deck))
    for word in ("WF1", "PGRUP", "offsets", "W01"):
        assert word in said


def test_a_card_out_of_its_columns_names_line_and_columns(deck: Path) -> None:
    deck.write_text(DECK.replace("LG1         42.000 1.375", "LG1         4x.000 1.375"))
    with pytest.raises(InputError, match="columns 18 to 23"):
        read_structure(deck)
    deck.write_text(DECK.replace("MEMBER  101 201 LG1", "MEMBER  101 999 LG1"))
    with pytest.raises(InputError, match="no joint"):
        read_structure(deck)


def test_a_superelement_of_a_deck_whose_interface_is_named(deck: Path, tmp_path: Path) -> None:
    """A SACS deck does not say where the tower stands: the option does, and a SubDyn deck keeps it."""

    def stiffness(*arguments: str) -> list[list[float]]:
        out = str(tmp_path / "se.npz")
        answer = CliRunner().invoke(
            main, ["superelement", *arguments, "--modes", "4", "--out", out, "--json"]
        )
        assert answer.exit_code == 0, answer.stderr
        return json.loads(answer.stdout)["interface_stiffness"]

    named = ("--interface", "201", "--feet", "101, 301", "--support", "clamped")
    subdyn = tmp_path / "deck.dat"
    answer = CliRunner().invoke(main, ["export", str(deck), *named, "--out", str(subdyn), "--json"])
    assert answer.exit_code == 0, answer.stderr
    own = np.array(stiffness(str(deck), *named))
    # the deck carries the fixed feet itself
    np.testing.assert_allclose(own, stiffness(str(subdyn)), rtol=1e-9, atol=1e-9 * abs(own).max())
    wrong = CliRunner().invoke(main, ["superelement", str(deck), "--interface", "202"])
    assert wrong.exit_code == 2
    assert "--interface" in wrong.stderr and "201" in wrong.stderr


def section(name: str, shape: str, properties: str = "", sides: str = "") -> str:
    return f"SECT {name:<7}   {shape:<3}{properties:<30} {sides}"


SHAPES = "\n".join([
    "OPTIONS      MN       SDUC   1 1   DC  A",
    section("WF1", "WF", sides="  30.0 3.00  60.0 1.50"),
    section("BX1", "BOX", sides="  80.0 2.00  50.0 2.00"),
    section("PR1", "PRI", "100.0   500.0  4000.0  1000.0"),
    section("PR2", "PRI"),
    *(f"GRUP {g} {s:<7}              21.008.10024.82 1    1.001.00     0.500 7.8490"
      for g, s in (("W01", "WF1"), ("B01", "BX1"), ("P01", "PR1"), ("P02", "PR2"))),
    "GRUP LG1         100.00 3.000 21.008.10024.82 1    1.001.00     0.500 7.8490",
    "MEMBER 1   2    LG1",
    "MEMBER 2   3    W01",
    "MEMBER 3   4    B01                 90.00",
    "MEMBER 4   5    P01",
    "MEMBER 2   4    P02",
    "JOINT 1         0.     0.     0.                       111111",
    "JOINT 2         0.     0.    10.",
    "JOINT 3        10.     0.    10.",
    "JOINT 4        10.    10.    10.",
    "JOINT 5        20.    10.    10.",
    "END",
])  # fmt: skip


def test_other_shapes_are_read_where_the_deck_gives_them(tmp_path: Path) -> None:
    """By hand: an I and a box as differences of rectangles; AX, J, IY, IZ as given."""
    path = tmp_path / "shapes.sacs"
    path.write_text(SHAPES)
    structure = read_structure(path)
    beams = {b.part: b for b in structure.beams}
    assert {b.shape for b in structure.beams} == {"I-section", "box", "any section"}
    wide, box, given = (beams[g].section for g in ("W01", "B01", "P01"))
    assert wide.A == pytest.approx(2 * 0.3 * 0.03 + 0.54 * 0.015)
    assert wide.I_x == pytest.approx((0.3 * 0.6**3 - 0.285 * 0.54**3) / 12)
    assert box.A == pytest.approx(0.8 * 0.5 - 0.76 * 0.46)
    assert box.I_x == pytest.approx((0.5 * 0.8**3 - 0.46 * 0.76**3) / 12)  # the depth stands upright
    assert (given.A, given.J, given.I_x, given.I_y) == pytest.approx((1e-2, 5e-6, 4e-5, 1e-5))
    assert beams["B01"].twist_rad == pytest.approx(np.pi / 2)
    remarks = " ".join(sacs_remarks(path))
    assert "section PR2: shape PRI is not read" in remarks and "group P02" in remarks
    # a mass by hand: the tube and the beams
    tube = np.pi * (1.0 - 0.03) * 0.03 * 10
    volume = tube + 10 * (wide.A + box.A + given.A)
    assert check(assemble(structure)).mass_kg == pytest.approx(7849.0 * volume, rel=1e-6)


def test_a_beam_of_a_deck_bends_as_its_second_moment_says(tmp_path: Path) -> None:
    """A level cantilever under its tip: 3 E I/L³ about the level axis, and turned by 90° about the other."""
    for angle, about in ((0.0, "I_x"), (90.0, "I_y")):
        lines = [line for line in SHAPES.splitlines() if not line.startswith(("MEMBER", "JOINT", "END"))]
        lines += [
            f"MEMBER 1   2    W01               {angle:6.2f}",
            "JOINT 1         0.     0.     0.                       111111",
            "JOINT 2        10.     0.     0.",
            "END",
        ]
        path = tmp_path / f"turned{angle:.0f}.sacs"
        path.write_text("\n".join(lines))
        structure = read_structure(path)
        (beam,) = structure.beams
        assembly = assemble(structure, subdivide=1)
        dofs = assembly.dofs("2")
        K = assembly.stiffness[dofs][:, dofs].toarray()
        tip = 1.0 / np.linalg.inv(K)[2, 2]
        E = 21.0e10
        assert tip == pytest.approx(3 * E * getattr(beam.section, about) / 10.0**3, rel=1e-9)
