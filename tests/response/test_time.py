"""Exact stepping, internal variables included, against residue sums."""

import numpy as np
import pytest
from tests.support.time_histories import step_response

from jackettwin.response.motion.time import free_decay
from jackettwin.response.sdof import poles, sdof
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt, maxwell, maxwell_3, zener

LAWS = {
    "zener": zener(1.48e6, 5e4, 3.1096e5),
    "kelvin-voigt": kelvin_voigt(1.48e6, 2e4),
    "maxwell-3": maxwell_3(1.48e6, 0.1, 0.183),
    "two branches and a dashpot": Prony(1.2e6, 1e4, (2e5, 1e5), (0.3, 2.0)),
}
MASS = 1.12e6


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_step_response_is_the_sum_of_residues(law: Prony) -> None:
    """x(t) = 1/D(0) + Σ e^{λt} / (λ F'(λ)), F = ms² + D(s); the poles' own formula, to 1e-8."""
    model = sdof(MASS, law)
    t = 0.25 * np.arange(81)
    response = step_response(model, np.array([1e4]), step_s=0.25, n_steps=80)[:, 0]
    exact = np.full(t.size, 1.0 / law.static_stiffness, dtype=complex)
    for value in poles(model):
        slope = 2.0 * MASS * value + law.slope(value)
        exact += np.exp(value * t) / (value * slope)
    np.testing.assert_allclose(response, 1e4 * exact.real, atol=1e-8 * np.abs(response).max())


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_step_response_settles_on_the_static_deflection(law: Prony) -> None:
    response = step_response(sdof(MASS, law), np.array([1e4]), step_s=5.0, n_steps=400)[:, 0]
    assert response[-1] == pytest.approx(1e4 / law.static_stiffness, rel=1e-6)


def test_release_from_rest_starts_at_rest_with_relaxed_dashpots() -> None:
    """The first acceleration is that of the relaxed spring alone: −k0 x0/m, and no jump of the branch."""
    law, step = LAWS["zener"], 1e-4
    decay = free_decay(sdof(MASS, law), np.array([1.0]), step_s=step, n_steps=2)[:, 0]
    assert decay[0] == 1.0
    acceleration = 2.0 * (decay[1] - decay[0]) / step**2
    assert acceleration == pytest.approx(-law.k0 / MASS, rel=1e-3)  # (8 digits of cancellation in x)


def test_free_decay_does_not_depend_on_the_step() -> None:
    coarse = free_decay(sdof(MASS, LAWS["maxwell-3"]), np.array([1.0]), step_s=2.0, n_steps=10)
    fine = free_decay(sdof(MASS, LAWS["maxwell-3"]), np.array([1.0]), step_s=0.5, n_steps=40)
    np.testing.assert_allclose(coarse, fine[::4], atol=1e-12)


def test_a_mass_on_a_maxwell_element_drifts() -> None:
    """Without a parallel spring the dashpot flows for ever: velocity → f/c."""
    response = step_response(sdof(1.0, maxwell(4.0, 2.0)), np.array([1.0]), step_s=1.0, n_steps=200)[:, 0]
    assert response[-1] - response[-2] == pytest.approx(0.5, rel=1e-9)


def test_energy_never_grows() -> None:
    """Invariant: the peak of every following cycle is lower, for every passive law."""
    for law in LAWS.values():
        x = free_decay(sdof(MASS, law), np.array([1.0]), step_s=0.02, n_steps=3000)[:, 0]
        peaks = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] > x[2:])]
        assert peaks.size > 5 and (np.diff(peaks) < 0.0).all()
