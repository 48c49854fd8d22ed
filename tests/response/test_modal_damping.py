"""Damping by mode, thesis (2.1): each named mode has its ratio, the others keep Rayleigh's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, damped_modes, modal_damping
from jackettwin.soil import Prony, family, pinned
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import NuisanceParameters, support_model

OC4 = Path(__file__).parents[2] / "qualify" / "decks" / "oc4_jacket.dat"


@pytest.fixture(scope="module", params=["jacket15", OC4], ids=["jacket15", "symmetric"])
def assembly(request: pytest.FixtureRequest) -> Assembly:
    return assemble(read_structure(request.param))


def ratios(assembly: Assembly, given: dict[int, float], rayleigh: Rayleigh) -> np.ndarray:
    C = modal_damping(assembly, given, rayleigh)
    held = pinned(assembly.structure)
    system = build_system(assembly, held, rayleigh=rayleigh, spread=((C, Prony(c=1.0)),))
    return damped_modes(system, below_hz=1.3).damping_ratio[:5]


@pytest.mark.parametrize("rayleigh", [Rayleigh(), Rayleigh.minimum(0.002, 0.25)], ids=["alone", "beside"])
def test_each_named_mode_has_its_ratio(assembly: Assembly, rayleigh: Rayleigh) -> None:
    """On pinned feet ζ is exact: C is diagonal in the modes. Bending pairs 0.4 % apart keep theirs apart."""
    given = {1: 0.005, 2: 0.02, 4: 0.01}
    found = ratios(assembly, given, rayleigh)
    bare = ratios(assembly, {}, rayleigh)
    np.testing.assert_allclose(found[[0, 1, 3]], [0.005, 0.02, 0.01], rtol=1e-6)
    # the others keep Rayleigh's; zero to rounding where there is none
    np.testing.assert_allclose(found[[2, 4]], bare[[2, 4]], rtol=1e-6, atol=1e-9)


def test_it_takes_energy_out_of_every_motion(assembly: Assembly) -> None:
    C = modal_damping(assembly, {1: 0.01, 2: 0.01, 5: 0.02}).toarray()
    np.testing.assert_allclose(C, C.T, rtol=0.0, atol=1e-12 * abs(C).max())
    assert np.linalg.matrix_rank(C, tol=1e-9 * np.linalg.norm(C, 2)) == 3
    assert np.linalg.eigvalsh(C).min() > -1e-9 * np.linalg.norm(C, 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({1: -0.01}, "damping.modes.1: a modal damping ratio is out of range"),
        ({0: 0.01}, "damping.modes.0"),
        ({1: float("nan")}, "out of range"),
        ({1: 0.001}, "damping.modes.1: is less than the Rayleigh damping"),
    ],
)
def test_wrong_ratios_are_refused(assembly: Assembly, given: dict[int, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        modal_damping(assembly, given, Rayleigh.minimum(0.005, 0.25))


def test_the_model_that_is_updated_has_it_too(assembly: Assembly) -> None:
    """The condensed model against the full one, on springs that take part in every mode."""
    given = {"modes": modal_damping(assembly, {1: 0.01, 2: 0.02, 4: 0.015})}
    law = family("kelvin-voigt")
    nuisance = NuisanceParameters(given=given)
    model = support_model(assembly, family=law, rayleigh=Rayleigh(), highest_mode=5, nuisance=nuisance)
    theta = np.array([2.5e9, 1e7])
    exact = model.exact_modes(theta, (1, 2, 4))
    found = model.predict(theta, (1, 2, 4)).poles
    # what is spread acts without the truncated modes: 4e-5 of f4 for water, which moves unlike a mode
    np.testing.assert_allclose(found, exact.poles, rtol=1e-5)
    undamped = support_model(assembly, family=law, rayleigh=Rayleigh(), highest_mode=5)
    assert (-found.real / abs(found) > -undamped.predict(theta, (1, 2, 4)).poles.real / abs(found)).all()
