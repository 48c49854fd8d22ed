"""The state matrix with names, and its file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import (
    build_system,
    damped_modes,
    state_model,
    static_displacement,
    write_state_model,
)
from jackettwin.soil import read_support
from jackettwin.structure import Rayleigh, assemble


@pytest.mark.parametrize(
    "support", ["kelvin-voigt:k=2.5e9,c=7.6e8", "zener:k0=4.4e9,k1=3.76e9,c=6.14e8", "pinned"]
)
def test_its_poles_are_the_models_and_its_rest_the_static_displacement(support: str, tmp_path: Path) -> None:
    assembly = assemble(read_structure("jacket15"))
    system = build_system(
        assembly, read_support(support, assembly.structure), rayleigh=Rayleigh.minimum(0.01, 0.18)
    )
    write_state_model(state_model(system), tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as file:
        A, B, states, inputs = (file[key] for key in ("A", "B", "states", "inputs"))
    assert A.shape == (len(states),) * 2 and B.shape == (len(states), len(inputs))
    assert len({*states.tolist()}) == len(states)
    poles = np.linalg.eigvals(A)
    known = damped_modes(system, below_hz=1.0)
    for f, zeta in zip(known.frequency_hz, known.damping_ratio, strict=True):
        omega = 2.0 * np.pi * f
        pole = omega * complex(-zeta, np.sqrt(1.0 - zeta**2))
        assert abs(poles - pole).min() < 1e-7 * omega
    # at rest under a force by its name, the displacement by its name is the static one
    f = np.zeros(len(inputs))
    f[inputs.tolist().index("tower_top.fx_n")] = 1e5
    x = np.linalg.solve(A, -B @ f)
    load = np.zeros(assembly.n_dof)
    load[assembly.dofs("tower_top")[0]] = 1e5
    u = static_displacement(system, load)
    assert x[states.tolist().index("tower_top.ux_m")] == pytest.approx(
        u[assembly.dofs("tower_top")[0]], rel=1e-6
    )
    assert x[states.tolist().index("leg_1_2.ry_rad")] == pytest.approx(
        u[assembly.dofs("leg_1_2")[4]], rel=1e-6
    )
    if "zener" in support:  # relaxed, the dashpot has followed its foot
        foot = x[states.tolist().index("foot_1.uz_m")]
        (inner,) = (x[i] for i, name in enumerate(states.tolist()) if name.startswith("foot_1.uz_m~"))
        assert inner == pytest.approx(foot, rel=1e-9)


def test_a_springpot_has_none() -> None:
    assembly = assemble(read_structure("jacket15"))
    support = read_support("springpot:k=1e9,alpha=0.1,f0=0.18", assembly.structure)
    with pytest.raises(InputError, match="springpot has no finite number of states"):
        state_model(build_system(assembly, support))


def test_a_massless_node_is_named() -> None:
    massless = read_structure("jacket15").with_material("transition_piece", density=0.0)
    assembly = assemble(massless, subdivide=2)
    with pytest.raises(InputError, match="a degree of freedom without mass has no state"):
        state_model(build_system(assembly, read_support("pinned", massless)))
