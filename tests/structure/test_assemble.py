"""Assembly: rigid links, gravity, and what may be asked of it."""

from dataclasses import replace

import numpy as np
import pytest
from tests.response.conftest import monopile_structure

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import Spring, Support, clamped, pinned
from jackettwin.structure import Assembly, Section, Structure, assemble
from jackettwin.structure.model import STEEL, Material, Member, PointMass, Reaction, RigidLink

TUBE = Section(1.0, 0.05)
STIFF = Material(1e14, 1e14, 0.0)


def frequencies(assembly: Assembly, support: Support, n: int = 6) -> np.ndarray:
    return undamped_modes(build_system(assembly, support), n).frequency_hz


def portal(*, link: bool, arm: tuple[float, float, float]) -> Structure:
    """A column with an arm to a mast: the arm rigid, or a very stiff member."""
    side = (arm[0], arm[1], 10.0 + arm[2])
    nodes = {"foot": (0.0, 0.0, 0.0), "top": (0.0, 0.0, 10.0), "side": side, "tip": (side[0], side[1], 18.0)}
    members = [
        Member("column", "foot", "top", TUBE, TUBE, STEEL),
        Member("mast", "side", "tip", TUBE, TUBE, STEEL),
    ]
    if not link:
        thick = Section(2.0, 0.5)
        members.append(Member("arm", "top", "side", thick, thick, STIFF))
    return Structure(
        "portal",
        nodes,
        tuple(members),
        masses=(PointMass("tip", 2e4), PointMass("side", 1e4, (0.1, 0.2, 0.3))),
        rigid_links=(RigidLink("top", "side"),) if link else (),
        reactions=(Reaction("foot"),),
    )


@pytest.mark.parametrize(
    ("gravity", "arm"),
    # with gravity the arm stands upright: a beam's geometric stiffness knows its axial force alone
    [(False, (2.0, 1.0, 0.5)), (True, (0.0, 0.0, 1.5))],
)
def test_a_rigid_link_is_a_very_stiff_member(gravity: bool, arm: tuple[float, float, float]) -> None:
    linked, stiff = (assemble(portal(link=k, arm=arm), gravity=gravity, subdivide=4) for k in (True, False))
    assert linked.n_dof < stiff.n_dof
    a, b = (frequencies(assembly, clamped(assembly.structure)) for assembly in (linked, stiff))
    np.testing.assert_allclose(a, b, rtol=1e-5)


def test_a_follower_s_degrees_of_freedom_are_its_leader_s() -> None:
    assembly = assemble(portal(link=True, arm=(2.0, 1.0, 0.5)))
    with pytest.raises(InputError, match="follows another by a rigid link .got 'side'.*leader"):
        assembly.dofs("side")
    with pytest.raises(InputError, match="no such node .got 'roof'"):
        assembly.dofs("roof")


def test_matrices_are_symmetric_and_mass_is_positive() -> None:
    assembly = assemble(read_structure("jacket15"), gravity=True)
    for matrix in (assembly.stiffness, assembly.mass):
        assert abs(matrix - matrix.T).max() < 1e-9 * abs(matrix).max()
    assert np.linalg.eigvalsh(assembly.mass.toarray()).min() > 0.0


def rod(down: bool, *, mass: float = 1e4, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Structure:
    """A light, stiff rod of 10 m under or over its foot with a mass at the end."""
    light = Material(1e15, 1e15, 1e-3)
    end = (0.0, 0.0, -10.0 if down else 10.0)
    return Structure(
        "rod", {"foot": (0.0, 0.0, 0.0), "end": end}, (Member("rod", "foot", "end", TUBE, TUBE, light),),
        masses=(PointMass("end", mass, offset),), reactions=(Reaction("foot"),),
    )  # fmt: skip


def held_by(stiffness: float) -> Support:
    """Foot held but for the rotation about y, which has a spring."""
    spring = Spring("foot", np.diag([0, 0, 0, 0, stiffness, 0.0]))
    return Support(springs=(spring,), fixed=(("foot", (0, 1, 2, 3, 5)),))


def test_pendulum() -> None:
    """ω² = g/L: the mass hangs, and tension alone brings it back."""
    f = frequencies(assemble(rod(down=True), gravity=True), held_by(0.0), 1)
    assert (2 * np.pi * f[0]) ** 2 == pytest.approx(GRAVITY_M_S2 / 10.0, rel=1e-5)


@pytest.mark.parametrize("share", [0.2, 0.9])
def test_inverted_pendulum(share: float) -> None:
    """ω² = k/(mL²) − g/L, at 20 and 90 % of the critical weight."""
    m, L = 1e4, 10.0
    k = m * GRAVITY_M_S2 * L / share
    f = frequencies(assemble(rod(down=False), gravity=True), held_by(k), 1)
    assert (2 * np.pi * f[0]) ** 2 == pytest.approx(k / (m * L**2) - GRAVITY_M_S2 / L, rel=1e-4)


def test_an_inverted_pendulum_beyond_its_critical_weight_falls_over() -> None:
    k = 0.9 * 1e4 * GRAVITY_M_S2 * 10.0
    with pytest.raises(InputError, match="falls over"):
        frequencies(assemble(rod(down=False), gravity=True), held_by(k), 1)


@pytest.mark.parametrize("height", [3.0, -3.0])
def test_a_mass_above_its_node_leans_with_the_node(height: float) -> None:
    """Offset h above the end: ω² = k/(m(L+h)²) − g/(L+h), as if the rod were L + h long."""
    m, reach = 1e4, 10.0 + height
    k = 5.0 * m * GRAVITY_M_S2 * reach
    f = frequencies(assemble(rod(down=False, offset=(0.0, 0.0, height)), gravity=True), held_by(k), 1)
    assert (2 * np.pi * f[0]) ** 2 == pytest.approx(k / (m * reach**2) - GRAVITY_M_S2 / reach, rel=1e-4)


def test_a_column_under_its_own_weight() -> None:
    """Greenhill: w L³ = 7.8373 EI is the weight at which a uniform cantilever falls over."""
    L, n = 100.0, 40
    tube = Section(1.0, 0.02)
    nodes = {f"n{k}": (0.0, 0.0, L * k / n) for k in range(n + 1)}

    def column(density: float) -> Structure:
        material = Material(210e9, 81e9, density)
        members = tuple(Member(f"m{k}", f"n{k}", f"n{k + 1}", tube, tube, material) for k in range(n))
        return Structure("column", nodes, members, reactions=(Reaction("n0"),))

    p = assemble(column(1.0)).mesh.properties
    critical = 7.8373 * 210e9 * p.I[0] / (L**3 * p.A[0] * GRAVITY_M_S2)
    for share, stands in ((0.99, True), (1.01, False)):
        heavy = assemble(column(share * critical), gravity=True)
        if stands:
            plain = assemble(column(share * critical))
            f = [frequencies(a, clamped(a.structure), 1)[0] for a in (heavy, plain)]
            assert 0.0 < f[0] < 0.12 * f[1]  # about √(1 − 0.99) of the unloaded frequency
        else:
            with pytest.raises(InputError, match="falls over"):
                frequencies(heavy, clamped(heavy.structure), 1)


def test_subdividing_leaves_mass_alone_and_lowers_frequencies() -> None:
    structure = read_structure("jacket15")
    coarse, fine = (assemble(structure, subdivide=n) for n in (1, 3))
    f = [frequencies(a, pinned(structure), 5) for a in (coarse, fine)]
    assert (f[1] <= f[0] * (1 + 1e-9)).all()
    np.testing.assert_allclose(f[1], f[0], rtol=1e-3)


def test_options_default_to_the_structure_s_own() -> None:
    base = monopile_structure()
    own = replace(base, beam="timoshenko", subdivide=3)
    asked = assemble(base, beam_theory="timoshenko", subdivide=3)
    assert abs(assemble(own).stiffness - asked.stiffness).max() == 0.0
    assert abs(assemble(own).mass - assemble(own, rotary_inertia=True).mass).max() == 0.0


def test_frames_of_reference_agree() -> None:
    """Invariant: the same jacket turned about z and moved has the same frequencies."""
    structure = read_structure("jacket15").with_masses(())
    c, s = np.cos(0.7), np.sin(0.7)
    nodes = {
        n: (c * x - s * y + 50.0, s * x + c * y - 20.0, z - 72.0) for n, (x, y, z) in structure.nodes.items()
    }
    turned = replace(structure, nodes=nodes)
    f = [frequencies(assemble(k, gravity=True), pinned(k), 8) for k in (structure, turned)]
    np.testing.assert_allclose(f[1], f[0], rtol=1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"beam_theory": "euler"},
            "beam: unknown beam theory .got 'euler'.*timoshenko",
        ),
        ({"subdivide": 0}, "subdivide: .*allowed: 1 to 1000"),
        ({"subdivide": 100000}, "subdivide"),
    ],
)
def test_bad_options_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        assemble(monopile_structure(), **options)  # type: ignore[arg-type]


def test_gravity_needs_ground() -> None:
    with pytest.raises(InputError, match="gravity needs ground"):
        assemble(replace(monopile_structure(), reactions=()), gravity=True)
