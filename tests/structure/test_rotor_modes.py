"""A rotor in modal coordinates against the same rotor in beam elements."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.modes.own_damping import own_damping
from jackettwin.response.motion.static import self_weight
from jackettwin.response.system import build_system
from jackettwin.soil.support import Support, clamped
from jackettwin.structure import Rayleigh, Section, Structure, assemble, check
from jackettwin.structure.blades import BladeStructure
from jackettwin.structure.check import rigid_body_motion
from jackettwin.structure.masses import rigid_body_mass
from jackettwin.structure.model import STEEL, Member, PointMass, Reaction
from jackettwin.structure.rotor_modes import (
    FlexibleRotor,
    rotor_modes,
    turned_nacelle,
    with_rotor,
    without_rotor,
)
from jackettwin.structure.sections import tube_properties

HEIGHT, LENGTH, OVERHANG = 100.0, 50.0, 4.0
TOWER, TUBE = Section(5.0, 0.04), Section(1.2, 0.02)
NACELLE = PointMass("top", 2e5, (1.0, 0.0, 1.0), (1e6, 1e6, 1e6, 0.0, 0.0, 0.0))
STIFF = replace(STEEL, youngs_modulus_pa=1e6 * STEEL.youngs_modulus_pa, density_kg_m3=1e-6)


def tower() -> Structure:
    """A tower with a nacelle."""
    nodes = {f"t{k}": (0.0, 0.0, HEIGHT * k / 8) for k in range(8)} | {"top": (0.0, 0.0, HEIGHT)}
    names = list(nodes)
    members = tuple(Member(f"m{k}", names[k], names[k + 1], TOWER, TOWER, STEEL, "tower") for k in range(8))
    return Structure("turbine", nodes, members, masses=(NACELLE,), reactions=(Reaction("t0"),))


def rotor() -> FlexibleRotor:
    """Three tubes on the shaft."""
    z = np.linspace(0.0, LENGTH, 41)
    D, t = (np.array([v]) for v in (TUBE.outer_diameter_m, TUBE.thickness_m))
    p = tube_properties(D, t, np.array([0.3]))
    EI, m = (np.full(z.size, float(v[0])) for v in (STEEL.youngs_modulus_pa * p.I, STEEL.density_kg_m3 * p.A))
    blade = BladeStructure(z, m, EI, EI, np.zeros_like(z), 0.01)
    return FlexibleRotor(blade, hub_radius=0.0, overhang=OVERHANG, hub_height=0.0, tilt=0.0, cone=0.0)


def in_beams(azimuth: float) -> Structure:
    """The same of members, on a stiff shaft."""
    base = tower()
    nodes = dict(base.nodes) | {"hub": (-OVERHANG, 0.0, HEIGHT)}
    members = [*base.members, Member("shaft", "top", "hub", Section(4.0, 0.5), Section(4.0, 0.5), STIFF)]
    for blade in range(3):
        psi, last = azimuth + 2.0 * np.pi * blade / 3, "hub"
        for k in range(1, 9):
            name, r = f"b{blade}_{k}", LENGTH * k / 8
            nodes[name] = (-OVERHANG, r * np.sin(psi), HEIGHT + r * np.cos(psi))
            members.append(Member(name, last, name, TUBE, TUBE, STEEL))
            last = name
    return replace(base, nodes=nodes, members=tuple(members))


def in_modes() -> Structure:
    """The same in modal coordinates, its rigid mass within the body on the top."""
    M = rigid_body_mass(NACELLE) + rotor_modes(rotor()).rigid
    a = np.array([M[1, 5], M[2, 3], M[0, 4]]) / M[0, 0]
    inertia = M[3:, 3:] - M[0, 0] * (a @ a * np.eye(3) - np.outer(a, a))
    body = PointMass(
        "top",
        float(M[0, 0]),
        (float(a[0]), float(a[1]), float(a[2])),
        tuple(float(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))),
    )
    return with_rotor(tower().with_masses((body,)), rotor(), "top")


def frequencies(structure: Structure, number: int) -> np.ndarray:
    assembly = assemble(structure)
    return undamped_modes(build_system(assembly, clamped(structure)), number).frequency_hz


@pytest.mark.parametrize("azimuth", [0.0, 0.4])
def test_twelve_coordinates_are_a_rotor_of_beams(azimuth: float) -> None:
    """Twelve modes below and about the second tower modes, whatever the azimuth.

    Third modes of blades at six times the first pair's frequency are left out: 0.3 %.
    """
    wanted, found = (frequencies(one, 12) for one in (in_beams(azimuth), in_modes()))
    np.testing.assert_allclose(found[:10], wanted[:10], rtol=3e-3)
    rigid = frequencies(without_rotor(in_modes()), 4)
    # what the coordinates are for: rigid blades miss the modes above the first pair altogether
    assert abs(rigid[2] / wanted[2] - 1.0) > 0.05


def test_a_rigid_motion_bends_no_blade() -> None:
    """Six free motions, and the weight of the same body at the same place."""
    free = replace(in_modes(), reactions=())
    found = check(assemble(free))
    assert found.rigid_body_modes == 6
    rigid = assemble(without_rotor(free))
    # a part of the weight bends the blades; its resultant stays
    resultants = [rigid_body_motion(one).T @ self_weight(one) for one in (assemble(free), rigid)]
    np.testing.assert_allclose(*resultants, atol=1e-9 * np.abs(resultants[1]).max())


def test_turning_the_nacelle_turns_its_blades() -> None:
    """A round tower does not know where the nacelle points; half a turn keeps the planes, too."""
    start = in_modes()
    for angle in (0.7, np.pi):
        np.testing.assert_allclose(
            frequencies(turned_nacelle(start, angle), 12), frequencies(start, 12), rtol=1e-8
        )


def test_blades_have_the_damping_of_their_own() -> None:
    """1 % of every blade mode with the tower held, whatever the steel's; the steel's elsewhere."""
    structure, steel = in_modes(), Rayleigh.minimum(0.03, 0.5)
    assembly = assemble(structure)
    ((S, law),) = own_damping(assembly, steel)
    nodes = [name for name in structure.nodes if "blades" in name]
    dofs = np.concatenate([assembly.dofs(name) for name in nodes])
    held = Support(fixed=tuple((name, tuple(range(6))) for name in structure.nodes if name not in nodes))
    system = build_system(assembly, held, rayleigh=steel, spread=((S, law),))
    M, K = (np.asarray(matrix.todense()) for matrix in (system.pencil.M, system.pencil.K))
    C = steel.alpha * M + steel.beta * K + np.asarray(system.pencil.groups[-1].S.todense())
    assert system.free.tolist() == dofs.tolist()
    w2, V = np.linalg.eig(np.linalg.solve(M, K))
    ratios = np.diag(np.linalg.inv(V) @ np.linalg.solve(M, C) @ V) / (2.0 * np.sqrt(w2))
    np.testing.assert_allclose(ratios, 0.01, rtol=1e-6)


def test_a_body_lighter_than_its_blades_is_refused() -> None:
    with pytest.raises(InputError, match="does not hold its blades"):
        with_rotor(tower().with_masses((PointMass("top", 1e4),)), rotor(), "top")


def test_two_turns_are_one() -> None:
    start = in_modes()
    twice, once = turned_nacelle(turned_nacelle(start, 0.5), 0.7), turned_nacelle(start, 1.2)
    np.testing.assert_allclose([*twice.nodes.values()], [*once.nodes.values()], atol=1e-9)
    assert abs(once.nodes["top_blades_1"][1]) > 1.0  # beside the tower's axis, or nothing was turned


def test_blades_lean_into_the_wind_with_cone_and_tilt() -> None:
    """Radial parts of three blades cancel: their centre lies up the wind along the shaft, by r sin(cone).

    The wind blows along +x, to the rotor first; the shaft falls by the tilt towards its down-wind end.
    """
    tilt, cone = 0.1, 0.07
    M = rotor_modes(replace(rotor(), tilt=tilt, cone=cone)).rigid
    z = np.linspace(0.0, LENGTH, 41)
    # lumped masses at the nodes of equal pieces: their centre is that of the blade
    back = np.sin(cone) * z.mean()
    centre = [M[1, 5] / M[0, 0], M[0, 4] / M[0, 0]]
    np.testing.assert_allclose(
        centre, [-OVERHANG - back * np.cos(tilt), back * np.sin(tilt)], rtol=1e-9, atol=1e-9
    )
