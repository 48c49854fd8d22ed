"""A given elevation comes back, and is the sea it was taken from."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.sea.given_waves import Elevation, given_sea, read_elevation
from jackettwin.loads.sea.waves import irregular_sea

DEPTH, T = 40.0, 400.0


def test_the_sea_of_an_elevation_has_its_motion_everywhere() -> None:
    """η of a random sea, sampled: the same velocities at another place and depth, to the sampling's 1 %."""
    sea = irregular_sea(Hs=4.0, Tp=9.0, depth=DEPTH, duration=T, seed=3, stretching="none", highest_hz=0.3)
    t = np.arange(0.0, T + 0.05, 0.05)
    eta = sea.elevation(np.zeros((1, 3)), t)[:, 0]
    found = given_sea(Elevation(t, eta), depth=DEPTH, duration=T, stretching="none")
    points, at = np.array([[12.0, -5.0, -8.0], [0.0, 3.0, -30.0]]), np.linspace(0.0, T, 57)
    for one, other in zip(found.motion(points, at), sea.motion(points, at), strict=True):
        np.testing.assert_allclose(one, other, atol=0.01 * np.abs(other).max())
    np.testing.assert_allclose(found.elevation(np.zeros((1, 3)), t)[:, 0], eta, atol=0.02)
    given = Elevation(t, eta)
    # one sea of 44 periods: its own spread of Hs
    assert given.significant_height_m == pytest.approx(4.0, rel=0.15)
    assert given.peak_period_s == pytest.approx(9.0, rel=0.2)


def test_files_with_words_above_their_rows(tmp_path: Path) -> None:
    path = tmp_path / "eta.csv"
    path.write_text("time_s, elevation_m\n" + "".join(f"{k}, {0.1 * k}\n" for k in range(10)))
    found = read_elevation(path)
    np.testing.assert_allclose(found.eta_m, 0.1 * found.time_s)
    path.write_text("time eta\n1 2\n3 oops\n")
    with pytest.raises(InputError, match="not two numbers"):
        read_elevation(path)
    for comma in ("0;1,5\n1;0,5\n", "0 1,5\n1 0,5\n"):
        path.write_text(comma)
        with pytest.raises(InputError, match="decimal points"):
            read_elevation(path)
    path.write_text("nothing\n")
    with pytest.raises(InputError, match="no rows"):
        read_elevation(path)


def test_a_short_elevation_is_refused() -> None:
    t = np.arange(0.0, 100.0)
    with pytest.raises(InputError, match="does not cover"):
        given_sea(Elevation(t, np.sin(t)), depth=DEPTH, duration=200.0)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (
            lambda t, eta: (np.delete(t, slice(100, 130)), np.delete(eta, slice(100, 130))),
            "a gap after 9.9 s",
        ),
        (lambda t, eta: (1000.0 * t, eta), "times in seconds"),
        (lambda t, eta: (t[::-1], eta[::-1]), "do not increase"),
        (lambda t, eta: (t, np.where(t == 5.0, np.nan, eta)), "no elevation of water .got nan"),
        (lambda t, eta: (t, 1000.0 * eta), "no elevation of water .got 1000"),
    ],
)
def test_gaps_units_and_holes_are_refused(spoil, message: str, tmp_path: Path) -> None:
    """Each names the file and its key; a gap is not bridged by a straight line."""
    t = np.arange(400) / 10.0
    path = tmp_path / "eta.csv"
    np.savetxt(path, np.column_stack(spoil(t, np.cos(t))), delimiter=",")
    with pytest.raises(InputError, match=message) as refused:
        read_elevation(path)
    assert (refused.value.file, refused.value.field) == (path, "file")
    assert refused.value.allowed
