"""Member checks on columns and beams whose stresses are textbook."""

import numpy as np
import pytest

from jackettwin.checks import DesignBasis, frame_use
from jackettwin.decks import read_structure
from jackettwin.response.motion.static import nodal_load, self_weight, static_displacement
from jackettwin.response.system import build_system
from jackettwin.soil.support import clamped, pinned
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, Reaction

TUBE = Section(1.0, 0.02)
A, Z_E = 0.0615752, 0.0147904
"""By hand; test_iso19902 has the strengths of this tube at K·L = 20 m."""


def cantilever(pieces: int = 2) -> Structure:
    z = np.linspace(0.0, 10.0, pieces + 1)
    nodes = {f"n{i}": (0.0, 0.0, float(v)) for i, v in enumerate(z)}
    members = tuple(Member(f"m{i}", f"n{i}", f"n{i + 1}", TUBE, TUBE, STEEL, "tower") for i in range(pieces))
    return Structure("column", nodes, members, reactions=(Reaction("n0"),))


def displaced(structure: Structure, **forces: tuple[float, ...]) -> tuple:
    assembly = assemble(structure)
    return assembly, static_displacement(
        build_system(assembly, clamped(structure)), nodal_load(assembly, forces)
    )


def test_a_column_s_buckling_length_is_not_its_pieces() -> None:
    """A 10 m cantilever in two pieces has K·L = 20 m; 5 MN in compression: 1.18·81.20/298.70 = 0.32078."""
    structure = cantilever()
    uses = frame_use(*displaced(structure, n2=(0.0, 0.0, -5e6))).members
    for use in uses:
        assert use.by_check["compression"] == pytest.approx(0.32078, rel=1e-4)
        assert use.covered


def test_bending_at_the_foot() -> None:
    """200 kN at 10 m: σ = 2 MN·m/Z_e = 135.22 MPa, 1.05·135.22/420.49; half of it at mid-height."""
    lower, upper = frame_use(*displaced(cantilever(), n2=(2e5, 0.0, 0.0))).members
    assert lower.by_check["bending"] == pytest.approx(1.05 * 2e6 / Z_E / 420.49e6, rel=1e-4)
    assert upper.by_check["bending"] == pytest.approx(0.5 * lower.by_check["bending"], rel=1e-6)
    assert lower.check in ("section", "bending")  # the same without axial force
    # 13.2.5.1: τ = 2V/A against f_y/√3
    assert lower.by_check["shear"] == pytest.approx(1.05 * 2 * 2e5 / A / (355e6 / np.sqrt(3)), rel=1e-4)


def test_the_worst_instant_counts() -> None:
    assembly, u = displaced(cantilever(), n2=(2e5, 0.0, 1e6))
    history = np.array([0.2, -1.0, 0.5])[:, None] * u
    record, push, pull = (frame_use(assembly, v).members for v in (history, -u, 0.5 * u))
    for worst, one, other in zip(record, push, pull, strict=True):
        wanted = {name: max(one.by_check[name], other.by_check[name]) for name in one.by_check}
        assert worst.by_check == pytest.approx(wanted, rel=1e-9)


def test_forces_are_those_of_the_worst_place_and_instant() -> None:
    """A cantilever under (Fx, Fy, Fz) and a torque at its top: N = Fz, M = F·(L − z) (statics)."""
    assembly, u = displaced(cantilever(), n2=(2e5, 1e5, -3e5, 0.0, 0.0, 4e5))
    lower, upper = frame_use(assembly, np.stack([0.5 * u, u, 0.1 * u])).members
    # local axes of a vertical member: x up, y = −Y, z = X (structure.md)
    root = (-3e5, -1e5, 2e5, 4e5, -2e6, -1e6)
    assert (lower.worst.position, upper.worst.position) == (0.0, 0.0)
    np.testing.assert_allclose(lower.worst.forces, root, rtol=1e-6)
    np.testing.assert_allclose(lower.worst.end_forces[0], root, rtol=1e-6)
    middle = (*root[:4], -1e6, -0.5e6)
    np.testing.assert_allclose(lower.worst.end_forces[1], middle, rtol=1e-6)
    np.testing.assert_allclose(upper.worst.forces, middle, rtol=1e-6)
    assert upper.buckling == (2.0, 10.0)


def test_a_factor_given_for_a_part_or_member_counts() -> None:
    assembly, u = displaced(cantilever(), n2=(0.0, 0.0, -5e6))
    lower, upper = frame_use(assembly, u, DesignBasis(K={"tower": 1.0, "m1": 0.7})).members
    assert (lower.buckling.K, upper.buckling.K) == (1.0, 0.7)
    assert lower.by_check["compression"] > upper.by_check["compression"]


def test_the_legs_stand_in_compression_under_the_weight() -> None:
    """And the tower's walls are thinner than the standard covers."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    u = static_displacement(build_system(assembly, pinned(structure)), self_weight(assembly))
    uses = {use.member: use for use in frame_use(assembly, u).members}
    legs = [uses[f"leg_{k}_bay_1"] for k in (1, 2, 3, 4)]
    assert all(leg.by_check["tension"] == 0.0 and leg.covered for leg in legs)
    assert not uses["tower_1"].covered
    # the RNA leans to −x: so do the legs' forces
    behind, ahead = (
        max(leg.by_check["compression"] for leg in legs),
        min(leg.by_check["compression"] for leg in legs),
    )
    assert behind > 1.1 * ahead
