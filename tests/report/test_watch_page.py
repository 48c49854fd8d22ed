"""Sizes of causes in words, as the page on watched modes has them."""

import pytest

from jackettwin.report.pages.watch import _size


@pytest.mark.parametrize(
    ("cause", "unit", "size", "said"),
    [
        ("marine growth", "m", 0.0293, ("29 mm", "15 to 59")),
        ("scour at all feet", "m", 1.14, ("1.1 m", "0.57 to 2.3")),
        ("mass of the RNA", "kg", 4150.0, ("4.2 t", "2.1 to 8.3")),
        ("soil softening", "-", 0.067, ("6.7 %", "3.4 to 13")),
        ("brace_1 lost (or 3 alike)", "-", 1.0, ("–", "–")),
    ],
)
def test_sizes_are_told_in_units_of_their_own(
    cause: str, unit: str, size: float, said: tuple[str, str]
) -> None:
    known = {"cause": cause, "unit": unit, "size": size, "interval_90": [0.5 * size, 2.0 * size]}
    assert _size(known) == said
