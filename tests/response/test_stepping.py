"""First-order hold, feedback and periodic starts against SciPy and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import cont2discrete
from tests.support.energy import energy

from jackettwin.errors import InputError
from jackettwin.response.motion.time import (
    first_order_hold,
    march,
    march_with_feedback,
    periodic_start,
    state_space,
)
from jackettwin.response.sdof import sdof
from jackettwin.response.system import Pencil
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt, zener
from jackettwin.structure import Rayleigh

MODELS = {
    "kelvin-voigt": sdof(1.12e6, kelvin_voigt(1.48e6, 2e4)),
    "zener": sdof(1.12e6, zener(1.48e6, 5e4, 3.1096e5)),
    "near-locked": sdof(1e4, Prony(2.5e9, 0.0, (1e9,), (1e3,))),
}


@pytest.mark.parametrize("pencil", MODELS.values(), ids=MODELS)
def test_the_hold_is_scipys(pencil: Pencil) -> None:
    """SciPy absorbs P1 f into the state: its input matrix is P0 + E P1, its feed-through P1."""
    space = state_space(pencil)
    hold = first_order_hold(space.A, space.B, 0.05)
    Ad, Bd, _, Dd, _ = cont2discrete(
        (space.A, space.B, np.eye(space.A.shape[0]), np.zeros_like(space.B)), 0.05, "foh"
    )
    scale = np.abs(hold.E).max()
    np.testing.assert_allclose(hold.E, Ad, atol=1e-12 * scale)
    np.testing.assert_allclose(hold.P1, Dd, rtol=1e-6, atol=1e-12 * np.abs(Dd).max())
    np.testing.assert_allclose(hold.P0 + hold.E @ hold.P1, Bd, rtol=1e-6, atol=1e-12 * np.abs(Bd).max())


def test_a_ramp_is_exact_at_any_step() -> None:
    """A force that grows evenly: the state after 40 s is the same in 4 steps as in 400."""
    space = state_space(MODELS["zener"])
    ends = []
    for n in (4, 400):
        hold = first_order_hold(space.A, space.B, 40.0 / n)
        ends.append(march(hold, np.zeros(3), np.linspace(0.0, 1e4, n + 1)[:, None])[-1])
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-10)


def test_a_sine_converges_with_the_second_order() -> None:
    """Chords of a sine: halving the step quarters the error; against the steady closed form."""
    pencil = MODELS["zener"]
    space, omega = state_space(pencil), 0.9
    H = 1.0 / complex(pencil.F(1j * omega)[0, 0])
    errors = []
    for n in (40, 80, 160):
        t = np.linspace(0.0, 2.0 * np.pi / omega, n + 1)
        f = 1e4 * np.cos(omega * t)[:, None]
        hold = first_order_hold(space.A, space.B, float(t[1]))
        x = march(hold, periodic_start(hold, f), f)[:, 0]
        errors.append(np.abs(x - 1e4 * (H * np.exp(1j * omega * t)).real).max())
    np.testing.assert_allclose(np.array(errors[:-1]) / errors[1:], 4.0, rtol=0.01)


def test_a_periodic_start_has_no_transient(rng: np.random.Generator) -> None:
    """Random forces that repeat: the state after one period is the state before it."""
    space = state_space(MODELS["kelvin-voigt"])
    hold = first_order_hold(space.A, space.B, 0.1)
    f = 1e4 * rng.standard_normal((2001, 1))
    f[-1] = f[0]
    x = march(hold, periodic_start(hold, f), f)
    np.testing.assert_allclose(x[-1], x[0], atol=1e-10 * np.abs(x).max())


def quadratic_drag(n: int) -> np.ndarray:
    """Free decay of an oscillator with drag on its velocity; displacements at 40 s in ``n`` steps."""
    space = state_space(sdof(1.0, kelvin_voigt(1.3, 0.02)))
    hold = first_order_hold(space.A, space.B, 40.0 / n)
    x, _ = march_with_feedback(
        hold,
        hold,
        np.array([1.0, 0.0]),
        np.zeros((n + 1, 1)),
        lambda _, state: np.array([-0.3 * abs(state[1]) * state[1]]),
    )
    return np.asarray(x[-1])


def test_feedback_converges_with_the_second_order_on_scipys_solution() -> None:
    exact = solve_ivp(
        lambda _, x: [x[1], -1.3 * x[0] - 0.02 * x[1] - 0.3 * abs(x[1]) * x[1]],
        (0.0, 40.0),
        [1.0, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
    ).y[:, -1]
    errors = [np.linalg.norm(quadratic_drag(n) - exact) for n in (200, 400, 800, 1600)]
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (order > 1.8).all()  # kinks of |v| v cost a little
    assert errors[-1] < 1e-4 * np.linalg.norm(exact)


def test_a_feedback_that_grows_evenly_is_extrapolated() -> None:
    """A mass that moves on at v, as a load k v t holds off a spring k of the feedback.

    Without extrapolation every step would begin with the force of the last, and stay k v h³/3 behind.
    """
    k, v, h, n = 4.0, 1.0, 0.05, 200
    hold = first_order_hold(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), h)
    t = h * np.arange(n + 1)
    x, _ = march_with_feedback(
        hold, hold, np.array([0.0, v]), k * v * t[:, None], lambda _, state: -k * state[:1]
    )
    # the first step has nothing to extrapolate from
    assert np.abs(x[:, 0] - v * t).max() < 0.1 * k * v * h**3 / 3.0


def test_feedback_may_hold_part_of_the_stiffness() -> None:
    """A spring of one tenth left to the feedback: the whole spring's motion, to second order."""
    whole, most = sdof(1.0, kelvin_voigt(4.0, 0.1)), sdof(1.0, kelvin_voigt(3.6, 0.1))
    start, space = np.array([1.0, 0.0]), state_space(most)
    exact = expm(state_space(whole).A * 10.0) @ start
    errors = []
    for n in (500, 1000):
        hold = first_order_hold(space.A, space.B, 10.0 / n)
        x, _ = march_with_feedback(
            hold, hold, start, np.zeros((n + 1, 1)), lambda _, state: -0.4 * state[:1], evaluations=2
        )
        errors.append(np.abs(x[-1] - exact).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] < 1e-4


@pytest.mark.parametrize("name", ["kelvin-voigt", "zener"])
def test_the_books_close(name: str, rng: np.random.Generator) -> None:
    """Input = stored + dissipated within 1e-3 over ten minutes of random forcing."""
    pencil = replace(MODELS[name], rayleigh=Rayleigh(0.01, 0.002))
    space, h = state_space(pencil), 0.02
    n = 30_000
    coarse = 1e4 * rng.standard_normal(n // 50 + 2)
    f = np.interp(np.arange(n + 1) / 50, np.arange(coarse.size), coarse)[:, None]
    x = march(first_order_hold(space.A, space.B, h), np.zeros(space.A.shape[0]), f)
    books = energy(pencil, x, f, step_s=h)
    left = books.work - books.stored - books.dissipated
    assert np.abs(left).max() < 1e-3 * books.work.max()


def test_equilibrium_stays() -> None:
    pencil = MODELS["zener"]
    space = state_space(pencil)
    rest = -np.linalg.solve(space.A, space.B @ np.array([1e4]))
    assert rest[0] == pytest.approx(1e4 / 1.48e6, rel=1e-12)
    x = march(first_order_hold(space.A, space.B, 1.0), rest, np.full((11, 1), 1e4))
    np.testing.assert_allclose(x, np.broadcast_to(rest, x.shape), rtol=1e-9, atol=1e-15)


def test_a_step_must_be_positive() -> None:
    with pytest.raises(InputError, match="step_s"):
        first_order_hold(np.eye(2), np.ones((2, 1)), 0.0)
