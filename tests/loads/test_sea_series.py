"""The fast transforms against the direct sum of components."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.sea_series import sea_series
from jackettwin.loads.waves import irregular_sea

POINTS = np.array([[0.0, 0.0, -1.0], [12.0, -5.0, -6.0], [-20.0, 3.0, 2.0], [5.0, 5.0, -60.0]])
PERIOD, N = 300.0, 1200
SOME = np.arange(0, N, 41)


@pytest.mark.parametrize("spreading", [None, 10.0])
@pytest.mark.parametrize("stretching", ["none", "vertical", "extrapolated", "wheeler"])
def test_agrees_with_the_sum_of_components(spreading, stretching) -> None:
    """Exact at levels that stand still; Wheeler's five leave less than 1 % of the spread in any sample."""
    sea = irregular_sea(
        Hs=6.0, Tp=10.0, depth=72.0, duration=PERIOD, seed=5, direction=0.7, spreading=spreading,
        stretching=stretching,
    )  # fmt: skip
    series = sea_series(sea, POINTS, period=PERIOD, n_times=N)
    t = SOME * PERIOD / N
    velocity, acceleration = sea.motion(POINTS, t)
    tolerance = 0.01 if stretching == "wheeler" else 1e-10
    for fast, direct in ((series.velocity, velocity), (series.acceleration, acceleration)):
        np.testing.assert_allclose(fast[SOME], direct, atol=tolerance * direct.std(axis=0).max())
    np.testing.assert_allclose(series.surface[SOME], sea.surface(POINTS, t), atol=1e-10)


def test_refuses_what_does_not_repeat_or_is_undersampled() -> None:
    sea = irregular_sea(Hs=2.0, Tp=8.0, depth=50.0, duration=100.0, seed=0)
    with pytest.raises(InputError, match="repeat"):
        sea_series(sea, POINTS, period=130.0, n_times=1000)
    with pytest.raises(InputError, match="too few times"):
        sea_series(sea, POINTS, period=100.0, n_times=60)
