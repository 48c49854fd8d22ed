"""Pairs of a round column: any mixture is a mode, and the nacelle's axes choose."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.response.modes.labels import mode_kinds
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.modes.multiple import aligned
from jackettwin.response.system import build_system
from jackettwin.soil.support import clamped
from jackettwin.structure import Material, Section, Structure, assemble
from jackettwin.structure.model import Member, Reaction


@pytest.mark.parametrize("heading_deg", [0.0, 30.0, 90.0, -135.0])
def test_a_pair_stands_along_and_across_the_heading(heading_deg: float) -> None:
    tube, steel = Section(4.0, 0.03), Material(210e9, 81e9, 7850.0)
    nodes = {f"n{k}": (0.0, 0.0, 15.0 * k) for k in range(5)}
    members = tuple(Member(f"m{k}", f"n{k}", f"n{k + 1}", tube, tube, steel) for k in range(4))
    column = Structure(name="column", nodes=nodes, members=members, reactions=(Reaction("n0"),))
    assembly = assemble(column)
    modes = undamped_modes(build_system(assembly, clamped(column)), 4)
    heading = np.radians(heading_deg)
    shapes = aligned(assembly, modes.frequency_hz, modes.shapes, heading_rad=heading)
    top = (assembly.expand @ shapes)[assembly.mesh.node_dofs("n4")][:2]
    along = np.array([np.cos(heading), np.sin(heading)])
    across = np.array([-np.sin(heading), np.cos(heading)])
    np.testing.assert_allclose(np.abs(along @ top[:, ::2]), np.linalg.norm(top[:, ::2], axis=0), rtol=1e-6)
    np.testing.assert_allclose(np.abs(across @ top[:, 1::2]), np.linalg.norm(top[:, 1::2], axis=0), rtol=1e-6)
    kinds = mode_kinds(assembly, shapes, modes.frequency_hz, heading_rad=heading)
    assert kinds == ("fore_aft", "side_side", "fore_aft", "side_side")
    # across the global axes the names are the other way round
    turned = mode_kinds(assembly, shapes, modes.frequency_hz, heading_rad=heading + 0.5 * np.pi)
    assert turned == ("side_side", "fore_aft", "side_side", "fore_aft")
