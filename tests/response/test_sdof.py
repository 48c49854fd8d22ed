"""One degree of freedom: thesis section 3.1 and table 4.1 to every printed digit."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jackettwin.errors import InputError
from jackettwin.response.motion.time import free_decay
from jackettwin.response.sdof import free_vibration, poles, sdof
from jackettwin.response.state import state_matrix
from jackettwin.soil.laws.viscoelastic import Springpot, kelvin_voigt, zener

M, K0, C = 1.12e6, 1.48e6, 5.00e4
K1 = 3.1096e5
"""Printed 3.11e5; (4.16) and (4.18) follow from this value (two more digits)."""


def closed_form(zeta: float, omega: float, t: np.ndarray, *, x0: float = 1.0, v0: float = 0.0) -> np.ndarray:
    """Return x(t) of ẍ + 2ζω ẋ + ω² x = 0: under-, critically and overdamped, thesis (3.6)–(3.8)."""
    decay = np.exp(-zeta * omega * t)
    if zeta < 1.0:
        wd = omega * np.sqrt(1.0 - zeta**2)
        return np.asarray(decay * (x0 * np.cos(wd * t) + (v0 + zeta * omega * x0) / wd * np.sin(wd * t)))
    if zeta == 1.0:
        return np.asarray(decay * (x0 + (v0 + omega * x0) * t))
    root = omega * np.sqrt(zeta**2 - 1.0)
    slow, fast = -zeta * omega + root, -zeta * omega - root
    a = (v0 - fast * x0) / (slow - fast)
    return np.asarray(a * np.exp(slow * t) + (x0 - a) * np.exp(fast * t))


def test_zener_poles_to_every_printed_digit() -> None:
    """Equations (4.16)–(4.18)."""
    first, second, third = poles(sdof(M, zener(K0, C, K1)))
    assert f"{first.real:.3f} {first.imag:.3f}" == "-0.022 1.153"
    assert second == first.conjugate()
    assert f"{third.real:.3f}" == "-6.176"
    assert third.imag == 0.0
    assert f"{abs(first) / (2 * np.pi):.4f}" == "0.1836"
    assert f"{K1 / C:.3f}" == "6.219"


def test_zener_poles_are_the_roots_of_the_characteristic_polynomial() -> None:
    """Equation (4.14)."""
    omega = K1 / C
    roots = np.roots([1.0, omega, (K0 + K1) / M, K0 * omega / M])
    ours = poles(sdof(M, zener(K0, C, K1)))
    np.testing.assert_allclose(np.sort_complex(ours), np.sort_complex(roots), rtol=1e-12)


def test_state_matrix_is_the_thesis_s_with_the_branch_force_for_its_stretch() -> None:
    """(4.13) has z = k1 (x − y) where ours has y: similar matrices."""
    A = state_matrix(sdof(M, zener(K0, C, K1)))
    T = np.array([[1.0, 0, 0], [0, 1, 0], [K1, 0, -K1]])  # (x, v, z) from (x, v, y)
    thesis = np.array([[0, 1, 0], [-K0 / M, 0, -1 / M], [0, K1, -K1 / C]])
    np.testing.assert_allclose(T @ A @ np.linalg.inv(T), thesis, atol=1e-12 * np.abs(thesis).max())


@pytest.mark.parametrize(("zeta", "pair"), [(0.1, True), (2.0, False)])
def test_kelvin_voigt_poles(zeta: float, pair: bool) -> None:
    """Equations (3.6) and (3.8)."""
    omega = 2.0
    found = poles(sdof(3.0, kelvin_voigt(3.0 * omega**2, 2 * zeta * omega * 3.0)))
    root = omega * np.sqrt(complex(zeta**2 - 1.0))
    np.testing.assert_allclose(
        np.sort_complex(found), np.sort_complex(-zeta * omega + np.array([-root, root]))
    )
    assert (found.imag != 0).all() == pair


def test_critical_damping_is_a_double_real_pole() -> None:
    """Equation (3.7); a double root of a defective matrix is known to √ε."""
    found = poles(sdof(1.0, kelvin_voigt(4.0, 4.0)))
    np.testing.assert_allclose(found, [-2.0, -2.0], atol=1e-7)


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.999999, 1.0, 1.000001, 2.0])
def test_free_vibration_in_every_regime(zeta: float) -> None:
    """Figure 3.2 against an independent integration of the equation of motion."""
    omega, t = 2.0, np.linspace(0.0, 6.0, 31)
    solution = solve_ivp(
        lambda _, y: [y[1], -2 * zeta * omega * y[1] - omega**2 * y[0]],
        (0, 6), [1.0, 0.5], t_eval=t, rtol=1e-11, atol=1e-12, method="DOP853",
    )  # fmt: skip
    np.testing.assert_allclose(closed_form(zeta, omega, t, x0=1.0, v0=0.5), solution.y[0], atol=2e-8)


def test_only_the_underdamped_system_oscillates() -> None:
    t = np.linspace(0.0, 20.0, 2001)
    crossings = [int(np.sum(np.diff(np.sign(closed_form(z, 2.0, t))) != 0)) for z in (0.1, 1.0, 2.0)]
    assert crossings[0] >= 10 and crossings[1:] == [0, 0]


def test_free_decay_of_the_model_is_closed_form() -> None:
    zeta, omega, step = 0.05, 1.15, 0.1
    model = sdof(M, kelvin_voigt(M * omega**2, 2 * zeta * omega * M))
    decay = free_decay(model, np.array([0.3]), step_s=step, n_steps=200)[:, 0]
    t = step * np.arange(201)
    np.testing.assert_allclose(decay, 0.3 * closed_form(zeta, omega, t), atol=1e-11)


def test_a_springpot_has_no_state_matrix() -> None:
    with pytest.raises(InputError, match="springpot has no finite number of states"):
        poles(sdof(1.0, Springpot(1.0, 0.1, 1.0)))


@pytest.mark.parametrize(
    ("zeta", "regime"), [(0.1, "underdamped"), (1.0, "critically damped"), (2.0, "overdamped")]
)
def test_a_mass_let_go_in_every_regime(zeta: float, regime: str) -> None:
    """Thesis (3.6)–(3.8) and figure 3.2, and the decrement between maxima of the motion itself."""
    omega, mass = 2.0, 3.0
    motion = free_vibration(mass, kelvin_voigt(mass * omega**2, 2 * zeta * omega * mass), n=2001)
    assert motion.regime == regime
    np.testing.assert_allclose(motion.displacement, closed_form(zeta, omega, motion.time_s), atol=1e-9)
    if regime != "underdamped":
        assert motion.frequency_hz is None and motion.logarithmic_decrement is None
        return
    assert motion.damping_ratio == pytest.approx(zeta)
    x = motion.displacement
    peaks = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] > x[2:])]
    # maxima are read off a grid: 2001 points in five cycles
    assert np.log(peaks[0] / peaks[1]) == pytest.approx(motion.logarithmic_decrement, rel=1e-3)


def test_a_mass_on_the_thesis_s_zener_element() -> None:
    """Equations (4.16)–(4.18)."""
    motion = free_vibration(M, zener(K0, C, K1))
    assert f"{motion.frequency_hz:.4f}" == "0.1836" and motion.regime == "underdamped"
    assert f"{motion.poles[2].real:.3f}" == "-6.176"


@pytest.mark.parametrize("alpha", [0.05, 0.2, 0.5])
def test_a_mass_on_a_springpot_has_its_closed_form(alpha: float) -> None:
    """The equation m s² + k (s/ω₀)^α = 0 has the root (k/(m ω₀^α))^{1/(2−α)} e^{iπ/(2−α)}."""
    k, mass, omega0 = 5.0, 2.0, 1.3
    motion = free_vibration(mass, Springpot(k, alpha, omega0), n=4001)
    size = (k / (mass * omega0**alpha)) ** (1.0 / (2.0 - alpha))
    pole = size * np.exp(1j * np.pi / (2.0 - alpha))
    np.testing.assert_allclose(motion.poles, [pole, pole.conjugate()], rtol=1e-12)
    # let go before the element has crept, it starts with m ẍ = −F, and goes through zero as its pole does
    x = motion.displacement
    assert x[0] == 1.0 and x.min() < -0.1


def test_a_law_that_resists_nothing_holds_no_mass() -> None:
    with pytest.raises(InputError, match="without stiffness and damping"):
        free_vibration(1.0, kelvin_voigt(0.0, 0.0))
