from __future__ import annotations

import math

import pytest

from jackettwin.report.tables import numbers


def test_frequency_and_percent_carry_their_deviation() -> None:
    assert numbers.frequency(0.18192, 0.00081) == "0.1819 ± 0.0013"
    assert numbers.percent(0.01274, 0.0041) == "1.27 ± 0.67"


@pytest.mark.parametrize("value", [None, math.nan, math.inf])
def test_what_is_not_known_is_a_dash(value: float | None) -> None:
    for text in (numbers.frequency(value), numbers.percent(value), numbers.scientific(value)):
        assert text == numbers.UNKNOWN


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2.5e9, "2.50 × 10⁹"),
        (1e-4, "1.00 × 10⁻⁴"),
        (0.0, "0.00"),
        (35.2, "35.2"),
        (9999.0, "1.00 × 10⁴"),
        (1234.0, "1230"),
    ],
)
def test_scientific_keeps_three_digits(value: float, text: str) -> None:
    assert numbers.scientific(value) == text


def test_lists_and_labels_read_as_text() -> None:
    assert numbers.listed(["a", "b", "c"]) == "a, b and c"
    assert numbers.words("side_side_2") == "side-side 2"
    assert numbers.count(1, "mode") == "1 mode"
