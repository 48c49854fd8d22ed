"""Closed forms of the shape measures."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import mac
from jackettwin.identification.mode_shapes import aligned, mpc, mpd_rad, normalised


def test_mac_of_orthogonal_and_parallel_shapes():
    a = np.array([[1.0, 0.0], [1.0, 1.0]])
    assert mac(a, np.array([2j, 0.0])) == pytest.approx([1.0, 0.5])
    assert mac(a, a).shape == (2, 2)


def test_a_real_shape_is_collinear_and_a_circle_is_not():
    real = np.exp(0.7j) * np.array([1.0, -0.5, 0.2])
    circle = np.exp(2j * np.pi * np.arange(4) / 4)
    assert mpc(real) == pytest.approx(1.0)
    assert mpd_rad(real) == pytest.approx(0.0, abs=1e-12)
    assert mpc(circle) == pytest.approx(0.0, abs=1e-12)


def test_normalised_and_aligned(rng):
    shape = rng.standard_normal(5) + 1j * rng.standard_normal(5)
    one = normalised(shape)
    assert one[np.argmax(np.abs(one))] == pytest.approx(1.0)
    assert mac(one, shape) == pytest.approx(1.0)
    turned = aligned(np.exp(2.0j) * np.array([-1.0, 0.5]))
    assert turned == pytest.approx([1.0, -0.5], abs=1e-12)
