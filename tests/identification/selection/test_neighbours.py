"""A peak of the forces between two modes has the shape that these make together; a mode has its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate, identify
from jackettwin.identification.selection.neighbours import (
    MAX_SHARE_OF_ONE,
    combinations_of_neighbours,
    identified_twice,
    members_of_pairs,
)
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

SHAPES = np.array(
    [[1.0, 0.6, 0.25, 0.1, 0.05, 0.02], [-0.4, 0.6, 0.9, -0.1, 0.2, 0.3], [0.5, -0.6, 0.8, 0.4, -0.3, 0.6]]
)


def estimate(f: float, zeta: float, shape: np.ndarray) -> ModalEstimate:
    return ModalEstimate(f, zeta, shape.astype(complex), 1.0, 0.0, 1.0)


@pytest.mark.parametrize("part", [-0.8, 0.5, 2.0])
def test_a_combination_of_the_modes_beside_it_is_theirs(part: float) -> None:
    between = SHAPES[0] + part * SHAPES[1]
    modes = [
        estimate(f, 0.02, s) for f, s in zip([0.3, 0.6, 1.0], [SHAPES[0], between, SHAPES[1]], strict=True)
    ]
    # each of the three is a combination of the other two; only one has neighbours on both sides
    assert combinations_of_neighbours(modes, np.ones(6), 2.0) == [1]
    own = estimate(0.6, 0.02, SHAPES[2])
    assert combinations_of_neighbours([modes[0], own, modes[2]], np.ones(6), 2.0) == []


@pytest.mark.parametrize(("zeta", "told"), [((0.05, 0.01), [1]), ((0.01, 0.05), [2])])
def test_of_two_that_may_each_be_of_the_others_the_broader_is_told(
    zeta: tuple[float, float], told: list[int]
) -> None:
    """A peak below a mode moves as that mode does: each lies between others that can make it."""
    peak = 0.05 * SHAPES[0] + SHAPES[1] + 0.05 * SHAPES[2]
    shapes = [SHAPES[0], peak, SHAPES[1], 0.05 * SHAPES[0] + 0.05 * SHAPES[2]]
    modes = [
        estimate(f, z, s) for f, z, s in zip([0.3, 0.6, 1.0, 3.0], [0.01, *zeta, 0.01], shapes, strict=True)
    ]
    assert combinations_of_neighbours(modes, np.ones(6), 2.0) == told


def test_of_three_close_modes_in_one_plane_the_least_known_is_told_twice() -> None:
    shapes = [SHAPES[0], 0.8 * SHAPES[0] + 0.5 * SHAPES[1], SHAPES[1]]
    modes = [
        estimate(f, 0.02, s).with_covariance(np.diag([std, 0.3]) ** 2)
        for f, s, std in zip([0.74, 0.755, 0.76], shapes, [0.008, 0.012, 0.004], strict=True)
    ]
    assert identified_twice(modes, np.ones(6), 2.0) == [1]
    # a fit of all three parts them; farther away it is no matter; a third may move in its own shape
    assert identified_twice([replace(m, unrefined=m) for m in modes], np.ones(6), 2.0) == []
    assert identified_twice([modes[0], replace(modes[1], frequency_hz=0.9), modes[2]], np.ones(6), 2.0) == []
    assert (
        identified_twice([modes[0], replace(modes[1], mode_shape=SHAPES[2] + 0j), modes[2]], np.ones(6), 2.0)
        == []
    )


def test_what_little_a_wave_peak_has_of_second_modes_makes_no_second_mode_its_combination() -> None:
    """Two horizontal channels at three levels; a jacket whose one soft leg parts its second pair by 8 %.

    The lower mode of the second pair was doubted in both records, with the wave peak above the first pair as
    a neighbour: that moves like the first mode, and by a twentieth like the second along the same axis.
    """
    first, second = np.array([1.0, 0.41, 0.09]), np.array([-0.35, 0.9, 0.5])
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    wave = np.kron(first + 0.05 * second, x)
    modes = [
        estimate(0.291, 0.006, np.kron(first, x + y)),
        estimate(0.303, 0.006, np.kron(first, x - y)),
        estimate(0.325, 0.053, wave),
        estimate(0.972, 0.015, np.kron(second, x + y)),
        estimate(1.062, 0.015, np.kron(second, x - y)),
    ]
    assert combinations_of_neighbours(modes, np.ones(6), 2.0) == []
    # a peak of the forces between both pairs is still one
    forced = replace(modes[3], mode_shape=np.kron(first, x) + 0.4 * np.kron(second, x - y) + 0j)
    assert combinations_of_neighbours([*modes[:3], forced, modes[4]], np.ones(6), 2.0) == [3]


def test_in_few_channels_nothing_is_said() -> None:
    shapes = SHAPES[:, :3]
    modes = [
        estimate(f, 0.02, s)
        for f, s in zip([0.3, 0.6, 1.0], [shapes[0], shapes[0] + shapes[1], shapes[1]], strict=True)
    ]
    assert combinations_of_neighbours(modes, np.ones(3), 2.0) == []


def forced(seed: int, peak: float) -> Record:
    """Two modes whose forces have a peak at 0.6 Hz, 2 % broad, of so many times the level beside."""
    rng = np.random.default_rng(seed)
    n, rate = 4 * 12_000, 10.0
    f = np.fft.rfftfreq(n, 1.0 / rate)
    lines = rng.normal(size=(3, len(f), 2)) @ np.array([1.0, 1j])
    sharp = peak * 0.04 / (1.0 - (f / 0.6) ** 2 + 0.04j * f / 0.6)
    force = lines[:2] + np.array([[1.0], [0.8]]) * lines[2] * sharp
    h = [-(f**2) / (f0**2 - f**2 + 0.02j * f * f0) for f0 in (0.3, 1.0)]
    y = np.fft.irfft(SHAPES[:2].T @ (np.array(h) * force), n)[:, : n // 4]
    y += 0.01 * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    system = ModalSystem(np.array([0.3, 1.0]), np.full(2, 0.01), SHAPES[:2], np.eye(2))
    like = simulate(system, rng, duration_s=10.0, sample_rate_hz=rate)
    return Record(y, rate, like.channels, name="forced")


def test_a_peak_of_the_forces_is_doubted() -> None:
    found = identify(forced(1, 8.0))
    peaks = [m for m in found.modes if 0.5 < m.frequency_hz < 0.7]
    assert peaks
    assert all("shape_of_neighbours" in [r.code for r in m.reasons] for m in peaks)
    assert [round(m.frequency_hz, 1) for m in found.modes if m.status == "ok"] == [0.3, 1.0]


def test_a_pair_along_two_axes_is_one_also_where_its_shapes_are_mixed():
    """Fore-aft and side-side within two bandwidths; a tone of all axes, or a mode far away, makes no pair."""
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) * 3
    channels = [Channel(f"c{k}", direction=axis) for k, axis in enumerate(axes)]
    heights = np.array([1.0, 0.6, 0.2])
    along, across = np.kron(heights, [1.0, 0.0]), np.kron(heights, [0.0, 1.0])

    def modes(frequency_hz, *shapes):
        made = zip(frequency_hz, shapes, strict=True)
        return [ModalEstimate(f, 0.01, shape.astype(complex), 1.0, 0.0, 1.0) for f, shape in made]

    assert members_of_pairs(modes([0.300, 0.306], along, across), channels) == {0, 1}
    mixed = (along + 0.5 * across, across - 0.5 * along)
    assert members_of_pairs(modes([0.300, 0.306], *mixed), channels) == {0, 1}
    assert members_of_pairs(modes([0.300, 0.320], along, across), channels) == set()
    tone = np.array([0.9, 0.4, 0.3, 0.8, 0.5, 0.6])
    assert members_of_pairs(modes([0.300, 0.306], along, tone), channels) == set()
    unplaced = [Channel(f"c{k}") for k in range(6)]
    assert members_of_pairs(modes([0.300, 0.306], along, across), unplaced) == set()


def test_three_levels_leave_little_to_tell_a_second_mode_by() -> None:
    """Along one axis two neighbours leave one of three dimensions, whatever the other axis has."""
    first, third = np.array([1.0, 0.6, 0.25]), np.array([0.3, -0.6, 0.7])
    normal = np.cross(first, third)
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    frequencies = [0.24, 0.25, 0.74, 1.29, 1.33]
    comparable = np.kron(np.ones((3, 3)), np.eye(2)) > 0.0
    plane = first - third
    for share, told in [(0.003, []), (0.0003, [2])]:
        # of unit length, with the share outside the plane of the other two
        second = np.sqrt(1.0 - share) * plane / np.linalg.norm(plane)
        second = second + np.sqrt(share) * normal / np.linalg.norm(normal)
        shapes = [np.kron(*p) for p in ((first, x), (first, y), (second, x), (third, y), (third, x))]
        modes = [estimate(f, 0.012, s) for f, s in zip(frequencies, shapes, strict=True)]
        assert combinations_of_neighbours(modes, np.ones(6), 2.0, comparable) == told
        assert combinations_of_neighbours(modes, np.ones(6), 2.0) == [2]
    # a random shape of three: its part along the normal is uniform, so that its square is below s in √s
    random = np.random.default_rng(8).standard_normal((20_000, 3))
    part = (random @ normal) ** 2 / np.sum(random**2, axis=1) / (normal @ normal)
    assert np.mean(part < MAX_SHARE_OF_ONE) == pytest.approx(np.sqrt(MAX_SHARE_OF_ONE), abs=4e-3)
