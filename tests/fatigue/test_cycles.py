"""Counting against another library, the standard's example, and one long count."""

import fatpack
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from jackettwin.errors import InputError
from jackettwin.fatigue import Counter, count, equivalent_range


def series(rng: np.random.Generator, n: int = 6000) -> np.ndarray:
    """Return two modes on a slow drift, without equal neighbours."""
    t = np.arange(n) * 0.05
    slow = np.cumsum(rng.normal(size=n)) * 0.05
    return np.asarray(slow + np.sin(1.1 * t) + 0.3 * np.sin(5.7 * t + 1.0) + 0.05 * rng.normal(size=n))


def sums(ranges: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Return Σ n Δ^m of a few slopes."""
    return np.array([(numbers * ranges**m).sum() for m in (1.0, 3.0, 5.0)])


def test_the_example_of_the_standard() -> None:
    """ASTM E1049-85, figure 6: 3, 4, 8, 9, 8, 6 count half, 4 counts once."""
    found = count(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    assert found.full.tolist() == [4.0]
    assert sorted(found.half.tolist()) == [3.0, 4.0, 6.0, 8.0, 8.0, 9.0]
    # the standard's table: 3 ½, 4 1½, 6 ½, 8 1, 9 ½
    table = {r: found.numbers[found.ranges == r].sum() for r in np.unique(found.ranges).tolist()}
    assert table == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


@pytest.mark.parametrize("seed", range(3))
def test_closed_cycles_are_those_of_another_library(seed: int) -> None:
    x = series(np.random.default_rng(seed))
    slope = np.diff(x)
    turns = np.flatnonzero(slope[1:] * slope[:-1] < 0.0) + 1
    reversals = x[np.concatenate([[0], turns, [x.size - 1]])]
    theirs, residue = fatpack.find_rainflow_cycles(reversals)
    found = count(x)
    np.testing.assert_allclose(np.sort(found.full), np.sort(np.abs(np.diff(theirs)).ravel()), rtol=1e-9)
    assert sums(found.full, np.ones(found.full.size)) == pytest.approx(
        sums(np.abs(np.diff(theirs)).ravel(), np.ones(len(theirs))), rel=1e-12
    )
    np.testing.assert_allclose(np.sort(found.half), np.sort(np.abs(np.diff(residue))), rtol=1e-9)


def test_the_largest_range_is_the_span(rng: np.random.Generator) -> None:
    x = series(rng)
    assert count(x).ranges.max() == pytest.approx(np.ptp(x), rel=1e-15)


def test_a_residue_carried_over_a_thousand_records_counts_as_one_series(rng: np.random.Generator) -> None:
    """The state between records is the residue alone: it is written, read and counted on."""
    x = series(rng, 60_000)
    whole = count(x)
    residue, closed = np.empty(0), []
    for piece in np.array_split(x, 1000):
        counter = Counter(residue)
        counter.add(piece)
        closed.append(counter.closed())
        residue = counter.residue
    ranges = np.concatenate(closed)
    ones = np.ones(ranges.size)
    assert sums(ranges, ones) == pytest.approx(sums(whole.full, np.ones(whole.full.size)), rel=1e-9)
    half = np.abs(np.diff(residue))
    np.testing.assert_allclose(np.sort(half[half > 0.0]), np.sort(whole.half), rtol=1e-12)
    # ten-minute pieces counted each for itself lose the slow cycles
    pieces = [count(piece) for piece in np.array_split(x, 1000)]
    alone = sum(sums(p.ranges, p.numbers)[2] for p in pieces)
    assert alone < 0.9 * sums(whole.ranges, whole.numbers)[2]


def test_an_equivalent_range_of_one_amplitude_is_that_range() -> None:
    """A sine of 100 cycles of range 2: (100 · 2^m / 10⁷)^(1/m), but for the half cycles at its ends."""
    t = np.linspace(0.0, 100.0, 40_001)
    found = count(np.sin(2.0 * np.pi * t))
    for m in (3.0, 5.0):
        assert equivalent_range(found, m, 1e7) == pytest.approx(2.0 * (100.0 / 1e7) ** (1.0 / m), rel=2e-3)


def test_what_is_no_number_is_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        count(np.array([0.0, np.nan, 1.0]))


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 1.0, 1.0]])
def test_what_does_not_move_has_no_cycle(values: list[float]) -> None:
    assert count(np.array(values)).ranges.size == 0


def test_closed_cycles_are_given_once(rng: np.random.Generator) -> None:
    x = series(rng)
    counter, taken = Counter(), []
    for piece in np.array_split(x, 7):
        counter.add(piece)
        taken.append(counter.closed())
    assert counter.closed().size == 0
    np.testing.assert_array_equal(np.concatenate(taken), count(x).full)


def test_a_whole_series_is_counted_as_its_pieces_are() -> None:
    """The loop alone, which :func:`count` takes, and the detector: plateaus, single precision, any length."""
    rng = np.random.default_rng(3)
    for n in (1, 2, 3, 4, 9, 500):
        for series in (rng.standard_normal(n), np.round(rng.standard_normal(n)), np.ones(n)):
            pieces = Counter()
            pieces.add(series)
            once, found = pieces.ended(), count(series)
            assert_array_equal(found.full, once.full)
            assert_array_equal(found.half, once.half)
            short = count(series.astype(np.float32))
            assert_allclose(short.ranges, found.ranges, rtol=1e-6, atol=1e-6)
