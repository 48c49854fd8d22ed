"""Viscoelastic laws: closed forms of thesis section 4.3, limits, energy, and published shapes."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil.laws.viscoelastic import (
    Prony,
    Springpot,
    kelvin_voigt,
    loss_factor,
    maxwell,
    maxwell_3,
    prony_fit,
    zener,
)

E1, E2, ETA = 3.0, 5.0, 7.0
T = np.array([1e-6, 0.1, 0.7, 2.0, 9.0])
LAWS = {
    "maxwell": maxwell(E1, ETA),
    "kelvin-voigt": kelvin_voigt(E1, ETA),
    "zener": zener(E1, ETA, E2),
    "maxwell-3": maxwell_3(2.0, 0.2, 0.18),
    "springpot": Springpot(2.0, 0.3, 1.1),
}


def test_maxwell_relaxation_and_creep() -> None:
    """(4.4) with the sign mended: exp(−t/τ), τ = η/E; creep 1/E + t/η."""
    law = maxwell(E1, ETA)
    np.testing.assert_allclose(law.relaxation(T), E1 * np.exp(-T * E1 / ETA), rtol=1e-12)
    np.testing.assert_allclose(law.creep(T), 1 / E1 + T / ETA, rtol=1e-12)


def test_kelvin_voigt_relaxation_and_creep() -> None:
    """(4.6), and no relaxation at all."""
    law = kelvin_voigt(E1, ETA)
    np.testing.assert_allclose(law.creep(T), (1 - np.exp(-T * E1 / ETA)) / E1, rtol=1e-9)
    np.testing.assert_allclose(law.relaxation(T), E1, rtol=1e-12)


def test_zener_relaxation_and_creep() -> None:
    """(4.8) and (4.9)."""
    law = zener(E1, ETA, E2)
    tau = ETA * (E1 + E2) / (E1 * E2)
    np.testing.assert_allclose(law.creep(T), 1 / E1 - E2 / (E1 * (E1 + E2)) * np.exp(-T / tau), rtol=1e-12)
    np.testing.assert_allclose(law.relaxation(T), E1 + E2 * np.exp(-T * E2 / ETA), rtol=1e-12)


@pytest.mark.parametrize("s", [0.3j, -0.1 + 2.0j, 5.0])
def test_zener_is_the_transfer_function_of_its_differential_equation(s: complex) -> None:
    """(4.7): σ (1 + ηs/E2) = ε (E1 + η(E1+E2)s/E2)."""
    D = zener(E1, ETA, E2).stiffness(s)
    assert complex(D) == pytest.approx((E1 + ETA * (E1 + E2) / E2 * s) / (1 + ETA / E2 * s), rel=1e-12)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_creep_and_relaxation_are_each_other_s_inverse(law) -> None:
    """∫₀ᵗ J(t−u) G(u) du = t, by Gauss–Legendre over the springpot's integrable ends; KV adds c·J."""
    t = 2.0
    x, w = np.polynomial.legendre.leggauss(60)
    # u = t·sin²(φ) flattens both ends
    phi = 0.25 * np.pi * (x + 1.0)
    u, du = t * np.sin(phi) ** 2, t * np.sin(2 * phi) * 0.25 * np.pi * w
    integral = float(np.sum(law.creep(t - u) * law.relaxation(u) * du))
    if isinstance(law, Prony):
        integral += law.c * float(law.creep(np.array([t]))[0])
    # the springpot's end singularities leave 1e-4 of the quadrature
    assert integral == pytest.approx(t, rel=1e-3 if isinstance(law, Springpot) else 1e-8)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_slope_is_the_derivative(law) -> None:
    s, h = np.array([0.2 + 1.0j, -0.05 + 3.0j]), 1e-6
    numeric = (law.stiffness(s + h) - law.stiffness(s - h)) / (2 * h)
    np.testing.assert_allclose(law.slope(s), numeric, rtol=1e-8)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("f", [0.02, 0.18, 3.0])
def test_energy_lost_in_a_cycle_is_pi_times_the_loss_stiffness(law, f: float) -> None:
    rotating = 0.4 * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 4001))
    u, force = rotating.real, (law.stiffness(2j * np.pi * f) * rotating).real
    area = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(u)))
    exact = np.pi * float(law.stiffness(2j * np.pi * f).imag) * 0.4**2
    assert area == pytest.approx(exact, rel=1e-5)  # trapezoids on 4000 chords
    assert exact > 0.0


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_no_law_feeds_energy_in_and_all_are_conjugate_symmetric(law) -> None:
    s = 1j * np.geomspace(1e-4, 1e4, 50)
    assert (law.stiffness(s).imag >= 0.0).all()
    np.testing.assert_allclose(law.stiffness(s.conj()), law.stiffness(s).conj())


@pytest.mark.parametrize(("c", "limit"), [(1e-9, E1), (1e12, E1 + E2)])
def test_zener_goes_to_its_springs(c: float, limit: float) -> None:
    np.testing.assert_allclose(zener(E1, c, E2).stiffness(1j * np.array([0.5, 5.0])), limit, rtol=1e-8)


def test_zener_with_a_rigid_second_spring_is_kelvin_voigt() -> None:
    s = 1j * np.array([0.5, 5.0])
    np.testing.assert_allclose(
        zener(E1, ETA, 1e12).stiffness(s), kelvin_voigt(E1, ETA).stiffness(s), rtol=1e-9
    )


def test_kelvin_voigt_loss_factor() -> None:
    """(5.2): η = ωc/k."""
    f = np.array([0.1, 1.0])
    np.testing.assert_allclose(loss_factor(kelvin_voigt(E1, ETA), f), 2 * np.pi * f * ETA / E1)


@pytest.mark.parametrize("alpha", [0.01, 0.06, 0.5, 0.9])
def test_springpot_loss_factor_is_the_same_at_every_frequency(alpha: float) -> None:
    law = Springpot(2.0, alpha, 1.1)
    np.testing.assert_allclose(loss_factor(law, np.geomspace(1e-3, 1e3, 7)), np.tan(0.5 * np.pi * alpha))


def test_springpot_from_loss_factor() -> None:
    law = Springpot.from_loss_factor(2e9, 0.1, 1.15)
    D = complex(law.stiffness(1.15j))
    assert D.real == pytest.approx(2e9) and D.imag == pytest.approx(2e8)
    assert law.static_stiffness == pytest.approx(2e9)
    assert law.alpha == pytest.approx(2 / np.pi * np.arctan(0.1))


@pytest.mark.parametrize("f0", [0.183, 1.3])
def test_three_branches_hold_the_loss_factor_over_the_band(f0: float) -> None:
    """Least-maximum fit, η = 0.1 over 0.1–3 Hz: 0.8 % with three branches (evidence)."""
    eta = loss_factor(maxwell_3(2e9, 0.1, f0), f0 * np.geomspace(0.1 / 0.183, 3.0 / 0.183, 400))
    assert np.abs(eta / 0.1 - 1.0).max() < 0.015  # the scale is set at f0, not at the best mean: twice 0.8 %


@pytest.mark.parametrize(
    ("eta", "most"), [(0.02, 0.03), (0.05, 0.03), (0.2, 0.03), (0.3, 0.04), (0.6, 0.085)]
)
def test_three_branches_hold_any_loss_factor_like_a_springpot(eta: float, most: float) -> None:
    """Constant loss and the stiffening that goes with it, here to the second bending pair at 4.1 f0."""
    f0, f = 0.1832, 0.1832 * np.geomspace(0.55, 16.0, 400)
    law, exact = maxwell_3(2e9, eta, f0), Springpot(2e9, 2 / np.pi * np.arctan(eta), 2 * np.pi * f0)
    # measured: 0.020, 0.019, 0.016, 0.032 and 0.080; weights of one ratio leave 0.15 at 0.2 and 0.46 at 0.6
    assert np.abs(loss_factor(law, f) / eta - 1.0).max() < most
    stiffness = [x.stiffness(2j * np.pi * f0 * np.array([1.0, 4.1])).real for x in (law, exact)]
    growth = [above / at for at, above in stiffness]
    assert growth[0] == pytest.approx(growth[1], rel=0.03)


@pytest.mark.parametrize("eta", [0.01, 0.1, 0.5])
@pytest.mark.parametrize("f0", [0.15, 0.1832, 1.3])
def test_three_branches_keep_what_they_are_asked_at_the_reference(eta: float, f0: float) -> None:
    D = complex(maxwell_3(2e9, eta, f0).stiffness(2j * np.pi * f0))
    assert D.real == pytest.approx(2e9, rel=1e-12)
    assert D.imag / D.real == pytest.approx(eta, rel=1e-12)


def test_three_branches_without_loss_are_a_spring() -> None:
    assert maxwell_3(2e9, 0.0, 0.18).static_stiffness == 2e9


@pytest.mark.parametrize("alpha", [0.0, 0.06, 0.5, 0.95])
def test_prony_fit_follows_the_springpot(alpha: float) -> None:
    """Four branches a decade: 2·exp(−π²/h) = 7e-8 by theory; lumped tails leave (f/1e3)^(2−α) at the top."""
    law = Springpot(2e9, alpha, 1.15)
    fit = prony_fit(law, 1e-3, 1e3)
    s = 2j * np.pi * np.geomspace(0.05, 10.0, 40)
    np.testing.assert_allclose(fit.stiffness(s), law.stiffness(s), rtol=5e-4)
    inner = 2j * np.pi * np.array([0.5, 1.0, 2.0])
    np.testing.assert_allclose(fit.stiffness(inner), law.stiffness(inner), rtol=1e-4)


def test_branch_without_dashpot_does_nothing() -> None:
    law = Prony(k0=2.0, k=(3.0,), tau=(0.0,))
    assert complex(law.stiffness(1j)) == 2.0
    np.testing.assert_allclose(law.relaxation(T), 2.0)
    np.testing.assert_allclose(law.creep(T), 0.5)


def test_laws_are_values() -> None:
    law = zener(E1, ETA, E2)
    assert law == zener(E1, ETA, E2) and hash(law) == hash(zener(E1, ETA, E2))
    assert replace(law, k0=9.0).static_stiffness == 9.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: kelvin_voigt(-1.0, 1.0), "k: .*feed energy in .got -1.0."),
        (lambda: kelvin_voigt(1.0, np.nan), "^c: .*got nan"),
        (lambda: zener(1.0, 1.0, 0.0), "k1: must be positive"),
        (lambda: maxwell(0.0, 1.0), "k: must be positive"),
        (lambda: Prony(1.0, 0.0, (1.0,), ()), "every branch needs k and tau"),
        (lambda: kelvin_voigt(np.inf, 1.0), "k: "),
        (lambda: Springpot(0.0, 0.1, 1.0), "k: must be positive"),
        (lambda: Springpot(1.0, 1.0, 1.0), "alpha: exponent out of range .got 1.0."),
        (lambda: Springpot(1.0, 0.1, 0.0), "omega0: must be positive"),
        (lambda: maxwell_3(1.0, 0.9, 0.18), "loss_factor: .*allowed: 0 ≤ loss_factor < 0.8"),
        (lambda: maxwell_3(1.0, 0.1, 0.0), "f0: must be positive"),
        (lambda: Prony().creep(T), "without stiffness cannot carry a force"),
    ],
)
def test_laws_that_cannot_be_are_refused(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
