"""Structures on draws of a posterior: none with dampers that hold its feet."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.response import System, build_system
from jackettwin.soil import read_support
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study.life.updated_system import _unlocked

OMEGA = 1.1
"""Of jacket15's first mode [rad/s]."""


@dataclass(frozen=True)
class OnFeet:
    """A model whose parameters are k and c of Kelvin–Voigt feet."""

    assembly = assemble(read_structure("jacket15"))

    def system(self, theta: np.ndarray) -> System:
        support = read_support(f"kelvin-voigt:k={theta[0]},c={theta[1]}", self.assembly.structure)
        return build_system(self.assembly, support, rayleigh=Rayleigh())


@pytest.mark.parametrize(("c", "kept"), [([1e7, 2e9, 5e8, 9e9], [1e7, 5e8]), ([3e9, 9e9, 5e9, 2e10], None)])
def test_draws_that_lock_the_feet_are_exchanged(c: list[float], kept: list[float] | None) -> None:
    """Feet of 1e9 N/m: c above k/ω loses more than the spring stores. Where all do, they stay as they are."""
    posterior = np.log([[1e9, own] for own in c])
    problem = SimpleNamespace(vectors=lambda z, state: np.exp(z), states=(None,))
    rows = np.array([0, 1, 3])
    update = SimpleNamespace(model=OnFeet(), problem=problem)
    found = np.exp(_unlocked(update, posterior, rows)[:, 1])  # type: ignore[arg-type]
    assert found.size == rows.size
    if kept is None:
        assert found == pytest.approx([3e9, 9e9, 2e10])
    else:
        assert found[0] == pytest.approx(1e7)
        assert set(np.round(found)) == set(kept)
        assert (found * OMEGA < 1e9).all()
