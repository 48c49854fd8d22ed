"""A channel written twice is found; two sensors at one place are not one."""

from __future__ import annotations

import numpy as np

from jackettwin.records.quality.repeats import duplicate_channels


def test_copies_in_files_of_seven_digits_are_found_and_sensors_of_little_noise_are_not(rng):
    y = rng.standard_normal((3, 2000))
    rounded = np.array([float(f"{x:.6e}") for x in y[0]])
    beside = y[1] + 1e-4 * rng.standard_normal(2000)
    assert duplicate_channels(np.array([*y, rounded, beside])) == {3: 0}


def test_every_copy_names_the_first(rng):
    y = rng.standard_normal(500)
    assert duplicate_channels(np.array([y, y, y + 1.0])) == {1: 0, 2: 0}


def test_gaps_of_both_do_not_hide_a_copy(rng):
    y = rng.standard_normal((2, 500))
    y[:, 7:40] = np.nan
    assert duplicate_channels(np.array([*y, y[0]])) == {2: 0}
