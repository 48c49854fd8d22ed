"""The window writes numbers as the report does: both are held to one table."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from jackettwin.report.tables import numbers

CASES = json.loads((Path(__file__).parents[2] / "app" / "tests" / "numbers.json").read_text("utf-8"))


@pytest.mark.parametrize(("name", "given", "said"), CASES)
def test_a_number_is_written_as_in_the_window(name: str, given: list[object], said: str) -> None:
    assert getattr(numbers, name)(*given) == said
