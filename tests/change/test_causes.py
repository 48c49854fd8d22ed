"""Directions of causes on the reference jacket: closed forms, signs, and what cannot be told apart."""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from jackettwin.change import causes, event_effects, standing_modes
from jackettwin.change.causes import (
    ModelCauses,
    model_causes,
    seen_causes,
)
from jackettwin.change.changed_structures import Standing, braces, happenings, with_mass
from jackettwin.change.event_effects import mixing, repeated, turned
from jackettwin.change.fitted_feet import fitted_feet, namings
from jackettwin.change.ground import UNDESCRIBED, Ground, scour_loss
from jackettwin.change.standing_modes import MODES, Modes, kept_share
from jackettwin.change.working_rotor import NAME, WorkingRotor
from jackettwin.constants import SEA_WATER_KG_M3
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads import Coefficients, Water
from jackettwin.response import build_system
from jackettwin.response.modes.modal import UndampedModes, undamped_modes
from jackettwin.soil import Spring, Support
from jackettwin.soil.foundation import read_foundation
from jackettwin.structure import (
    STEEL,
    Assembly,
    Member,
    PointMass,
    Reaction,
    Section,
    Structure,
    assemble,
    check,
)
from jackettwin.twin import RotorSide, WaterConfig
from jackettwin.watching import diagnosis

LABELS = ("side_side_1", "fore_aft_1", "torsion_1")


@pytest.fixture(scope="module")
def model() -> ModelCauses:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(causes, "_DRAWS", 1)
        structure = read_structure("jacket15")
        return model_causes(structure, LABELS, np.array([0.1806, 0.1835, 0.571]), np.full(3, 0.01))


def direction(model: ModelCauses, start: str) -> np.ndarray:
    (cause,) = [c for c in model.causes if c.name.startswith(start)]
    return cause.draws.mean(axis=0)


def test_every_line_of_the_jacket_is_one_brace() -> None:
    found = braces(read_structure("jacket15"))
    assert len(found) == 36  # four faces of four bays of crosses, and four at the mudline
    assert sum(len(line) for line in found) > len(found)


def test_soil_and_scour_soften_and_lost_braces_bend_one_plane(model: ModelCauses) -> None:
    for name in ("scour at all feet", "soil softening", "marine growth", "corrosion"):
        assert np.all(direction(model, name)[:2] < 0.0)
    plane = direction(model, "brace_1_1_1 lost")[:2]
    assert max(plane / plane.sum()) > 0.8


def test_mass_at_the_top_does_what_rayleighs_quotient_says(model: ModelCauses) -> None:
    """Δ ln f = −½ Δm φ²: one per cent of the RNA is worth 0.4 % in bending, and in torsion by its inertia.

    Of that a mass has the RNA's share, between none, of one that does not turn, and twice it, on the blades.
    """
    one_percent = direction(model, "mass of the RNA") * 0.01 * 809000.0
    np.testing.assert_allclose(one_percent[:2], -0.0043, atol=5e-4)
    assert -0.5 * 0.01 < one_percent[2] < -0.25 * 0.01  # most of torsion's kinetic energy is the RNA's
    (mass,) = [c for c in model.causes if c.name == "mass of the RNA"]
    three = mass.steps(np.array([3.0 * 0.01 * 809000.0]))[0]
    np.testing.assert_allclose(three[:2], 3.0 * one_percent[:2], rtol=0.05)  # ½ Δm: bent by ¾ Δm² alone


def test_friction_adds_to_damping_and_not_to_its_logarithm(model: ModelCauses) -> None:
    """Half of what ln f loses is added to ζ = 1 %: ln ζ grows by the logarithm of one and its share of ζ."""
    (cause,) = [c for c in model.causes if c.name == "grouted or bolted connection"]
    loosened = cause.steps(np.array([5.0]))[0]
    lost, more = -loosened[:2], loosened[MODES : MODES + 2]
    assert (more > 0.2).all()
    # the ground's share of the strain energy falls by a little
    np.testing.assert_allclose(0.01 * np.expm1(more), 0.5 * lost, rtol=0.05)


def test_a_clock_moves_all_frequencies_and_no_damping(model: ModelCauses) -> None:
    assert direction(model, "sensor: clock").tolist() == [1.0] * MODES + [0.0] * (2 * MODES)
    assert [c.misfit for c in model.causes if c.name == "sensor: clock"] == [0.0]  # it is no model's
    assert "sensor: gain" in model.traceless


def test_watched_quantities_are_found_by_label(model: ModelCauses) -> None:
    quantities = (("frequency", 1), ("damping", 0), ("frequency", 2))
    seen = seen_causes(model, quantities, ("fore_aft_1", "side_side_1", "unheard_of"))
    assert seen.known.tolist() == [True, True, False]
    place = model.labels.index("side_side_1"), MODES + model.labels.index("fore_aft_1")
    np.testing.assert_array_equal(seen.causes[0].draws, model.causes[0].draws[:, place])
    assert seen.columns == place


def test_a_mode_among_members_own_ones_tells_nothing(model: ModelCauses) -> None:
    """Which of the modes beside them is which after a change nobody knows: it is no quantity of a cause."""
    assert all(model.tells(label) for label in LABELS) and not model.tells("local_1")
    mixed = replace(model, mixed=("side_side_1",))
    seen = seen_causes(mixed, (("frequency", 0), ("frequency", 1)), LABELS)
    assert seen.known.tolist() == [False, True]
    assert all(pattern.change[0] == 0.0 for pattern in mixed.patterns(LABELS))


def test_modes_are_named_as_on_the_feet_that_they_are_measured_on(stands: Standing) -> None:
    """Where torsion crosses the second bending, both are "side-side"; on stiffer feet they are not."""
    assembly = assemble(stands.structure, gravity=True)
    crossing = np.full(4, 2.5e9 * np.exp(-2.2))
    typical = replace(stands, horizontal=crossing, vertical=crossing)
    base, *others = namings(typical, assembly)
    assert "torsion_1" not in base.labels[:5] and "side_side_3" in base.labels[:5]
    (other,) = (one for one in others if set(one.labels[2:5]) == {"torsion_1", "side_side_2", "fore_aft_2"})
    np.testing.assert_array_equal(other.modes.shapes, base.modes.shapes)
    labels = ("fore_aft_1", "side_side_1", "side_side_2", "fore_aft_2", "torsion_1")
    f = dict(zip(other.labels, other.modes.frequency_hz, strict=True))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(causes, "_TYPICAL_STIFFNESS", crossing[0])
        patch.setattr(
            causes, "happenings", lambda s: [h for h in happenings(s) if h.name == "soil softening"]
        )
        found = model_causes(
            stands.structure, labels, np.array([f[name] for name in labels]), np.full(5, 0.01)
        )
    assert all(found.tells(label) for label in labels)


def test_a_lost_brace_keeps_the_mass_and_has_no_mode_of_its_own(stands: Standing) -> None:
    lost = next(h for h in happenings(stands) if h.name == "brace_2_1_1 lost").apply(stands)
    total = [check(assemble(s.structure)).mass_kg for s in (stands, lost)]
    assert total[0] == pytest.approx(total[1], rel=1e-9)
    assembly = [assemble(s.structure, gravity=True) for s in (stands, lost)]
    base = Modes.of(stands, assembly[0])
    whole = [not name.startswith("local") for name in base.labels]
    assert Modes.of(lost, assembly[1], like=base).kept[whole].min() > 0.98


def test_shapes_are_kept_by_their_part_in_those_of_the_whole() -> None:
    modes = UndampedModes(np.ones(2), np.eye(3)[:, :2])
    like = Modes(("side_side_1", "local_1"), modes, np.eye(3), np.zeros(2), np.ones(2), np.zeros(2))
    shapes = np.array([[1.0, 0.6, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 2.0]])
    np.testing.assert_allclose(kept_share(like, shapes), [1.0, 0.36, 0.0])


def test_a_model_that_misses_frequencies_is_trusted_less() -> None:
    """Four modes, two fitted numbers: without a rest √(1/3) of the usual 1 %, with one of 3 % far more."""
    structure = read_structure("jacket15")
    stiff, assembly = np.full(4, 2.5e9), assemble(structure, gravity=True)
    typical = Standing(structure, stiff, stiff)
    named, places = Modes.of(typical, assembly), [0, 1, 2, 3]
    seen = named.modes.frequency_hz[:4]
    off = seen * [1.0, 1.0, 1.03, 1.0]  # torsion, which the feet hardly move
    good, bad = (fitted_feet(typical, named, places, f, assembly).error for f in (seen, off))
    np.testing.assert_allclose(good, 0.01 / np.sqrt(3.0), rtol=1e-6)
    np.testing.assert_allclose(bad, np.sqrt((0.03**2 + 0.01**2) / 3.0), rtol=0.2)


def test_the_sea_level_has_the_slope_of_the_added_water(model: ModelCauses) -> None:
    """Water makes every mode slower, those that move at the surface most; only a level is known by name."""
    (slope,) = model.slopes((*LABELS, "unheard_of"), ("hs_m", "sea_level_m", "air_temperature_c"))
    assert slope.condition == "sea_level_m" and slope.per_unit[3] == 0.0
    assert -3e-3 < slope.per_unit[2] < 2.0 * slope.per_unit[0] < 0.0
    assert np.all(slope.std >= np.abs(slope.per_unit))


def test_bending_shows_at_the_top_and_torsion_off_the_axis(model: ModelCauses) -> None:
    named = dict(zip(model.labels, model.seen_best, strict=True))
    assert "tower" in named["fore_aft_1"] and named["fore_aft_1"][-1] != named["side_side_1"][-1]
    node = named["torsion_1"].split(" at ")[1].split(" along ")[0]
    x, y, z = read_structure("jacket15").nodes[node]
    assert np.hypot(x, y) > 1.0 and z > 72.0  # above the sea


def test_a_softening_is_a_share_of_what_the_ground_had(stands: Standing) -> None:
    """Three times a tenth is 30 %, not 27, and nothing loses more than all."""
    (soil,) = [h for h in happenings(stands) if h.name == "soil softening"]
    softer = repeated(soil, 3)
    assert softer.per == pytest.approx(0.3) and soil.largest == 1.0
    np.testing.assert_allclose(softer.apply(stands).horizontal, 0.7 * stands.horizontal)
    np.testing.assert_allclose(soil.apply(stands).vertical, 0.9 * stands.vertical)


def test_growth_is_a_ring_of_its_thickness_and_its_effect_is_known_from_millimetres_on(
    model: ModelCauses, stands: Standing
) -> None:
    """15 mm and 20 cm are rings of these, π(d + t)t; small ones act in proportion, until braces resonate."""
    (growth,) = [h for h in happenings(stands) if h.name == "marine growth"]
    (thick,) = [c for c in model.causes if c.name == "marine growth"]
    s = stands.structure
    for times, t in ((0.3, 0.015), (4.0, 0.2)):
        grown = repeated(growth, times)
        assert grown.per == pytest.approx(t) and np.isclose(thick.bent_at, t).any()
        more = sum(m.mass_kg for m in grown.apply(stands).structure.masses) - sum(m.mass_kg for m in s.masses)
        ring = [np.pi * (m.section_start.outer_diameter_m + t) * t * (1325.0 + 1025.0) for m in s.members]
        ends = [np.array([s.nodes[m.start], s.nodes[m.end]]) for m in s.members]
        long = [np.linalg.norm(b - a) for a, b in ends]
        top, low = np.max(ends, axis=1)[:, 2], np.min(ends, axis=1)[:, 2]
        wet = np.clip((s.sea_level_z_m - low) / np.maximum(top - low, 1e-9), 0.0, 1.0)
        assert more == pytest.approx(np.sum(np.array(ring) * long * wet), rel=1e-6)
    sizes = np.array([1e-3, 0.005, 0.015, 0.05])
    per_m = thick.steps(sizes) / sizes[:, None]
    first, second = (model.labels.index(name) for name in ("side_side_1", "fore_aft_2"))
    np.testing.assert_allclose(per_m[:, first], per_m[1, first], rtol=0.1)
    np.testing.assert_allclose(per_m[0, second], per_m[1, second], rtol=0.2)
    assert per_m[3, second] < 0.0 and per_m[2, second] > 0.5 * per_m[3, second]  # braces' own have crossed it


def test_growth_is_compared_with_all_that_moves(model: ModelCauses, stands: Standing) -> None:
    """Water that a twin states moves with the members as masses on their ends do: C_a = 1, half at either."""
    structure = stands.structure
    deep = structure.sea_level_z_m - min(z for _, _, z in structure.nodes.values())
    around = WaterConfig(deep, Coefficients(added_mass=1.0), Water(), adds_mass=True, sea=None)

    def displaced(member: Member) -> float:
        return SEA_WATER_KG_M3 * 0.25 * np.pi * member.section_start.outer_diameter_m**2

    masses = with_mass(stands, structure.members, displaced).structure
    f, found = np.array([0.1806, 0.1835, 0.571]), {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(causes, "_DRAWS", 1)
        patch.setattr(causes, "happenings", lambda of: [e for e in happenings(of) if e.family == "growth"])
        for name, of, water in (("water", structure, around), ("masses", masses, None)):
            wet = model_causes(of, LABELS, f, np.full(3, 0.01), water=water)
            found[name] = direction(wet, "marine")[wet.labels.index("side_side_2")]
    # braces in water move more, and the growth on them with them
    assert found["water"] == pytest.approx(found["masses"], rel=0.05)
    dry = direction(model, "marine")[model.labels.index("side_side_2")]
    assert found["water"] < 1.1 * dry < 0.0


def test_a_weakened_brace_keeps_seven_tenths_of_its_stiffness_and_all_of_its_mass() -> None:
    structure = read_structure("jacket15")
    typical = Standing(structure, np.full(4, 2.5e9), np.full(4, 2.5e9))
    (weakened,) = [h for h in happenings(typical) if h.name == "brace_1_1_1 weakened"]
    (line,) = [line for line in braces(structure) if line[0] == "brace_1_1_1"]
    for before, after in zip(structure.members, weakened.apply(typical).structure.members, strict=True):
        share = 0.7 if before.name in line else 1.0
        assert after.material.youngs_modulus_pa == pytest.approx(share * before.material.youngs_modulus_pa)
        assert after.material.shear_modulus_pa == pytest.approx(share * before.material.shear_modulus_pa)
        assert after.material.density_kg_m3 == before.material.density_kg_m3


def test_labels_that_no_mode_has_are_refused() -> None:
    with pytest.raises(InputError, match="no mode of the model"):
        model_causes(read_structure("jacket15"), ("f1",), np.array([0.2]), np.array([0.01]))


def test_a_lost_brace_turns_a_pair_and_a_clock_does_not(model: ModelCauses) -> None:
    at = [2 * MODES + model.labels.index(n) for n in ("fore_aft_1", "side_side_1")]
    assert not direction(model, "sensor: clock")[at].any()
    lost = [c.draws.mean(axis=0)[at] for c in model.causes if " lost" in c.name]
    assert all(one[0] == one[1] for one in lost)  # a pair has one direction
    assert max(abs(one[0]) for one in lost) > 0.05


def test_a_yaw_misread_turns_every_pair_either_way(model: ModelCauses) -> None:
    (yaw,) = [c for c in model.causes if c.name == "sensor: yaw misread"]
    one, other = (draw[2 * MODES + model.labels.index("fore_aft_1")] for draw in yaw.draws)
    assert one == -other
    assert np.sin(0.05 * one) ** 2 == pytest.approx(0.05)  # at the median size, sin² of the angle


def test_a_pair_turns_towards_the_softer_feet() -> None:
    """Of a square jacket whose lower mode moves along y: towards either diagonal, by as much."""
    structure = read_structure("jacket15")
    assembly = assemble(structure, gravity=True)
    even = Standing(structure, *(np.full(len(structure.reaction_nodes), 2.5e9) for _ in "hv"))
    base = Modes.of(even, assembly)
    i, j = base.labels.index("fore_aft_1"), base.labels.index("side_side_1")
    assert np.degrees(abs(base.direction[j])) == pytest.approx(90.0, abs=1.0)
    across = np.array([np.prod(np.sign(structure.nodes[n][:2])) for n in structure.reaction_nodes])
    turns = []
    for diagonal in (1.0, -1.0):  # the feet at ±(x, y), or at ±(x, −y)
        softer = np.where(across == diagonal, 0.5, 1.0)
        after = Modes.of(replace(even, vertical=even.vertical * softer), assembly, like=base)
        one, other = turned(base, after)[[i, j]]
        assert one == other  # a pair has one direction
        turns.append(one)
    assert turns[0] < -0.1  # from y towards x is negative
    assert turns[1] == pytest.approx(-turns[0], rel=0.02)


@pytest.fixture(scope="module")
def stands() -> Standing:
    structure = read_structure("jacket15")
    return Standing(structure, *(np.full(len(structure.reaction_nodes), 2.5e9) for _ in "hv"))


def test_lost_anodes_are_taken_from_the_bodies_on_the_node_then_from_the_steel(stands: Standing) -> None:
    structure = stands.structure
    member = next(m for m in structure.members if structure.nodes[m.end][2] < structure.sea_level_z_m)
    length = np.linalg.norm(np.subtract(structure.nodes[member.end], structure.nodes[member.start]))
    heavier = with_mass(stands, [member], lambda _: 20.0)
    again = with_mass(heavier, [member], lambda _: -20.0)  # all that the bodies have
    assert sum(m.mass_kg for m in again.structure.masses) == pytest.approx(
        sum(m.mass_kg for m in structure.masses)
    )
    assert again.structure.members == structure.members
    lighter = with_mass(stands, [member], lambda _: -20.0)
    (found,) = [m for m in lighter.structure.members if m.name == member.name]
    s = member.section_start
    assert s == member.section_end
    area = 0.25 * np.pi * (s.outer_diameter_m**2 - (s.outer_diameter_m - 2.0 * s.thickness_m) ** 2)
    lost = (member.material.density_kg_m3 - found.material.density_kg_m3) * area * length
    assert lost == pytest.approx(20.0 * length)
    f = [Modes.of(s, assemble(s.structure)).modes.frequency_hz for s in (lighter, stands)]
    assert np.all(f[0] >= f[1]) and f[0].sum() > f[1].sum()


def test_a_monopile_stands_on_one_foot_that_turns() -> None:
    """Softer ground takes ½ ln 0.9 of its share in ω², scour what its own stiffness loses of the same share.

    Rotation is most of it, so that a metre does nearer the loss in rotation than that in sway.
    """
    tube, slim = Section(8.0, 0.08), Section(6.5, 0.04)
    nodes = {"foot": (0.0, 0.0, -30.0), "deck": (0.0, 0.0, 15.0), "top": (0.0, 0.0, 110.0)}
    members = (
        Member("pile", "foot", "deck", tube, tube, STEEL), Member("tower", "deck", "top", slim, slim, STEEL)
    )  # fmt: skip
    pile = Structure(
        "pile", nodes, members, masses=(PointMass("top", 6e5),), reactions=(Reaction("foot"),),
        interface_nodes=("deck",), subdivide=3,
    )  # fmt: skip
    found = model_causes(pile, ("fore_aft_1",), np.array([0.21]), np.array([0.01]))
    at = found.labels.index("fore_aft_1")
    assert found.frequency_hz[at] == pytest.approx(0.21, rel=2e-3)
    soil, scour = (direction(found, name)[at] for name in ("soil softening", "scour at all feet"))
    _, _, sways, turns = UNDESCRIBED.scour_loss
    assert turns < scour / (soil * 0.1) * np.log(0.9) * -1.0 < 0.5 * (turns + sways)
    assert not [c.name for c in found.causes if c.name.startswith("scour at foot")]
    # a pile's head turns where it is pushed: what scour does to both modes, the coupling included
    piles, labels = read_foundation("jacket15"), ("fore_aft_1", "fore_aft_2")
    heads = [
        build_system(assemble(pile, gravity=True), Support((Spring("foot", head.steel + head.soil),)))
        for head in (piles.head(), piles.scoured(1.0).head())
    ]
    before, after = (undamped_modes(one, 3).frequency_hz[[0, 2]] for one in heads)
    found = model_causes(pile, labels, before, np.full(2, 0.01), ground=Ground(piles))
    scour = direction(found, "scour at all feet")[[found.labels.index(n) for n in labels]]
    true = np.log(after / before)
    np.testing.assert_allclose(scour, true, rtol=0.3)  # by the stiffness of a head kept upright, a third


def test_no_more_mass_is_lost_than_there_is(stands: Standing) -> None:
    structure = stands.structure
    member = next(m for m in structure.members if structure.nodes[m.end][2] < structure.sea_level_z_m)
    with pytest.raises(InputError, match=f"{member.name} loses more mass than there is"):
        with_mass(stands, [member], lambda _: -1e6)


def test_scour_takes_what_the_soils_own_curves_lose(stands: Standing) -> None:
    """Of a metre: the pile's head stands that much freer; without piles the shipped ones stand for them."""
    piles = read_foundation("jacket15")
    before, after = (f.head() for f in (piles, piles.scoured(1.0)))
    kept = np.diag(after.steel + after.soil) / np.diag(before.steel + before.soil)
    (scour,) = [h for h in happenings(stands) if h.name == "scour at all feet"]
    then = scour.apply(stands)
    np.testing.assert_allclose(then.horizontal / stands.horizontal, kept[0])
    np.testing.assert_allclose(then.vertical / stands.vertical, kept[2])
    assert 0.05 < -np.log(kept[0]) < 0.4 and 0.0 < -np.log(kept[2]) < 0.05
    assert Ground(piles).scour_loss == scour_loss(piles) == stands.scour_loss


def test_linear_ground_knows_no_scour() -> None:
    with pytest.raises(InputError, match="knows no scour"):
        scour_loss(read_foundation("jacket15_records"))


def test_causes_stand_on_the_feet_of_the_posterior() -> None:
    """Soft feet, as an update found them: the ground has a larger share, and softening shows more."""
    structure = read_structure("jacket15")
    rng = np.random.default_rng(3)
    found = {}
    for stiffness in (0.8e9, 8e9):
        feet = stiffness * np.exp(0.05 * rng.standard_normal((50, 2, len(structure.reaction_nodes))))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(causes, "_DRAWS", 1)
            patch.setattr(causes, "happenings", lambda s: [h for h in happenings(s) if h.family == "soil"])
            known = Ground(stiffness=feet)
            f = np.array([0.1806, 0.1835, 0.571])
            found[stiffness] = model_causes(structure, LABELS, f, np.full(3, 0.01), ground=known)
    soft, stiff = found.values()
    assert np.all(soft.frequency_hz[:2] < stiff.frequency_hz[:2])
    assert np.all(direction(soft, "soil softening")[:2] < 3.0 * direction(stiff, "soil softening")[:2])


CHEAP = "scour at foot_1", "soil softening", "brace_1_1_1 lost", "brace_1_1_1 weakened", "marine growth"


def test_effects_in_a_basis_are_those_of_every_structures_own_modes(stands: Standing) -> None:
    """To a thousandth, and of the eigenproblems no more is left than of the drawing and the best fit."""
    solved = {}
    with pytest.MonkeyPatch.context() as patch:
        counted = Mock(side_effect=undamped_modes)
        patch.setattr(standing_modes, "undamped_modes", counted)
        patch.setattr(causes, "_DRAWS", 3)
        patch.setattr(causes, "happenings", lambda s: [h for h in happenings(s) if h.name in CHEAP])
        f, zeta = np.array([0.1806, 0.1835, 0.571]), np.full(3, 0.01)
        cheap = model_causes(stands.structure, LABELS, f, zeta)
        solved["cheap"] = counted.call_count
        patch.setattr(standing_modes, "EXACT", -1.0)  # no modes in a basis are good enough
        exact = model_causes(stands.structure, LABELS, f, zeta)
        solved["exact"] = counted.call_count - solved["cheap"]
    assert len(cheap.causes) == len(CHEAP) + 2  # clock and yaw
    assert solved["exact"] > 3 + 3 * len(CHEAP) + 2 * 4  # a lost brace has one size
    assert solved["cheap"] == 4  # twice for names on other feet
    for one, other in zip(cheap.causes, exact.causes, strict=True):
        for part in np.split(np.arange(3 * MODES), 3):
            allowed = 1e-3 * np.abs(other.draws[:, part]).max()
            np.testing.assert_allclose(one.draws[:, part], other.draws[:, part], rtol=0.0, atol=allowed)
            if other.bent_at.size:
                np.testing.assert_allclose(one.bend[:, part], other.bend[:, part], rtol=0.0, atol=allowed)


def test_a_rotor_at_work_is_part_of_the_structure_and_a_cause(model: ModelCauses) -> None:
    """Stiffness k at the tower top: f² grows by φᵀkφ/ω², and what softens the ground shows less by as much.

    A rotor that adds a tenth more raises ln f by ½ · 0.1 φᵀkφ/ω², and ln ζ by its dashpot's share.
    """
    structure = read_structure("jacket15")
    side = RotorSide(3e5, np.diag([1.0, 0, 0, 0, 0, 0]), np.diag([2.0e5, 0, 0, 0, 0, 0]))
    across = RotorSide(2e4, np.diag([0, 1.0, 0, 0, 0, 0]), np.zeros((6, 6)))
    rotor = WorkingRotor({"c_fore_aft": side, "c_side_side": across})
    feet = np.full((6, 2, 4), 2.5e9)
    found = {}
    for name, one in (("parked", None), ("operating", rotor)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(causes, "_DRAWS", 1)
            patch.setattr(causes, "happenings", lambda s: [h for h in happenings(s) if h.family == "soil"])
            f, zeta = np.array([0.18, 0.19, 0.57]), np.array([0.01, 0.08, 0.01])
            ground = Ground(stiffness=feet)
            found[name] = model_causes(structure, LABELS, f, zeta, ground=ground, rotor=one)
    parked, works = found["parked"], found["operating"]
    side_side, fore_aft = (parked.labels.index(n) for n in LABELS[:2])
    raised = (works.frequency_hz / parked.frequency_hz) ** 2
    assert raised[side_side] == pytest.approx(1.0, abs=1e-3) and 1.1 < raised[fore_aft] < 1.3
    soft = [direction(m, "soil softening")[fore_aft] for m in (parked, works)]
    assert soft[1] / soft[0] == pytest.approx(1.0 / raised[fore_aft], rel=0.02)
    assert not [c for c in parked.causes if c.name == NAME]
    (cause,) = [c for c in works.causes if c.name == NAME]
    assert cause.sizes.min() < 0.0 < cause.sizes.max()  # it may add less
    stood = assemble(structure, gravity=True)
    modes = UndampedModes(np.array([1.2]), undamped_unit_top(stood))
    drawn = rotor.cause(stood, modes, np.array([0.05]), 4000, np.random.default_rng(1)).draws
    # one kilogram at the tower top alone: ½k/ω² and c/(2ωζ), with a third and a fifth of scatter
    np.testing.assert_allclose(np.median(drawn[:, 0]), 0.5 * 2.0e5 / 1.44, rtol=0.02)
    np.testing.assert_allclose(drawn[:, 0].std() / drawn[:, 0].mean(), 0.3, rtol=0.05)
    np.testing.assert_allclose(np.median(drawn[:, 1]), 3e5 / (2.0 * 1.2 * 0.05), rtol=0.02)
    np.testing.assert_allclose(np.log(drawn[:, 1]).std(), 0.2, rtol=0.05)
    assert not drawn[:, 2].any()


def undamped_unit_top(assembly: Assembly) -> np.ndarray:
    """Return a shape of a metre along x at the tower top alone, (n_dof, 1)."""
    shape = np.zeros((assembly.stiffness.shape[0], 1))
    shape[assembly.dofs(assembly.structure.top_node)[0]] = 1.0
    return shape


def test_modes_that_are_mixed_otherwise_divide_an_effect_otherwise(stands: Standing) -> None:
    """By Rayleigh's quotient: G_ij of a softer foot is what its springs lose times both modes' motion there.

    What two modes gain and lose together is nothing, and half of the tangent's angle is the rotation.
    """
    small = next(h for h in happenings(stands) if h.family == "scour at one foot")
    softer = replace(stands, horizontal=stands.horizontal * [0.97, 1.0, 1.0, 1.0])
    event = replace(small, apply=lambda _: softer, per=1.0)
    assembly = assemble(stands.structure, gravity=True)
    base = Modes.of(stands, assembly)
    rows = mixing(event, base, Modes.of(softer, assembly, like=base), 0.004)
    assert rows.shape == (MODES * (MODES - 1) // 2, 3 * MODES) and not rows[:, MODES:].any()
    square = base.modes.omega**2
    np.testing.assert_allclose(rows[:, :MODES] @ square, 0.0, atol=1e-9 * np.abs(rows * square.max()).max())
    foot = assembly.dofs(stands.structure.reaction_nodes[0])[:2]
    at = base.modes.shapes[foot]
    lost = -0.03 * stands.horizontal[0] * at.T @ at
    pairs = [(i, j) for i in range(MODES) for j in range(i)]
    for row, (i, j) in zip(rows, pairs, strict=True):
        miss = 2.0 * event_effects._MIXES * 0.004 * np.sqrt(square[i] * square[j])
        _, vectors = np.linalg.eigh([[min(square[i], square[j]), miss], [miss, max(square[i], square[j])]])
        turned_by = np.arctan(np.abs(vectors[1, 0] / vectors[0, 0]))
        # the effect is of first order in 3 % of a foot; modes of neighbouring λ mix in second order, too
        size = 0.05 * np.abs(lost).max() * turned_by / square[i]
        assert row[i] == pytest.approx(turned_by * lost[i, j] / square[i], rel=0.05, abs=size)


def test_the_error_of_a_direction_has_all_its_parts(model: ModelCauses) -> None:
    """Draws, each quantity by itself and mixing add up; a tail's multiple is not of the draws."""
    cause = next(c for c in model.causes if c.mixing is not None)
    kinds = ["frequency"] * MODES + ["damping"] * MODES + ["angle"] * MODES
    alone = np.concatenate([
        np.full(MODES, cause.misfit * np.sqrt(np.mean(part**2))) for part in np.split(cause.draws, 3, axis=1)
    ])  # fmt: skip
    apart = cause.draws - cause.draws.mean(axis=0)
    for times in (1.0, 3.0):
        root = diagnosis._misfit(cause, kinds, times)
        whole = apart.T @ apart / max(len(apart) - 1, 1) + times**2 * (
            np.diag(alone**2) + cause.mixing.T @ cause.mixing
        )
        np.testing.assert_allclose(root @ root.T, whole, atol=1e-9 * np.abs(whole).max())
