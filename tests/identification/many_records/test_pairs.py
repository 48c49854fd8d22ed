"""Close pairs: shapes turned within their plane, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.files.codec import decode, encode
from jackettwin.identification import Identification, ModalEstimate, mac
from jackettwin.identification.estimate import ResolvedSettings
from jackettwin.identification.many_records.pairs import along_axes, close_pairs
from jackettwin.records import Channel

SHAPE = np.array([1.0, 0.4, 0.2])
X, Y = np.kron(SHAPE, [1.0, 0.0]), np.kron(SHAPE, [0.0, 1.0])
CHANNELS = tuple(
    Channel(f"a{h}{axis}", height_m=h, direction=direction)
    for h in (90.0, 60.0, 30.0)
    for axis, direction in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
)


def mode(f: float, shape: np.ndarray, zeta: float = 0.01) -> ModalEstimate:
    return ModalEstimate(f, zeta, np.asarray(shape, dtype=complex), 1.0, 0.0, 1.0)


@pytest.fixture
def found() -> Identification:
    """A pair 1.5 half bandwidths apart, side-side leaking into fore-aft with a phase; a third mode."""
    modes = (mode(0.300, Y + 0.1 * X), mode(0.309, X + (0.6 + 0.5j) * Y), mode(1.2, X[::-1]))
    bare = Identification(
        records=("r",), channels=CHANNELS, modes=modes, rejected=(),
        stabilisation=None, spectrum=None, settings=None, duration_s=600.0,
    )  # fmt: skip
    return bare


def test_the_plane_holds_the_pure_shapes(found: Identification) -> None:
    turned = along_axes(found)
    # exact: X and Y are combinations of the two
    assert_allclose(turned.modes[0].mode_shape, Y, atol=1e-12)
    assert_allclose(turned.modes[1].mode_shape, X, atol=1e-12)
    assert turned.modes[2] is found.modes[2]
    assert turned.modes[1].mode_shape_unaligned is found.modes[1].mode_shape
    assert turned.modes[1].mpc == pytest.approx(1.0)
    assert "fore-aft share before: 1% and 62%" in turned.notes[0].text


def test_frequency_and_damping_go_with_the_nearer_shape(found: Identification) -> None:
    swapped = replace(found, modes=(mode(0.300, X + 0.3 * Y), mode(0.309, Y - 0.2 * X)))
    first, second = along_axes(swapped).modes
    assert mac(first.mode_shape, X) == pytest.approx(1.0)
    assert mac(second.mode_shape, Y) == pytest.approx(1.0)


def test_a_plane_without_pure_shapes_is_left_alone(found: Identification) -> None:
    """Two directions of different shapes: no turn within the plane gives a pure one."""
    other = np.kron([0.2, 1.0, -0.5], [0.0, 1.0])
    leaning = replace(found, modes=(mode(0.300, X + Y), mode(0.309, X + other)))
    assert along_axes(leaning) == leaning


def test_shapes_that_are_pure_already_are_left_alone(found: Identification) -> None:
    apart = replace(found, modes=(mode(0.300, Y + 0.02 * X), mode(0.309, X + 0.05j * Y)))
    assert along_axes(apart).modes == apart.modes
    assert along_axes(apart).notes == ()


def test_sensors_off_the_axes_are_left_alone(found: Identification) -> None:
    half = 0.5**0.5
    skew = tuple(replace(c, direction=(half, half, 0.0)) for c in CHANNELS)
    assert along_axes(replace(found, channels=skew)).modes == found.modes


def test_pairs_are_neighbours_that_overlap() -> None:
    # half bandwidths of 0.003 Hz: 0.300 and 0.306 overlap less than 0.306 and 0.309
    modes = [mode(f, X) for f in (0.300, 0.306, 0.309, 1.2, 1.3)]
    assert close_pairs(modes) == [(1, 2)]
    assert close_pairs([]) == []


def test_the_shape_before_is_kept_in_files(found: Identification) -> None:
    turned = along_axes(found)
    light = replace(turned, settings=ResolvedSettings(0.2, 5.0, 12.5, 40, (2, 4), 6.4)).without_figures
    back = decode(Identification, encode(light))
    assert_allclose(back.modes[1].mode_shape_unaligned, found.modes[1].mode_shape)
    assert back.modes[2].mode_shape_unaligned is None
    assert light.modes == turned.modes
