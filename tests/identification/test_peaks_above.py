"""Peaks above the band are named with the option that widens it; where none are, nothing is said."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

QUICK = IdentificationSettings(blocks=0, refine=False)


def record(highest_hz: float) -> Record:
    system = ModalSystem(
        np.array([0.2, 1.1, highest_hz]),
        np.array([0.01, 0.01, 0.01]),
        np.array([[1.0, 0.5], [-0.5, 1.0], [0.8, 0.7]]),
        np.diag([1.0, 0.5, 0.1]),
    )
    return simulate(system, np.random.default_rng(3), duration_s=600.0, sample_rate_hz=25.0)


def test_a_mode_above_the_band_is_named_and_found_in_the_band_that_is_proposed() -> None:
    measured = record(7.0)
    found = identify(measured, QUICK)
    (note,) = [note.text for note in found.notes if note.code == "peaks_above_band"]
    assert "the spectrum has a clear peak: " in note
    assert abs(float(note.split("peak: ")[1].split(" Hz")[0]) - 7.0) < 0.1
    low, high = (float(x) for x in note.split("--band ")[1].split(" ")[0].split(","))
    assert low < 0.2
    assert high > 7.0
    band = {"lowest_frequency_hz": low, "highest_frequency_hz": high}
    wider = identify(measured, QUICK.model_copy(update=band))
    assert any(abs(mode.frequency_hz - 7.0) < 0.05 for mode in wider.modes)
    assert not [note for note in wider.notes if note.code == "peaks_above_band"]


@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_said_of_noise_above_the_band(seed: int) -> None:
    measured = simulate(
        ModalSystem(
            np.array([0.2, 1.1]), np.array([0.01, 0.01]), np.array([[1.0, 0.5], [-0.5, 1.0]]), np.eye(2),
            noise_ratio=0.1,
        ),
        np.random.default_rng(seed),
        duration_s=600.0,
        sample_rate_hz=25.0,
    )  # fmt: skip
    assert not [note for note in identify(measured, QUICK).notes if note.code == "peaks_above_band"]
