"""Modes followed through records: by shape through crossings, through drift, absence and missing channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import (
    FusedIdentification,
    Identification,
    ModalEstimate,
    fuse,
    mac,
)
from jackettwin.identification.estimate import ResolvedSettings
from jackettwin.identification.many_records.tracking import MAX_ABSENCE, follow
from jackettwin.records import Channel

F = np.array([0.178, 0.186, 0.74, 0.77, 1.3])
ZETA = np.array([0.03, 0.01, 0.02, 0.012, 0.01])
TOWER = np.array([1.0, 0.5, 0.2, 0.1])
SHAPES = np.vstack(
    [np.kron(TOWER, [0, 1]), np.kron(TOWER, [1, 0]), np.random.default_rng(3).standard_normal((3, 8))]
)
LENGTH_S = 600.0
SETTINGS = ResolvedSettings(0.1, 2.0, 5.0, 10, (2,), 4.0)

Truth = Callable[[int], np.ndarray]
"""True frequencies of record i; NaN for a mode that is not there."""


def record(i: int, f: np.ndarray, channels: np.ndarray, rng: np.random.Generator) -> Identification:
    """Estimates that scatter as those of a record do; shapes of the first pair mix by 30 %."""
    modes = []
    for k in np.flatnonzero(np.isfinite(f)):
        std = np.sqrt([ZETA[k], 1.0 / ZETA[k]]) / np.sqrt(2.0 * np.pi * f[k] * LENGTH_S)
        ln_f, ln_zeta = std * rng.standard_normal(2)
        mixed = 0.3 * rng.standard_normal() * SHAPES[1 - k] if k < 2 else 0.0
        shape = SHAPES[k] + mixed + 0.03 * rng.standard_normal(8)
        modes.append(
            ModalEstimate(
                f[k] * np.exp(ln_f), ZETA[k] * np.exp(ln_zeta), shape[channels] + 0j, 1.0, 0.0, 1.0,
                log_covariance=np.diag(std**2),
            )
        )  # fmt: skip
    modes.sort(key=lambda mode: mode.frequency_hz)
    own = tuple(Channel(f"a{j}") for j in channels)
    bare = Identification((f"r{i}",), own, tuple(modes), (), None, None, SETTINGS, LENGTH_S)
    return bare.without_figures


def records(truth: Truth, n: int, *, fewest_channels: int = 8) -> list[Identification]:
    rng = np.random.default_rng(1)
    return [
        record(i, truth(i), rng.permutation(8)[: rng.integers(fewest_channels, 9)], rng) for i in range(n)
    ]


def of_true_mode(fused: FusedIdentification, k: int):
    """Return the fused mode that has the shape of a true one, and that shape's order of channels."""
    order = [int(c.name[1:]) for c in fused.channels]
    subspace_mac = [mac(SHAPES[k][order], mode.mode_shape) for mode in fused.modes]
    assert max(subspace_mac) > 0.98
    return fused.modes[int(np.argmax(subspace_mac))]


def seen_rightly(found: list[Identification], fused: FusedIdentification, truth: Truth, k: int) -> float:
    """Return the share of a true mode's sightings that are within 3 % of its frequency at the time.

    The estimates themselves scatter by up to 1 % (five standard deviations of the first mode: 5 · 0.7 %).
    """
    seen = of_true_mode(fused, k).sightings
    true = np.array([truth(int(i))[k] for i in seen.record])
    return float(np.mean(np.abs(seen.frequency_hz / true - 1.0) < 0.03)) * len(seen) / len(found)


def crossing(i: int) -> np.ndarray:
    return F + (i / 40.0) * np.array([0.008, -0.008, 0.0, 0.0, 0.0])


def drifting(i: int) -> np.ndarray:
    return F * (1.0 + 0.1 * i / 100.0)


def with_the_tide(i: int) -> np.ndarray:
    return F * (1.0 + 0.02 * np.sin(i / 2.0))


@pytest.mark.parametrize(("truth", "n"), [(crossing, 40), (drifting, 100), (with_the_tide, 40)])
def test_every_mode_is_followed_through(truth: Truth, n: int) -> None:
    found = records(truth, n)
    fused = fuse(found)
    assert len(fused.modes) == 5
    assert [seen_rightly(found, fused, truth, k) for k in range(5)] == [1.0] * 5


def test_crossing_modes_keep_their_damping() -> None:
    fused = fuse(records(crossing, 40))
    for k in (0, 1):
        mode = of_true_mode(fused, k)
        # four standard deviations
        assert abs(mode.damping_ratio - ZETA[k]) < 4.0 * mode.damping_ratio_std


def test_a_mode_in_half_the_records_is_one_mode() -> None:
    def truth(i: int) -> np.ndarray:
        return np.where([False, False, i % 2 == 1, False, False], np.nan, with_the_tide(i))

    fused = fuse(records(truth, 40))
    assert [len(mode.sightings) for mode in fused.modes] == [40, 40, 20, 40, 40]


def test_a_mode_lost_and_found_elsewhere_is_one_mode() -> None:
    """A season without it, and back 6 % higher."""

    def truth(i: int) -> np.ndarray:
        f = F * (1.06 if i >= 25 else 1.0)
        return np.where([False, False, 10 <= i < 25, False, False], np.nan, f)

    fused = fuse(records(truth, 40))
    assert [len(mode.sightings) for mode in fused.modes] == [40, 40, 25, 40, 40]


def test_records_need_not_share_one_channel_with_all_others() -> None:
    found = records(lambda i: F, 60, fewest_channels=5)
    names = [{c.name for c in one.channels} for one in found]
    assert not set.intersection(*names)
    fused = fuse(found)
    # five sensors may see little of a mixed shape: a few records of the close pair are lost
    assert all(len(mode.sightings) >= 55 for mode in fused.modes)
    assert all(of_true_mode(fused, k) is fused.modes[k] for k in range(5))
    assert "none of which is in all" in fused.warnings[0]


def test_a_mode_not_seen_for_long_is_not_waited_for() -> None:
    def truth(i: int) -> np.ndarray:
        there = i in (0, 1, 2) or i >= 2 * MAX_ABSENCE
        return np.array([F[0], np.nan, F[2] if there else np.nan, np.nan, np.nan])

    found = records(truth, 3)
    empty = record(3, truth(3), np.arange(8), np.random.default_rng(2))
    late = records(truth, 3)
    many = [*found, *[empty] * (2 * MAX_ABSENCE - 3), *(replace(one, records=("late",)) for one in late)]
    tracks = follow((one, None) for one in many).tracks
    assert sorted(len(track.sightings()) for track in tracks) == [6, 2 * MAX_ABSENCE + 3]


def test_each_key_has_its_own_part() -> None:
    found = records(lambda i: F, 12)
    followed = follow((one, i % 3) for i, one in enumerate(found))
    assert followed.keys == (0, 1, 2) * 4
    (first, *_) = sorted(followed.tracks, key=lambda track: track.log_f)
    apart = [first.shapes[key] for key in range(3)]
    assert [total.count.tolist() for total in apart] == [[4.0] * 8] * 3
