"""A small structure with two modes, watched for some months."""

import numpy as np
import pytest

from jackettwin.watching import History


def made(seed: int = 0, days: int = 160, step: float = 0.0, begin: float = 120.0) -> History:
    """Return two modes every six hours with temperature, slow wandering, noise, and a step of both."""
    rng = np.random.default_rng((5, seed))
    t = np.arange(0.0, days, 0.25)
    temperature = 10.0 + 8.0 * np.sin(2 * np.pi * t / 60.0) + 2.0 * np.sin(2 * np.pi * t)
    slow = np.zeros((t.size, 2))
    keep = np.exp(-0.25 / 2.0)
    for i in range(1, t.size):
        slow[i] = keep * slow[i - 1] + np.sqrt(1 - keep**2) * 0.001 * rng.standard_normal(2)
    std = 0.002 * np.exp(0.2 * rng.standard_normal((t.size, 2)))
    ln_f = slow - 1e-4 * temperature[:, None] + std * rng.standard_normal((t.size, 2))
    ln_f += step * (t >= begin)[:, None]
    zeta = 0.01 * np.exp(0.2 * rng.standard_normal((t.size, 2)))
    f = np.array([0.3, 0.31]) * np.exp(ln_f)
    return History(
        t, ("first", "second"), f, f * std, zeta, 0.2 * zeta, temperature[:, None], ("temperature_c",),
        np.zeros(t.size, dtype=np.intp),
    )  # fmt: skip


@pytest.fixture
def quiet() -> History:
    return made()


@pytest.fixture
def stepped() -> History:
    return made(step=-0.006)
