"""Modes on supports whose damping depends on the frequency."""

import numpy as np
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.response import build_system
from jackettwin.sensing.motion_model import motion_model
from jackettwin.sensing.wind_forces import RotorPlace, wind_forces
from jackettwin.soil import read_support
from jackettwin.structure import Rayleigh, assemble


def test_modes_are_damped_by_the_law_at_the_mean_of_their_frequencies() -> None:
    """φᵢᵀ Im F(iω) φⱼ/ω with ω² = ωᵢωⱼ, of a law whose loss over ω falls tenfold between the modes."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    support = read_support("zener:k0=5e8,c=1.5e9,k1=1e9", structure)
    system = build_system(assembly, support, rayleigh=Rayleigh.minimum(0.005, 0.3))
    model = motion_model(system, wind_forces(assembly, RotorPlace()), below_hz=2.2)
    x = model.shapes[system.free]
    between = np.sqrt(np.outer(model.omega, model.omega))
    loss = [
        [x[:, i] @ np.asarray(system.pencil.F(1j * w) @ x[:, j]).imag / w for j, w in enumerate(row)]
        for i, row in enumerate(between)
    ]
    assert_allclose(model.damping, loss, atol=1e-9 * np.abs(loss).max())
    slow, fast = (support.springs[0].law.stiffness(1j * w).imag / w for w in model.omega[[0, -1]])
    assert slow > 10.0 * fast
