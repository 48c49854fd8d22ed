"""A channel alone tells modes that no second shape parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.findings import Finding
from jackettwin.identification import Identification, IdentificationSettings, identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel

PAIR = (2.41, 2.69)
CHANNELS = (Channel("a"), Channel("b"))


def alone(share: float, seed: int, **chosen: int) -> Identification:
    """Identify a channel of four modes, of which the second is of a share of the first's amplitude."""
    shapes = np.array([[1.0], [share], [1.0], [1.0]])
    damping = np.array([0.015, 0.015, 0.03, 0.01])
    system = ModalSystem(
        np.array([*PAIR, 7.0, 13.3]), damping, shapes, np.diag([1.0, 1.0, 3.0, 3.0]), noise_ratio=0.05
    )
    record = simulate(system, np.random.default_rng(seed), duration_s=600.0, sample_rate_hz=100.0)
    return identify(record, IdentificationSettings(**chosen))


@pytest.mark.parametrize(("share", "seed"), [(0.35, 0), (0.5, 1), (0.7, 0)])
def test_two_modes_an_eighth_apart_are_two(share: float, seed: int) -> None:
    low = [mode for mode in alone(share, seed).modes if mode.frequency_hz < 4.0]
    assert [mode.frequency_hz for mode in low] == pytest.approx(PAIR, rel=0.01)
    # ζ is told to a tenth or two
    assert [mode.damping_ratio for mode in low] == pytest.approx([0.015, 0.015], rel=0.6)


def test_one_pole_for_two_peaks_is_doubtful() -> None:
    """A lag window of three cycles does not part them: one mode, twice as broad as either."""
    (merged,) = [mode for mode in alone(0.5, 1, block_rows=65).modes if mode.frequency_hz < 4.0]
    assert merged.damping_ratio > 0.03
    assert merged.status == "doubtful"
    assert [reason.code for reason in merged.reasons] == ["second_peak"]


def test_a_channel_alone_says_that_it_may_merge_a_pair() -> None:
    """A close pair may be one mode of one channel, twice as broad and ``ok``."""
    system = ModalSystem(
        np.array([0.33, 0.337]), np.full(2, 0.015), np.array([[1.0], [0.8]]), np.eye(2), noise_ratio=0.05
    )
    record = simulate(system, np.random.default_rng(1), duration_s=600.0, sample_rate_hz=5.0)
    found = identify(record, IdentificationSettings(blocks=0, refine=False))
    assert Finding("one_channel") in found.notes
    two = replace(record, data=np.vstack([record.data, np.roll(record.data, 9)]), channels=CHANNELS)
    assert Finding("one_channel") not in identify(two, IdentificationSettings(blocks=0, refine=False)).notes
