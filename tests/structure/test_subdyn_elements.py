"""Whole decks against SubDyn's summary files: github.com/OpenFAST/r-test (Apache-2.0), OpenFAST 3 and 4.

The decks are those of the regression tests, cut to what SubDyn's matrices depend on.
"""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.superelement.craig_bampton import (
    Superelement,
    fixed_interface_frequencies,
    superelement,
)
from jackettwin.response.system import build_system
from jackettwin.soil import own_support
from jackettwin.structure import Structure, assemble
from jackettwin.structure.cut import at_interface
from jackettwin.structure.eigen import lowest_modes
from jackettwin.structure.model import PointMass, Reaction
from jackettwin.structure.sections import rectangular_section
from jackettwin.structure.two_node import BeamSection, beam_matrices, cable_matrices, two_node_element

# six significant figures are printed
PRINTED = 2e-6

HEADERS = {
    "NJoints": "JointID JointXss JointYss JointZss JointType JointDirX JointDirY JointDirZ JointStiff",
    "NReact": "RJointID RctTDXss RctTDYss RctTDZss RctRDXss RctRDYss RctRDZss SSIfile",
    "NInterf": "IJointID ItfTDXss ItfTDYss ItfTDZss ItfRDXss ItfRDYss ItfRDZss",
    "NMembers": "MemberID MJointID1 MJointID2 MPropSetID1 MPropSetID2 MType COSMID",
    "NPropSets": "PropSetID YoungE ShearG MatDens XsecD XsecT",
    "NPropSetsRec": "PropSetID YoungE ShearG MatDens XsecSa XsecSb XsecT",
    "NXPropSets": "PropSetID YoungE ShearG MatDens XsecA XsecAsx XsecAsy XsecJxx XsecJyy XsecJ0",
    "NCablePropSets": "PropSetID EA MatDens T0 CtrlChannel",
    "NRigidPropSets": "PropSetID MatDens",
    "NSpringPropSets": "PropSetID " + " ".join(f"k{i}{j}" for i in range(1, 7) for j in range(i, 7)),
    "NCOSMs": "COSMID COSM11 COSM12 COSM13 COSM21 COSM22 COSM23 COSM31 COSM32 COSM33",
    "NCmass": "CMJointID JMass JMXX JMYY JMZZ JMXY JMXZ JMYZ MCGX MCGY MCGZ",
}


def read_deck(folder: Path, *, femmod: int = 3, ndiv: int = 1, header: str = "", **tables: str) -> Structure:
    """Return a structure read from a deck of some tables, rows divided by ``;``."""
    lines = [f"{femmod} FEMMod", f"{ndiv} NDiv"]
    for keyword, rows in tables.items():
        parts = [row.strip() for row in rows.split(";")]
        names = header if keyword == "NMembers" and header else HEADERS[keyword]
        lines += [f"{len(parts)} {keyword} - count", names, "(-) (-)", *parts]
    path = folder / "deck.dat"
    path.write_text("\n".join([*lines, "---- END"]))
    return read_structure(path)


def reduced(structure: Structure, number: int = 0) -> tuple[Superelement, np.ndarray]:
    base, _ = at_interface(structure)
    system = build_system(assemble(base), own_support(base))
    return superelement(system, number=number), fixed_interface_frequencies(system, max(number, 1))


def symmetric(values: dict[tuple[int, int], float]) -> np.ndarray:
    matrix = np.zeros((6, 6))
    for (i, j), value in values.items():
        matrix[i, j] = matrix[j, i] = value
    return matrix


def test_monopile(tmp_path: Path) -> None:
    """5MW_OC3Mnpl_Linear: three Timoshenko members in three elements each."""
    deck = read_deck(
        tmp_path,
        ndiv=3,
        NJoints="1 0 0 -20.0001 1 0 0 0 0; 2 0 0 -10 1 0 0 0 0; 3 0 0 0 1 0 0 0 0; 4 0 0 10 1 0 0 0 0",
        NReact='1 1 1 1 1 1 1 ""',
        NInterf="4 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1; 3 3 4 1 1 1 -1",
        NPropSets="1 2.1e11 8.08e10 8500 6.0 0.06",
    )
    element, _ = reduced(deck)
    K = {(0, 0): 3.530365e8, (0, 4): -5.295565e9, (2, 2): 7.837619e9, (3, 3): 1.140047e11}
    K |= {(1, 1): 3.530365e8, (1, 3): 5.295565e9, (4, 4): 1.140047e11, (5, 5): 2.660317e10}
    M = {(0, 0): 1.048670e5, (0, 4): -4.264600e5, (2, 2): 9.517173e4, (3, 3): 2.466666e6}
    M |= {(1, 1): 1.048670e5, (1, 3): 4.264600e5, (4, 4): 2.466666e6, (5, 5): 8.395859e5}
    np.testing.assert_allclose(element.interface_stiffness, symmetric(K), rtol=PRINTED, atol=1.0)
    np.testing.assert_allclose(element.interface_mass, symmetric(M), rtol=PRINTED, atol=1e-3)
    np.testing.assert_allclose(
        element.guyan_frequency_hz,
        [6.141989, 6.141989, 28.33050, 45.67286, 51.98826, 51.98826],
        rtol=PRINTED,
    )


def test_a_hanging_spar_without_reactions(tmp_path: Path) -> None:
    """SD_SparHanging: two members in ten elements each, free to move with the interface at their top."""
    deck = read_deck(
        tmp_path,
        ndiv=10,
        NJoints="1 0 0 75 1 0 0 0 0; 2 0 0 0 1 0 0 0 0; 3 0 0 -75 1 0 0 0 0",
        NInterf="1 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1",
        NPropSets="1 2.1e11 8.0e10 7850 2.4164 1.2082",
    )
    element, held = reduced(deck, 6)
    printed = [0.07769716, 0.07769716, 0.4864739, 0.4864739, 1.360155, 1.360155]
    np.testing.assert_allclose(held, printed, rtol=PRINTED)
    free = undamped_modes(build_system(assemble(deck), own_support(deck)), 12)
    assert free.n_at_rest == 6
    printed = [0.4941340, 0.4941340, 1.360329, 1.360329, 2.661805, 2.661805]
    np.testing.assert_allclose(free.frequency_hz[6:], printed, rtol=PRINTED)
    # rigid: no stiffness against the interface beside its own, and the mass of both members
    K = np.abs(element.interface_stiffness)
    assert K.max() < 1e-6 * np.diag(assemble(deck).stiffness.toarray()).max()
    assert element.interface_mass[0, 0] == pytest.approx(2 * 2.699967e6, rel=PRINTED)


def test_rigid_link(tmp_path: Path) -> None:
    """SD_Rigid: a beam whose middle is a rigid link beside a beam."""
    deck = read_deck(
        tmp_path,
        NJoints="1 0 0 0 1 0 0 0 0; 2 0 0 10 1 0 0 0 0; 3 0 0 20 1 0 0 0 0; 4 0 0 30 1 0 0 0 0",
        NReact='1 1 1 1 1 1 1 ""',
        NInterf="4 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1; 3 3 4 1 1 1 -1; 4 2 3 2 2 3 -1",
        NPropSets="1 210E9 8.0769E10 7850 1 0.05",
        NRigidPropSets="2 0",
    )
    element, fixed = reduced(deck, number=2)
    assert element.interface_stiffness[0, 0] == pytest.approx(1.627377e6, rel=PRINTED)
    assert element.interface_stiffness[3, 3] == pytest.approx(5.434118e8, rel=PRINTED)
    assert element.interface_mass[0, 4] == pytest.approx(-4.455060e4, rel=PRINTED)
    assert element.interface_mass[5, 5] == pytest.approx(2.429479e3, rel=PRINTED)
    np.testing.assert_allclose(fixed, [9.923489, 9.923489], rtol=PRINTED)


def test_cables(tmp_path: Path) -> None:
    """SD_Cable_5Joints: a stub beam between two taut cables; reaction flags under a one-word header."""
    HEADERS_BARE = {"NReact": "RJointID", "NInterf": "IJointID"}
    saved = {key: HEADERS[key] for key in HEADERS_BARE}
    HEADERS.update(HEADERS_BARE)
    try:
        deck = read_deck(
            tmp_path,
            NJoints="2 -10.1 0 0 1 0 0 0 0; 3 -0.1 0 0 1 0 0 0 0; 4 0 0 0 1 0 0 0 0; 5 0.1 0 0 1 0 0 0 0;"
            "6 10.1 0 0 1 0 0 0 0",
            NReact="2 1 1 1 1 1 1; 6 1 1 1 1 1 1",
            NInterf="4 1 1 1 1 1 1",
            NMembers="12 2 3 12 12 2 -1; 3 3 4 1 1 1 -1; 4 4 5 1 1 1 -1; 25 5 6 43 43 2 -1",
            NPropSets="1 2.1e11 8.0769e10 7850 5 1.75",
            NCablePropSets="12 210E7 7850 1E7 0; 43 420E7 7850 1E7 0",
        )
    finally:
        HEADERS.update(saved)
    element, _ = reduced(deck)
    K, M = element.interface_stiffness, element.interface_mass
    np.testing.assert_allclose(np.diag(K)[:3], [6.319941e8, 2.0e6, 2.0e6], rtol=PRINTED)
    np.testing.assert_allclose(np.diag(K)[4:], 1.999998e4, rtol=2e-5)  # what 1e11 leaves of two millions
    np.testing.assert_allclose(
        np.diag(M), [8.019851e4, 8.615929e4, 8.615929e4, 9.555369e4, 4.845141e4, 4.845141e4], rtol=PRINTED
    )
    np.testing.assert_allclose(
        element.guyan_frequency_hz[1:], [0.1022543, 0.1022543, 0.7668035, 0.7668035, 14.12842], rtol=1e-5
    )


def test_revolute_joint(tmp_path: Path) -> None:
    """SD_PendulumDamp: two free beams on a pin with a rotational spring."""
    deck = read_deck(
        tmp_path,
        NJoints="1 0 0 0 1 0 0 0 0; 2 0 0 -1 3 0 1 0 100; 3 0 0 -6 1 0 0 0 0",
        NInterf="1 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1",
        NPropSets="1 210E9 8.0769E10 7850 0.2 0.02",
    )
    assembly = assemble(deck)
    assert assembly.n_dof == 19  # SubDyn's nDOF_red
    omega, _ = lowest_modes(assembly.stiffness, assembly.mass, 13)
    np.testing.assert_allclose(
        omega[6:] / (2 * np.pi),
        [0.3810060, 35.30662, 51.01476, 117.7512, 170.4280, 285.4026, 380.1668],
        rtol=PRINTED,
    )


def test_ball_joint_lets_a_brace_only_pull(tmp_path: Path) -> None:
    """A strut hung by a ball at its top and clamped at its foot adds EA/L along and nothing to the moment."""
    columns = "1 0 0 0 1 0 0 0 0; 2 0 0 10 1 0 0 0 0; 3 0 0 20 4 0 0 0 0; 4 0 0 30 1 0 0 0 0"
    deck = read_deck(
        tmp_path,
        NJoints=columns,
        NReact='1 1 1 1 1 1 1 ""',
        NInterf="4 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1; 3 3 4 1 1 1 -1",
        NPropSets="1 210E9 8.0769E10 7850 1 0.05",
    )
    base, _ = at_interface(deck)
    K = superelement(build_system(assemble(base), own_support(base)), number=0).interface_stiffness
    # about the ball, 10 m below, the interface turns freely; along the axis three beams pull in series
    lever = np.array([10.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    A, L = np.pi * 0.95 * 0.05, 30.0
    assert np.abs(K @ lever).max() < 1e-9 * np.abs(K).max()
    assert K[2, 2] == pytest.approx(210e9 * A / L, rel=1e-9)


def test_spring_between_joints_at_one_place(tmp_path: Path) -> None:
    """Springs in series: the interface alone on a 6×6 spring on a stiff stub."""
    values = np.diag([1e6, 2e6, 3e6, 4e6, 5e6, 6e6])
    upper = " ".join(str(v) for v in values[np.triu_indices(6)])
    deck = read_deck(
        tmp_path,
        NJoints="1 0 0 0 1 0 0 0 0; 2 0 0 1 1 0 0 0 0; 3 0 0 1 1 0 0 0 0; 4 0 0 2 1 0 0 0 0",
        NReact='1 1 1 1 1 1 1 ""',
        NInterf="3 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1 -1; 2 2 3 7 7 5 9; 3 3 4 1 1 1 -1",
        NPropSets="1 210E15 80E15 7850 5 2.5",
        NSpringPropSets=f"7 {upper}",
        NCOSMs="9 0 1 0 -1 0 0 0 0 1",
    )
    base, _ = at_interface(deck)
    K = superelement(build_system(assemble(base), own_support(base)), number=0).interface_stiffness
    # the spring's own x is global y
    np.testing.assert_allclose(np.diag(K), [2e6, 1e6, 3e6, 5e6, 4e6, 6e6], rtol=1e-6)


@pytest.mark.parametrize("femmod", [1, 3])
def test_an_arbitrary_beam_with_a_tubes_numbers_is_that_tube(tmp_path: Path, femmod: int) -> None:
    D, t, nu = 1.2, 0.03, 0.3
    m2 = ((D - 2 * t) / D) ** 2
    A, inertia = np.pi * t * (D - t), np.pi / 64 * D**4 * (1 - m2**2)
    kappa = 6 * (1 + nu) ** 2 * (1 + m2) ** 2
    kappa /= (1 + m2) ** 2 * (7 + 14 * nu + 8 * nu**2) + 4 * m2 * (5 + 10 * nu + 4 * nu**2)
    E, G = 210e9, 210e9 / 2.6
    common = {
        "femmod": femmod,
        "ndiv": 2,
        "NJoints": "1 1 2 0 1 0 0 0 0; 2 3 4 10 1 0 0 0 0; 3 -2 5 18 1 0 0 0 0",
        "NReact": '1 1 1 1 1 1 1 ""',
        "NInterf": "3 1 1 1 1 1 1",
        "NPropSets": f"1 {E} {G} 7850 {D} {t}",
    }
    tube = read_deck(tmp_path, **common, NMembers="1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1")
    other = read_deck(
        tmp_path,
        **common,
        NMembers="1 1 2 1 1 1 -1; 2 2 3 4 4 4 -1",
        NXPropSets=f"4 {E} {G} 7850 {A} {kappa * A} {kappa * A} {inertia} {inertia} {2 * inertia}",
    )
    first, second = reduced(tube)[0], reduced(other)[0]
    np.testing.assert_allclose(second.K, first.K, rtol=1e-7, atol=1e-6 * np.abs(first.K).max())
    np.testing.assert_allclose(second.M, first.M, rtol=1e-7, atol=1e-6 * np.abs(first.M).max())
    # and gravity makes both as soft: P-Δ of any section is that of its axial force
    softened = [
        (assemble(deck, gravity=True).stiffness - assemble(deck).stiffness).toarray()
        for deck in (tube, other)
    ]
    lowered = [np.sort(np.linalg.eigvalsh(one)) for one in softened]
    np.testing.assert_allclose(lowered[1], lowered[0], atol=1e-6 * np.abs(lowered[0]).max())
    assert lowered[0][0] < -1e3


def test_a_column_of_arbitrary_section_gives_way_as_euler_says(tmp_path: Path) -> None:
    """Across the top of a cantilever under P stands P/(tan(κL)/κ − L), κ² = P/EI, in either plane."""
    L, E, weak, strong, load = 60.0, 210e9, 0.4, 1.1, 60e6
    # rigid in shear and light: neither is in the closed form
    deck = read_deck(
        tmp_path,
        femmod=1,
        ndiv=8,
        NJoints=f"1 0 0 0 1 0 0 0 0; 2 0 0 {L} 1 0 0 0 0",
        NReact='1 1 1 1 1 1 1 ""',
        NInterf="2 1 1 1 1 1 1",
        NMembers="1 1 2 4 4 4 0",
        NXPropSets=f"4 {E} 8e10 1e-6 2 2 2 {weak} {strong} 1.5",
        NCmass=f"2 {load / GRAVITY_M_S2} 0 0 0 0 0 0 0 0 0",
    )
    assembly = assemble(deck, gravity=True)
    held = assembly.dofs("1")
    free = np.setdiff1d(np.arange(assembly.n_dof), held)
    top = np.searchsorted(free, assembly.dofs("2")[:2])
    push = np.zeros((free.size, 2))
    push[top, [0, 1]] = 1.0
    K = assembly.stiffness.toarray()[np.ix_(free, free)]
    found = 1.0 / np.linalg.solve(K, push)[top, [0, 1]]
    wanted = []
    for inertia in (weak, strong):
        kappa = np.sqrt(load / (E * inertia))
        wanted.append(load / (np.tan(kappa * L) / kappa - L))
    # the load takes more than a tenth of what stands without it, and eight pieces come within 1e-4
    assert wanted[0] < 0.9 * 3.0 * E * weak / L**3
    np.testing.assert_allclose(np.sort(found), wanted, rtol=1e-4)


def test_a_weight_on_a_cable_is_a_pendulum() -> None:
    """Across a cable without pretension stands mg/L, and nothing without gravity."""
    top, bob, L, m = np.array([0.0, 0.0, 5.0]), np.zeros(3), 5.0, 1000.0
    K, M = cable_matrices(top, bob, EA=1e9, tension=0.0, mass_per_m=1e-9)
    # the static solution wants something across and about the bob: 1 kN/m, 1 kN·m
    hold = np.diag([0.0] * 6 + [1e3, 1e3, 0.0, 1e3, 1e3, 1e3])
    pendulum = Structure(
        "pendulum",
        {"top": (0.0, 0.0, L), "bob": (0.0, 0.0, 0.0)},
        (),
        masses=(PointMass("bob", m),),
        elements=(
            two_node_element("rope", "cable", ("top", "bob"), K, M),
            two_node_element("hold", "spring", ("top", "bob"), hold),
        ),
        reactions=(Reaction("top"),),
    )
    across = [assemble(pendulum, gravity=gravity).stiffness.toarray()[6, 6] for gravity in (False, True)]
    np.testing.assert_allclose(across, [1e3, 1e3 + m * GRAVITY_M_S2 / L], rtol=1e-9)


def test_planes_of_an_arbitrary_beam() -> None:
    """A clamped beam's tip under a force: L³/3EI + L/GA in either plane, with its own I and A."""
    section = BeamSection(A=0.2, A_x=0.1, A_y=0.16, I_x=0.01, I_y=0.04, I_p=0.05, J=0.02)
    E, G, L = 200e9, 80e9, 6.0
    K, M = beam_matrices(np.eye(3), L, section, E=E, G=G, rho=7850.0, shear=True)
    tip = np.linalg.inv(K[6:, 6:])
    assert tip[1, 1] == pytest.approx(L**3 / (3 * E * 0.04) + L / (G * 0.1))
    assert tip[2, 2] == pytest.approx(L**3 / (3 * E * 0.01) + L / (G * 0.16))
    assert tip[3, 3] == pytest.approx(L / (G * 0.02))
    lift = np.tile([0, 0, 1.0, 0, 0, 0], 2)
    assert lift @ M @ lift == pytest.approx(7850 * 0.2 * L)


def test_a_rectangular_cantilever(tmp_path: Path) -> None:
    """SD_CantileverBeam_Rectangular (OpenFAST 4.1): frequencies in its deck, to a thousandth of a hertz."""
    deck = read_deck(
        tmp_path,
        NJoints="1 0 0 0 1 0 0 0 0; 2 7.112 0 0 1 0 0 0 0; 3 14.224 0 0 1 0 0 0 0; 4 21.336 0 0 1 0 0 0 0; "
        "5 27.415 0 0 1 0 0 0 0; 6 28.448 0 0 1 0 0 0 0; 7 33.585 0 10.6 1 0 0 0 0",
        NInterf="1 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1r 0; 2 2 3 1 1 1r 0; 3 3 4 1 1 1r 0; 4 4 5 1 1 1r 0; "
        "5 5 6 2 2 3 -1; 6 6 7 2 2 3 -1",
        NPropSetsRec="1 3.44e9 1.3231e9 895.4479 12.43 7.08 0",
        NRigidPropSets="2 0",
        NCmass="7 1.93e6 0 0 0 0 0 0 0 0 0",
    )
    held = reduced(deck, 6)[1]
    np.testing.assert_allclose(held[:4], [0.977, 1.437, 4.668, 5.979], atol=5e-4)


def test_a_square_box_bends_and_twists_as_thin_walls_do(tmp_path: Path) -> None:
    """A = 4at, I = 2a³t/3, J = a³t of the middle line; Cowper's coefficient of a square box is 0.436."""
    a, t = 2.0, 0.01
    section = rectangular_section(a + t, a + t, t, poisson_ratio=0.3)
    # walls of a two-hundredth: (t/a)² of the second moment
    np.testing.assert_allclose(
        [section.A, section.I_x, section.I_y, section.J],
        [4 * a * t, 2 * a**3 * t / 3, 2 * a**3 * t / 3, a**3 * t],
        rtol=1e-4,
    )
    assert section.A_x / section.A == pytest.approx(0.436, abs=5e-4)
    with pytest.raises(InputError, match="below half the shorter side"):
        rectangular_section(2.0, 1.0, 0.5, poisson_ratio=0.3)


def test_members_with_a_division_of_their_own(tmp_path: Path) -> None:
    """MDivSize 1.25 m cuts five metres in four, and only where it is given."""
    deck = read_deck(
        tmp_path,
        header="MemberID MJointID1 MJointID2 MPropSetID1 MPropSetID2 MType MSpin/COSMID MDivSize ! [optional",
        NJoints="1 0 0 0 1 0 0 0 0; 2 0 0 5 1 0 0 0 0; 3 0 0 10 1 0 0 0 0",
        NInterf="1 1 1 1 1 1 1",
        NMembers="1 1 2 1 1 1c 0 # no length; 2 2 3 1 1 1c 0 1.25",
        NPropSets="1 2.1e11 8.08e10 7860 1 0.025",
    )
    assert [(m.name, m.elements) for m in deck.members] == [("1", None), ("2", 4)]
    mesh = assemble(deck).mesh
    assert mesh.start.size == 1 + 4
    np.testing.assert_allclose(mesh.coordinates[mesh.node_names.index("2/1")], [0.0, 0.0, 6.25])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"NMembers": "1 1 2 1 1 1r 0; 2 2 3 1 1 1 -1"}, "MemberID 1: no such property set .got '1'"),
        ({"NMembers": "1 1 2 1 1 -1 0; 2 2 3 1 1 1 -1"}, "rectangular section.*1r"),
        ({"NMembers": "1 1 2 1 2 1 -1; 2 2 3 1 1 1 -1"}, "same at both ends"),
        ({"NMembers": "1 1 2 5 5 2 -1; 2 2 3 1 1 1 -1"}, "no such property set .got '5'"),
        ({"NJoints": "1 0 0 0 1 0 0 0 0; 2 0 0 5 2 0 0 1 0; 3 0 0 9 1 0 0 0 0"}, "universal"),
        ({"NJoints": "1 0 0 0 1 0 0 0 0; 2 0 0 5 3 0 0 0 0; 3 0 0 9 1 0 0 0 0"}, "needs an axis"),
        ({"NReact": '1 1 1 2 1 1 1 ""'}, "not a flag .got '2'"),
        ({"NInterf": "3 1 1 1 1 1 0"}, "locked to the transition piece"),
    ],
)
def test_what_cannot_be_read_is_refused_by_name(tmp_path: Path, change: dict[str, str], message: str) -> None:
    deck = {
        "NJoints": "1 0 0 0 1 0 0 0 0; 2 0 0 5 1 0 0 0 0; 3 0 0 9 1 0 0 0 0",
        "NReact": '1 1 1 1 1 1 1 ""',
        "NInterf": "3 1 1 1 1 1 1",
        "NMembers": "1 1 2 1 1 1 -1; 2 2 3 1 1 1 -1",
        "NPropSets": "1 2.1e11 8.08e10 7860 1 0.025; 2 2.0e11 8.08e10 7860 1 0.025",
    }
    with pytest.raises(InputError, match=message):
        read_deck(tmp_path, **(deck | change))
