"""Structure to elements."""

from dataclasses import replace

import numpy as np
import pytest
from tests.response.conftest import monopile_structure

from jackettwin.structure import Section
from jackettwin.structure.mesh import discretise, sum_of_blocks


def test_conical_members_take_the_mean_of_each_piece_and_keep_their_volume() -> None:
    """Volume of a thin cone with linear diameter and constant wall: π(D̄ − t)tL for any number of pieces."""
    base = monopile_structure(1)
    member = replace(base.members[0], section_start=Section(8.0, 0.06), section_end=Section(4.0, 0.06))
    cone = replace(base, members=(member,))
    for n in (1, 2, 7):
        p = discretise(cone, subdivide=n).properties
        assert p.A.size == n
        assert float(np.sum(p.A * p.L)) == pytest.approx(np.pi * (6.0 - 0.06) * 0.06 * 120.0, rel=1e-12)
    two = discretise(cone, subdivide=2).properties
    assert two.I[0] > two.I[1]


def test_inner_nodes_follow_the_structure_s_and_lie_on_the_members() -> None:
    structure = monopile_structure(2)
    mesh = discretise(structure, subdivide=3)
    assert mesh.node_names[:3] == ("n0", "n1", "n2")
    assert mesh.node_names[3:] == ("m0/1", "m0/2", "m1/1", "m1/2")
    np.testing.assert_allclose(mesh.coordinates[3:, 2], [20, 40, 80, 100])
    assert list(mesh.member) == [0, 0, 0, 1, 1, 1]
    np.testing.assert_array_equal(mesh.start, [0, 3, 4, 1, 5, 6])
    np.testing.assert_array_equal(mesh.end, [3, 4, 1, 5, 6, 2])


def test_local_axes_are_rotations_with_x_along_the_element() -> None:
    mesh = discretise(monopile_structure())
    for R in mesh.axes:
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)
        np.testing.assert_allclose(R[0], [0, 0, 1])


def test_shear_flexibility_only_for_timoshenko() -> None:
    structure = monopile_structure()
    assert not discretise(structure).properties.Phi.any()
    p = discretise(structure, theory="timoshenko").properties
    # thin tube: κ ≈ 1/2, I/A = D²/8: Φ = 12·2(1+ν)·(D²/8)/(κL²) = 7.8 D²/L²
    np.testing.assert_allclose(p.Phi, 7.8 * 6.93**2 / 20.0**2, rtol=0.01)


def test_blocks_are_summed_where_they_overlap() -> None:
    """A body, a beam and a spring may share DOFs; what cancels leaves no entry."""
    mesh, rng = discretise(monopile_structure(2)), np.random.default_rng(2)
    places = [np.array([3, 4, 5]), np.array([4, 5, 6, 7]), np.array([5, 0])]
    blocks = [(at, rng.normal(size=(at.size, at.size))) for at in places]
    wanted = np.zeros((mesh.n_dof, mesh.n_dof))
    for at, block in blocks:
        wanted[np.ix_(at, at)] += block
    np.testing.assert_allclose(sum_of_blocks(mesh, blocks).toarray(), wanted, atol=1e-14)
    against = [*blocks[:1], (places[0], -blocks[0][1])]
    assert sum_of_blocks(mesh, against).nnz == 0 and sum_of_blocks(mesh, []).shape == wanted.shape
