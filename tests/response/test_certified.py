"""The certificate: whole bounds against the full model, symmetric structures, and proof that it can fail."""

import numpy as np
import pytest
from tests.support.law_rows import law_rows

from jackettwin.response.condensation import pole_count as certified
from jackettwin.response.condensation.condensed import Condensed, condense
from jackettwin.response.condensation.pole_count import all_modes, real_poles
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Law, Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.soil.support import Spring, Support, on_translations
from jackettwin.structure import Rayleigh

RAYLEIGH = Rayleigh.minimum(0.01, 0.1832)
AB = np.array([RAYLEIGH.alpha, RAYLEIGH.beta])


def over_the_bounds(name: str, rng: np.random.Generator) -> Law:
    """Draw from the thesis's bounds (8.6)–(8.10), locked and overdamped supports included."""
    k, k1 = 10.0 ** rng.uniform(7, 14, 2)
    c = 10.0 ** rng.uniform(4, 14)
    if name == "kelvin-voigt":
        return kelvin_voigt(k, c)
    if name == "zener":
        return zener(k, c, k1)
    if name == "maxwell-3":
        return maxwell_3(k, float(np.exp(rng.uniform(np.log(1e-4), np.log(0.6)))), 0.1832)
    return Springpot(k, float(rng.uniform(1e-4, 0.5)), 1.15)


@pytest.fixture(scope="module")
def condensed(jacket15) -> Condensed:
    support = on_translations(jacket15.structure, kelvin_voigt(1e9, 1e8))
    return condense(build_system(jacket15, support, rayleigh=RAYLEIGH), below_hz=0.95)


@pytest.mark.parametrize(
    ("name", "n"), [("kelvin-voigt", 6), ("zener", 6), ("maxwell-3", 6), ("springpot", 2)]
)
def test_nothing_is_missed_duplicated_or_spurious(jacket15, condensed: Condensed, name: str, n: int) -> None:
    """A seeded share of `make qualify`, which draws ten thousand."""
    rng = np.random.default_rng(20 + len(name))
    for _ in range(n):
        law = over_the_bounds(name, rng)
        rows = law_rows([law])
        found = all_modes(condensed, rows, AB)
        system = build_system(jacket15, on_translations(jacket15.structure, law), rayleigh=RAYLEIGH)
        exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
        assert found.certified, law
        # the full model itself is rounded to about 1e-9 with the stiffest supports
        np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-8, err_msg=str(law))
        if found.n_real is not None:
            assert found.n_real == exact.real_poles.size, law


def test_a_hundred_sets_a_law_are_certified(condensed: Condensed) -> None:
    rng = np.random.default_rng(7)
    for name in ("kelvin-voigt", "zener", "maxwell-3", "springpot"):
        for _ in range(100):
            law = over_the_bounds(name, rng)
            assert all_modes(condensed, law_rows([law]), AB).certified, law


@pytest.mark.parametrize(
    "law", [kelvin_voigt(2.5e9, 7.6e8), zener(2.62e9, 8.65e8, 9.99e9), maxwell_3(3e9, 0.2, 0.183)]
)
def test_real_poles_are_those_of_the_full_model(jacket15, condensed: Condensed, law: Law) -> None:
    rows = law_rows([law])
    found = all_modes(condensed, rows, AB)
    system = build_system(jacket15, on_translations(jacket15.structure, law), rayleigh=RAYLEIGH)
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    ours = real_poles(condensed, rows, AB, found)
    assert ours.size == found.n_real
    np.testing.assert_allclose(ours, exact.real_poles, rtol=1e-8)


def test_a_symmetric_structure_has_every_bending_mode_twice(monopile) -> None:
    """A tube's two bending directions have the same pole: one of each would be one too few."""
    support = Support(springs=(Spring("n0", np.diag([1.0, 1, 1, 400, 400, 400]), zener(1e9, 1e8, 1e9)),))
    system = build_system(monopile, support, rayleigh=RAYLEIGH)
    condensed = condense(system, below_hz=1.0)
    found = all_modes(condensed, law_rows([zener(1e9, 1e8, 1e9)]), AB)
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    assert found.certified
    np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-9)


def test_a_set_with_a_mode_too_few_is_not_certified(
    condensed: Condensed, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = law_rows([kelvin_voigt(2.5e9, 7.6e8)])
    starts = certified._starts

    def without_one(*args, **options):
        values, vectors = starts(*args, **options)
        keep = np.abs(np.abs(values) - 2 * np.pi * 0.572) > 0.1  # torsion
        return values[keep], vectors[:, keep]

    monkeypatch.setattr(certified, "_starts", without_one)
    found = all_modes(condensed, rows, AB)
    assert len(found.poles) == 4 and not found.certified


def test_a_set_with_a_mode_too_many_is_not_certified(
    condensed: Condensed, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = law_rows([kelvin_voigt(2.5e9, 7.6e8)])

    def with_one_more(poles, shapes):
        return np.append(poles, -0.1 + 2j), np.vstack([shapes, shapes[:1]])

    monkeypatch.setattr(certified, "_distinct", with_one_more)
    assert not all_modes(condensed, rows, AB).certified


@pytest.mark.parametrize("law", [kelvin_voigt(2.5e9, 7.6e8), Springpot(3e9, 0.06, 1.15)])
def test_many_retained_modes_are_eliminated_without_loss(jacket15, law: Law) -> None:
    """Some of the thirty retained modes are beside their resonance on fixed feet."""
    steel = Rayleigh.minimum(0.003, 0.6)
    system = build_system(jacket15, on_translations(jacket15.structure, law), rayleigh=steel)
    wide = condense(system, below_hz=3.0)
    found = all_modes(wide, law_rows([law]), np.array([steel.alpha, steel.beta]))
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    assert found.certified and found.poles.size == 18
    np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-8)
