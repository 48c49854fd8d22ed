import numpy as np
import pytest

from jackettwin.records.readers.channels import without_sentinels


@pytest.mark.parametrize("value", [-9999.0, -999.25, 1e30, 32767.0])
def test_a_sentinel_far_from_the_signal_is_taken_out(value: float, rng: np.random.Generator) -> None:
    y = rng.normal(size=100)
    y[[3, 50, 51]] = value
    cleaned, seen, count = without_sentinels(y)
    assert np.flatnonzero(np.isnan(cleaned)).tolist() == [3, 50, 51]
    assert (seen, count) == (value, 3)


def test_counts_clipped_at_the_end_of_an_integer_are_no_sentinels(rng: np.random.Generator) -> None:
    y = np.clip(np.round(20_000.0 * rng.normal(size=1000)), -32768.0, 32767.0)
    cleaned, seen, _ = without_sentinels(y)
    assert seen is None and cleaned is y


@pytest.mark.parametrize("y", [[-9999.0, 1.0, 2.0], [-9999.0, -9999.0], [], [np.nan, np.nan]])
def test_one_sample_or_nothing_else_is_left_alone(y: list[float]) -> None:
    assert without_sentinels(np.array(y))[1] is None
