"""When ramps and steps in plain noise began: their a and c are sums over the rows."""

import numpy as np

from jackettwin.watching.directions import directions_of, increments, log_ramps
from jackettwin.watching.memory import Bank

DAYS = np.arange(60.0)
STD = 2e-4


def bank_of(y: np.ndarray) -> Bank:
    """Return what a row a day in white noise says of steps at every day."""
    steps = (DAYS[:, None] >= DAYS).astype(float)
    info, score = steps.T @ steps / STD**2, steps.T @ y / STD**2
    cross = np.tril(info)[:, :, None, None]
    return Bank(np.zeros((60, 1, 1)), np.diag(info)[:, None, None], score[:, None], cross)


def test_steps_add_up_to_a_ramp() -> None:
    level = np.cumsum(increments(DAYS, 60.0), axis=1)
    np.testing.assert_allclose(level[20], np.clip((DAYS + 0.5 - 20.0) / 40.0, 0.0, None), atol=1e-12)


def test_a_ramp_is_dated_as_a_ramp_and_a_step_as_a_step(rng: np.random.Generator) -> None:
    noise = STD * rng.standard_normal(60)
    bets = directions_of("frequency", ("f",), np.array([0.3]))
    ramp = -0.002 * np.clip((DAYS + 0.5 - 20.0) / 40.0, 0.0, None)
    step = -0.001 * (DAYS >= 20.0)
    for change, likelier in ((ramp, 0), (step, 1)):
        logs = log_ramps(bets, np.ones(1), bank_of(noise + change), DAYS, 60.0)
        assert np.argmax(logs.max(axis=1)) == likelier
        assert abs(int(np.argmax(logs[likelier])) - 20) <= 4  # a tenth of the ramp, a fifth of a σ a day
    as_step = log_ramps(bets, np.ones(1), bank_of(noise + ramp), DAYS, 60.0)[1]
    assert np.argmax(as_step) > 28  # in its middle: what dated it before
