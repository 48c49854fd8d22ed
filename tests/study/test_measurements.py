"""Measured modes that are perhaps two."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from jackettwin.findings import Finding
from jackettwin.study.measurements import MeasuredMode, may_be_two


@pytest.mark.parametrize(
    ("code", "at_hz", "seen", "expected"),
    [
        ("perhaps_two", 2.397, True, True),
        ("hidden_mode", 2.43, True, True),  # within the bandwidth of 2 %
        ("hidden_mode", 2.60, True, False),  # another mode's
        ("steady_tone_near", 2.397, True, False),
        ("perhaps_two", 2.397, False, False),  # of a record that the shape is not from
    ],
)
def test_a_shape_that_its_record_takes_for_two_is_known(
    code: str, at_hz: float, seen: bool, expected: bool
) -> None:
    own, other = (SimpleNamespace(frequency_hz=2.4, damping_ratio=0.01) for _ in range(2))
    found = Finding(code, params={"frequency_hz": at_hz, "other_hz": 2.5, "share": 0.2})
    record = SimpleNamespace(
        modes={6: (own if seen else other, None)}, identification=SimpleNamespace(findings=(found,))
    )
    measured = cast(MeasuredMode, SimpleNamespace(mode=6, estimate=own))
    assert may_be_two(measured, cast(Any, [record])) is expected
    assert not may_be_two(cast(MeasuredMode, SimpleNamespace(mode=6, estimate=None)), cast(Any, [record]))
