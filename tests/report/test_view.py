"""The page carries everything it draws, and nothing of it is wrong by more than its digits."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.loads.members.coefficients import Coefficients, GrowthBand
from jackettwin.report.view.dimensions import dimensions
from jackettwin.report.view.motions import (
    damped_motion,
    measured_shape,
    record_motion,
    section_stress,
    undamped_motion,
    wave_motion,
)
from jackettwin.report.view.page import (
    ColouredQuantity,
    View,
    view_document,
    write_view,
)
from jackettwin.report.view.quantities import (
    damping_quantity,
    dissipation,
    material_quantities,
    thickness_quantities,
)
from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.motion.passage import wave_passage
from jackettwin.response.motion.playback import Playback
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.response.system import System, build_system
from jackettwin.soil import on_translations, pinned, read_foundation
from jackettwin.soil.laws.viscoelastic import kelvin_voigt
from jackettwin.structure import Rayleigh, Section, Structure, assemble, check
from jackettwin.structure.model import STEEL, Member, Reaction, RigidLink
from jackettwin.structure.two_node import two_node_element


@pytest.fixture(scope="module")
def system() -> System:
    structure = read_structure("jacket15")
    support = on_translations(structure, kelvin_voigt(2.5e9, 7.6e8))
    return build_system(assemble(structure, subdivide=2), support)


@pytest.fixture(scope="module")
def view(system: System) -> View:
    assembly = system.assembly
    still = undamped_modes(system, 2)
    damped = damped_modes(system, below_hz=0.3)
    motions = (
        undamped_motion(assembly, "1", float(still.frequency_hz[0]), still.shapes[:, 0]),
        damped_motion(assembly, "1", complex(damped.eigenvalues[0]), damped.shapes[:, 0]),
        wave_motion(assembly, wave_passage(system, height_m=8.0, period_s=9.0, n_phases=12)),
    )
    n_elements = assembly.mesh.start.size
    return View(
        assembly,
        (
            *thickness_quantities(assembly),
            ColouredQuantity("unknown", "–", np.full(n_elements, np.nan)),
        ),
        motions,
        (Sensor("top </script>", (0.0, 2.0, 0.0), "tower_top"),),
        Coefficients(growth=(GrowthBand(2.0, -40.0, 0.1),)),
        ("jacket",),
        ("a fact",),
    )


def test_geometry_and_quantities(view: View) -> None:
    found = view_document(view)
    mesh, structure = view.assembly.mesh, view.assembly.structure
    nodes = np.reshape(found["nodes"], (-1, 3))
    np.testing.assert_allclose(nodes, mesh.coordinates - [0.0, 0.0, 72.0], atol=6e-4)
    assert found["mud_z"] == pytest.approx(-72.0)
    walls, diameters = (np.array(q["values"]) for q in found["quantities"][:2])
    member = [structure.members[k] for k in mesh.member]
    legs = np.array([m.name.startswith("leg") for m in member])
    np.testing.assert_allclose(
        walls[legs],
        [1e3 * m.section_start.thickness_m for m in member if m.name.startswith("leg")],
        rtol=1e-4,
    )
    np.testing.assert_allclose(diameters[legs], 1.498065, rtol=1e-4)
    growth, z = np.array(found["growth"]), 0.5 * (nodes[mesh.start, 2] + nodes[mesh.end, 2])
    assert (growth[(z < 2.0) & (z > -40.0)] == 0.1).all()
    assert (growth[z < -40.0] == 0.0).all()
    assert sum(found["flooded"]) == 2 * sum(m.part == "jacket" for m in structure.members)
    # the nacelle's mass hangs at its own centre of gravity
    assert found["masses"][0]["at"] == pytest.approx([-3.5, 0.0, 148.0])
    assert found["masses"][0]["text"].endswith(" t, centre of mass")


def test_motions_are_scaled_and_closed(view: View, system: System) -> None:
    still, damped, wave = (motion.document() for motion in view.motions)
    for motion in (still, damped, wave):
        drawn = np.array(motion["q"]) @ np.array(motion["shapes"])
        assert np.abs(drawn).max() == pytest.approx(1.0, rel=2e-3)
    # one cycle of the damped mode takes 1/f; it has two parts, the undamped one
    assert len(still["shapes"]) == 1
    assert len(damped["shapes"]) == 2
    f = damped_modes(system, below_hz=0.3).frequency_hz[0]
    assert damped["step_s"] * len(damped["q"]) == pytest.approx(1.0 / f)
    # the few shapes of the wave give back its displacements
    passage = wave_passage(system, height_m=8.0, period_s=9.0, n_phases=12)
    top = view.assembly.mesh.node_names.index("tower_top")
    exact = passage.displacement[:, view.assembly.dofs("tower_top")[0]]
    drawn = np.array(wave["q"]) @ np.array(wave["shapes"])[:, 3 * top] * wave["largest_m"]
    np.testing.assert_allclose(drawn, exact, atol=1e-3 * np.abs(exact).max())
    assert len(wave["load"]) == 12
    assert "towards 0° from +x" in wave["note"]


def test_a_bent_and_pulled_mast_is_stressed_as_by_hand() -> None:
    """Bent to a curvature κ: E R κ everywhere; pulled by a strain ε: E ε; turned as a rigid body: nothing."""
    tube = Section(1.0, 0.02)
    mast = Structure(
        name="mast",
        nodes={"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 30.0)},
        members=(Member("mast", "foot", "top", tube, tube, STEEL),),
    )
    assembly = assemble(mast, subdivide=3)
    z = assembly.mesh.coordinates[:, 2]
    bent, pulled, turned = np.zeros((3, z.size, 6))
    bent[:, 0], bent[:, 4] = 1e-3 * z**2 / 2.0, 1e-3 * z
    pulled[:, 2] = 1e-4 * z
    turned[:, 0], turned[:, 4] = 1e-2 * z, 1e-2
    order = assembly.expand.T @ np.array([bent.ravel(), pulled.ravel(), turned.ravel()]).T
    parts = section_stress(assembly, order.T).reshape(3, -1, 3)
    found = np.abs(parts[..., 0]) + np.hypot(parts[..., 1], parts[..., 2])
    E = mast.members[0].material.youngs_modulus_pa
    np.testing.assert_allclose(found[0], E * 0.5 * 1e-3, rtol=1e-9)
    np.testing.assert_allclose(found[1], E * 1e-4, rtol=1e-9)
    np.testing.assert_allclose(found[2], 0.0, atol=1e-6 * E * 1e-3)


def test_playback_tells_the_record_s_own_time(view: View) -> None:
    """The clock of the page starts where the minute that is shown starts."""
    assembly = view.assembly
    found = Playback(np.ones((assembly.n_dof, 1)), np.ones((600, 1)), step_s=0.1, start_s=408.0)
    played = record_motion(assembly, "a", found).document()
    assert (played["start_s"], played["step_s"], played["cyclic"]) == (408.0, 0.1, False)
    assert played["note"].startswith("408 to 468 s")


def test_one_file_that_needs_no_network(view: View, tmp_path: Path) -> None:
    page = write_view(view, tmp_path / "view.html").read_text(encoding="utf-8")
    assert not re.search(r"(src|href)\s*=\s*[\"']?https?:", page)
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert data is not None
    found = json.loads(data[1].replace("<\\/", "</"))
    assert found["sensors"][0]["name"] == "top </script>"
    assert found["sensors"][0]["direction"] == [0.0, 1.0, 0.0]
    assert set(found["quantities"][-1]["values"]) == {None}
    assert "NaN" not in data[1]


def test_what_was_measured_is_drawn_in_the_model_s_amplitude_and_phase(system: System) -> None:
    """A shape in any amplitude and phase lies on the model's; what one sensor reads more of, it shows.

    Two directions at the top, one half way up: across that one, not measured, the model's motion.
    """
    assembly = system.assembly
    shape = damped_modes(system, below_hz=0.3).shapes[:, 0]
    sensors = (
        Sensor("x", (1.0, 0.0, 0.0), "tower_top"),
        Sensor("y", (0.0, 2.0, 0.0), "tower_top"),
        Sensor("low", (1.0, 0.0, 0.0), "tp_top"),
        Sensor("lean", (1.0, 0.0, 0.0), "tower_top", quantity="inclination"),
    )
    seen = observation_matrix(assembly, sensors) @ shape * (0.3 - 2.0j)
    found = measured_shape(assembly, sensors, seen, shape)
    assert found is not None
    drawn = damped_motion(assembly, "1", -0.01 + 1.2j, shape, found)
    nodes = np.reshape(drawn.shapes, (2, -1, 3))[:, found.nodes]
    np.testing.assert_allclose(np.reshape(found.shapes, nodes.shape), nodes, atol=1e-9 * np.abs(nodes).max())
    assert found.places[:, 2].tolist() == [28.0, 144.0]
    document = drawn.document()["measured"]
    assert [place["node"] for place in document["places"]] == found.nodes.tolist()
    seen[2] *= 1.2
    more = measured_shape(assembly, sensors, seen, shape)
    assert more is not None
    ratio = np.reshape(more.shapes, nodes.shape)[:, :, 0] / nodes[:, :, 0]
    assert (ratio[:, 0] / ratio[:, 1] > 1.15).all()  # the factor on both is the same
    assert measured_shape(assembly, sensors[3:], seen[3:], shape) is None


def test_what_is_no_tube_is_drawn_as_a_line() -> None:
    """A mast on a stiff foot, stayed by a cable: the cable and the rigid link are listed, with their key."""
    K = np.zeros((12, 12))
    stay = two_node_element("stay", "cable", ("top", "anchor"), K)
    mast = Structure(
        name="mast",
        nodes={"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 30.0), "anchor": (20.0, 0.0, 0.0)},
        members=(Member("mast", "foot", "top", Section(1.0, 0.02), Section(1.0, 0.02), STEEL),),
        rigid_links=(RigidLink("foot", "anchor"),),
        reactions=(Reaction("foot"),),
        elements=(stay,),
        sea_level_z_m=0.0,
    )
    assembly = assemble(mast)
    view = View(assembly, thickness_quantities(assembly))
    names = assembly.mesh.node_names
    drawn = {one["kind"]: (names[one["start"]], names[one["end"]]) for one in view_document(view)["others"]}
    assert drawn == {"cable": ("top", "anchor"), "rigid link": ("foot", "anchor")}


def test_dimensions_are_those_of_the_parameters() -> None:
    """39.39 m at the mud line and 10 m at the top are the reference jacket's B0 and B1; sea level at 72 m."""
    found = dimensions(assemble(read_structure("jacket15")))
    assert found["levels"] == [-72.0, 22.0, 28.0, 144.0]
    by_level = {round(width["a"][2], 2): width for width in found["widths"]}
    assert by_level[-72.0]["text"] == "39.39 m" and by_level[22.0]["text"] == "10.00 m"
    for width in found["widths"]:
        length = np.linalg.norm(np.subtract(width["a"], width["b"]))
        assert width["text"] == f"{length:.2f} m"
    assert [d["at"][2] for d in found["diameters"]] == [28.0, 144.0]  # the column, thicker than the tower


def test_a_leg_measures_to_its_neighbour_not_across_nor_to_the_middle() -> None:
    corners = [(5.0, 0.0, -10.0), (-2.5, 4.33, -10.0), (-2.5, -4.33, -10.0)]
    names = ("a", "b", "c")
    tube = Section(1.0, 0.05)
    structure = Structure(
        "tripod",
        dict(zip(names, corners, strict=True)) | {"middle": (0.0, 0.0, -10.0), "top": (0.0, 0.0, 30.0)},
        tuple(Member(n, n, "top", tube, tube, STEEL, "legs") for n in names)
        + (Member("m", "a", "middle", tube, tube, STEEL, "legs"),),
        reactions=tuple(Reaction(n) for n in names),
    )
    (width,) = dimensions(assemble(structure))["widths"]
    assert width["text"] == "8.66 m"


def test_colours_of_material_mass_and_damping() -> None:
    """Mass per metre times length is the steel's mass; shares of damping add to one hundred per cent."""
    foundation = read_foundation("jacket15")
    for rayleigh, where in ((Rayleigh(), "piles"), (Rayleigh.minimum(0.01, 0.18), None)):
        piled, support = foundation.piled(read_structure("jacket15"))
        if where is None:
            piled, support = read_structure("jacket15"), pinned(read_structure("jacket15"))
        system = build_system(assemble(piled), support, rayleigh=rayleigh)
        L, members = system.assembly.mesh.properties.L, piled.members
        mass = next(q for q in material_quantities(system.assembly) if q.name == "mass per metre")
        bare = replace(piled, masses=())
        assert 1e3 * mass.values @ L == pytest.approx(check(assemble(bare)).mass_kg, rel=1e-9)
        found = damping_quantity(system, damped_modes(system, below_hz=0.3))
        assert found is not None
        assert found.values @ L == pytest.approx(100.0)
        own = np.array([members[k].part == where for k in system.assembly.mesh.member])
        if where is not None:
            # by energy, the mode's own damping ratio
            modes = damped_modes(system, below_hz=0.3)
            pole, x = modes.eigenvalues[0], modes.shapes[:, 0]
            lost = dissipation(system, pole, x).sum()
            m = float((x.conj() @ (system.assembly.mass @ x)).real)
            assert lost / (2.0 * abs(pole) * m) == pytest.approx(modes.damping_ratio[0], rel=1e-6)
            # all in the ground: what is not at piles is at the members that meet their heads
            assert 50.0 < found.values[own] @ L[own] < 100.0
        else:
            assert (found.values > 0.0).all()
    still = build_system(assemble(read_structure("jacket15")), pinned(read_structure("jacket15")))
    assert damping_quantity(still, damped_modes(still, below_hz=0.3)) is None
