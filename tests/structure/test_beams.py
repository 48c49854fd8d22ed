"""Beams of any section: closed forms, invariants, and SubDyn's frequencies of a frame of all shapes."""

import json
from dataclasses import replace
from math import atan2, cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure, write_subdyn
from jackettwin.errors import InputError
from jackettwin.response import (
    build_system,
    mode_kinds,
    nodal_load,
    self_weight,
    static_displacement,
    undamped_modes,
)
from jackettwin.soil import clamped, with_static_reactions
from jackettwin.structure import (
    STEEL,
    Beam,
    BeamSection,
    Member,
    PointMass,
    Reaction,
    Section,
    Structure,
    assemble,
    at_interface,
    check,
    rigid_body_motion,
)
from jackettwin.structure.mesh import beam_axes
from jackettwin.structure.sections import i_section, rectangular_section, tube_properties
from jackettwin.updating import stages

DATA = Path(__file__).parents[1] / "data" / "subdyn"
FRAME = read_structure(DATA / "frame.yaml")
GIRDER = i_section(0.4, 0.9, 0.03, 0.016)
BOX = rectangular_section(0.5, 0.8, 0.02, poisson_ratio=0.3)
E, G, rho = 210e9, 210e9 / 2.6, 7850.0


def cantilever(
    section: BeamSection, *, tip: tuple[float, float, float] = (6.0, 0.0, 0.0), twist: float = 0.0, **more
) -> Structure:
    beam = Beam("beam", "root", "tip", section, STEEL, twist)
    nodes = {"root": (0.0, 0.0, 0.0), "tip": tip}
    return Structure("cantilever", nodes, (), beams=(beam,), reactions=(Reaction("root"),), **more)


def moved(structure: Structure, force: tuple[float, ...]) -> np.ndarray:
    """Return the motion (6,) of the tip under a force on it."""
    assembly = assemble(structure)
    load = nodal_load(assembly, {"tip": force})
    u = static_displacement(build_system(assembly, clamped(structure)), load)
    return u[assembly.dofs("tip")]


def frequencies(structure: Structure, number: int = 12, **options) -> np.ndarray:
    system = build_system(assemble(structure, **options), clamped(structure))
    return undamped_modes(system, number).frequency_hz


def turned(structure: Structure, R: np.ndarray) -> Structure:
    """Return the structure turned in space, its sections with it."""
    nodes = {name: tuple(map(float, R @ np.array(at))) for name, at in structure.nodes.items()}

    def beam(one: Beam) -> Beam:
        before = [np.array(structure.nodes[n]) for n in (one.start, one.end)]
        x = R @ beam_axes(*before, one.twist_rad)[1]
        _, y, z = beam_axes(*(R @ at for at in before), 0.0)
        return replace(one, twist_rad=atan2(x @ z, x @ y))

    return replace(structure, nodes=nodes, beams=tuple(map(beam, structure.beams)))


def test_frequencies_and_mass_of_subdyn() -> None:
    """SubDyn (OpenFAST 5) on the deck that `export` writes of a frame of tubes and turned sections.

    Timoshenko beams, three elements each, rotary inertia in the mass and shear not; seven figures.
    """
    recorded = json.loads((DATA / "members.json").read_text())["frame"]
    found = frequencies(replace(FRAME, shear_in_mass=False), 20)
    np.testing.assert_allclose(found, recorded["frequency_hz"], rtol=6e-7)
    assert check(assemble(FRAME)).mass_kg == pytest.approx(recorded["mass_kg"], rel=1e-6)


def test_a_frame_survives_as_a_deck(tmp_path: Path) -> None:
    base, _ = at_interface(FRAME)
    held = with_static_reactions(base, clamped(base))
    again = read_structure(write_subdyn(held, tmp_path / "frame.dat")[0])
    assert [b.section for b in again.beams] == [b.section for b in FRAME.beams]
    assert again.subdivide == 3
    wanted = frequencies(replace(FRAME, shear_in_mass=False))
    np.testing.assert_allclose(frequencies(again), wanted, rtol=1e-9)


@pytest.mark.parametrize("options", [{}, {"beam_theory": "timoshenko"}, {"gravity": True, "subdivide": 3}])
def test_a_tube_by_its_numbers_is_the_tube(options: dict[str, object]) -> None:
    """The same legs as members and as beams of any section; 1e-9 is what an eigensolver leaves."""
    D, t = 1.2, 0.03
    p = tube_properties(np.array(D), np.array(t))
    A, inertia, J, kappa = (float(v) for v in p)
    numbers = BeamSection(A, kappa * A, kappa * A, inertia, inertia, J, J)
    nodes = {"a": (0.0, 0.0, 0.0), "b": (7.0, 2.0, 0.0), "c": (1.0, 6.0, 0.0), "d": (3.0, 2.0, 15.0)}
    feet, body = tuple(Reaction(n) for n in "abc"), (PointMass("d", 4e4),)
    tube = Section(D, t)
    members = tuple(Member(f"{n}d", n, "d", tube, tube, STEEL) for n in "abc")
    beams = tuple(Beam(m.name, m.start, m.end, numbers, STEEL, 0.7) for m in members)
    tubes = Structure("tubes", nodes, members, body, reactions=feet)
    wanted = frequencies(tubes, 6, **options)
    found = frequencies(replace(tubes, members=(), beams=beams), 6, **options)
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


@pytest.mark.parametrize("twist_deg", [0.0, 30.0, -30.0, 90.0, 137.0])
def test_a_turned_i_bends_aside(twist_deg: float) -> None:
    """A load down on a section turned by α: aside F L³/(3E)·(1/I_y − 1/I_x) sin α cos α."""
    F, L, alpha = -1e5, 6.0, radians(twist_deg)
    u = moved(cantilever(GIRDER, twist=alpha), (0.0, 0.0, F))
    soft, stiff = F * L**3 / (3.0 * E * GIRDER.I_y), F * L**3 / (3.0 * E * GIRDER.I_x)
    # the section's x starts level (along y) and rises with α; its web is along the section's y
    down = soft * sin(alpha) ** 2 + stiff * cos(alpha) ** 2
    aside = (soft - stiff) * sin(alpha) * cos(alpha)
    np.testing.assert_allclose(u[:3], [0.0, aside, down], rtol=1e-9, atol=1e-12)


def test_a_box_twists_as_bredt_says() -> None:
    """θ = T L/(G J) with J = 4 A_m²/∮ds/t of the walls' middle lines; an I is hundreds of times softer."""
    T, L = 2e5, 6.0
    b, h, t = 0.48, 0.78, 0.02
    J = 4.0 * (b * h) ** 2 / (2.0 * (b + h) / t)
    assert moved(cantilever(BOX), (0.0, 0.0, 0.0, T, 0.0, 0.0))[3] == pytest.approx(T * L / (G * J), rel=1e-9)
    angle = moved(cantilever(GIRDER), (0.0, 0.0, 0.0, T, 0.0, 0.0))[3]
    plates = (2 * 0.4 * 0.03**3 + 0.84 * 0.016**3) / 3.0
    assert angle == pytest.approx(T * L / (G * plates), rel=1e-9)


def test_both_planes_vibrate_at_their_own_frequency() -> None:
    """ω = 1.87510²√(EI/ρA)/L² about either axis; eight elements leave less than 2e-4."""
    f = frequencies(cantilever(GIRDER), 8, subdivide=8)
    for inertia in (GIRDER.I_y, GIRDER.I_x):
        wanted = 1.875104**2 * (E * inertia / (rho * GIRDER.A)) ** 0.5 / 6.0**2 / (2.0 * pi)
        assert np.abs(f / wanted - 1.0).min() < 2e-4


@pytest.mark.parametrize("seed", range(4))
def test_frequencies_do_not_depend_on_the_frame(seed: int) -> None:
    """Turned in space with all its sections, a frame has the same frequencies."""
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    R = Q * np.sign(np.linalg.det(Q))
    np.testing.assert_allclose(frequencies(turned(FRAME, R)), frequencies(FRAME), rtol=1e-8)
    # while a section alone turned is another frame
    first = replace(FRAME.beams[0], twist_rad=FRAME.beams[0].twist_rad + 0.5)
    other = replace(FRAME, beams=(first, *FRAME.beams[1:]))
    assert np.abs(frequencies(other) / frequencies(FRAME) - 1.0).max() > 1e-4


def test_rigid_motion_mass_and_equilibrium() -> None:
    assembly = assemble(FRAME, subdivide=2)
    motion = rigid_body_motion(assembly)
    K = assembly.stiffness
    assert np.abs(K @ motion).max() < 1e-8 * np.abs(K.diagonal()).max()
    lengths = {
        b.name: np.linalg.norm(np.subtract(FRAME.nodes[b.end], FRAME.nodes[b.start])) for b in FRAME.bars
    }
    tubes = sum(
        rho * float(tube_properties(np.array(0.8), np.array(0.02)).A) * lengths[m.name] for m in FRAME.members
    )
    beams = sum(rho * b.section.A * lengths[b.name] for b in FRAME.beams)
    found = check(assembly)
    assert found.mass_kg == pytest.approx(tubes + beams, rel=1e-9)
    assert found.rigid_body_modes == 6
    # what the feet carry is the weight
    system = build_system(assembly, clamped(FRAME))
    load = self_weight(assembly)
    residue = K @ static_displacement(system, load) - load
    np.testing.assert_allclose(motion.T @ residue, -motion.T @ load, rtol=1e-8, atol=1e-3)
    held = np.concatenate([assembly.dofs(node) for node in FRAME.reaction_nodes])
    assert np.abs(np.delete(residue, held)).max() < 1e-6 * np.abs(load).max()


@pytest.mark.parametrize("twist", [0.0, 0.3, pi / 4.0])
def test_a_square_box_column_has_a_pair(twist: float) -> None:
    """However a square section is turned, its bending modes come in pairs, named by the global axes."""
    square = rectangular_section(0.6, 0.6, 0.02, poisson_ratio=0.3)
    column = cantilever(square, tip=(0.0, 0.0, 12.0), twist=twist, subdivide=4)
    system = build_system(assemble(column), clamped(column))
    modes = undamped_modes(system, 2)
    assert modes.frequency_hz[1] == pytest.approx(modes.frequency_hz[0], rel=1e-9)
    assert set(mode_kinds(system.assembly, modes.shapes, modes.frequency_hz)) == {"fore_aft", "side_side"}


def test_parts_hold_beams_as_well() -> None:
    """Stages, scaled steel and the cut at an interface take beams along with the tubes of their part."""
    stiff = FRAME.with_material("jacket", youngs_modulus=4.0)
    np.testing.assert_allclose(frequencies(stiff), 2.0 * frequencies(FRAME), rtol=1e-9)
    parted = replace(
        FRAME,
        beams=tuple(replace(b, part="deck" if "g" in (b.start, b.end) else "jacket") for b in FRAME.beams),
        members=tuple(replace(m, part="deck" if m.end == "g" else "jacket") for m in FRAME.members),
    )
    first, whole = stages(parted, 2)
    assert (first.parts, whole.parts) == (("jacket",), ("jacket", "deck"))
    assert first.mass_kg < whole.mass_kg


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("shape: box", "shape: bx", r"sections.box.shape: unknown shape .*'tube', 'box'"),
        (
            "width_m: 0.5, height_m: 0.8, thickness_m: 0.02",
            "width_m: 0.5, height_m: 0.8, thickness_m: 0.3",
            "< 0.25",
        ),
        ("web_thickness_m: 0.016", "web_thickness_m: 0.5", r"sections.girder.web_thickness_m.*< 0.4 m"),
        ("area_m2: 0.05", "area_m2: -1", "sections.own.*area_m2"),
        ("web_thickness_m: 0.016", "web_thickness_m: .nan", "sections.girder.*finite"),
        (
            "section: leg, part",
            "section: leg, twist_deg: 5, part",
            r"members.0.twist_deg.*a tube is the same",
        ),
        ("section: box, twist", "sections: [box, girder], twist", r"members.1.sections.*cut it into members"),
        (
            "section: leg, part",
            "sections: [leg, box], part",
            r"sections.box.shape: not a tube.*tube at both ends",
        ),
        ("twist_deg: 25", "twist_deg: 900", r"members.1.twist_deg.*360"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "frame.yaml"
    text = (DATA / "frame.yaml").read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_structure(path)
