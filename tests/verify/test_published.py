"""The published numbers hold, and a row that does not hold says so."""

from dataclasses import replace

import pytest

from jackettwin.verify import Row, published_rows


@pytest.fixture(scope="module")
def rows() -> tuple[Row, ...]:
    return published_rows()


def test_every_checked_row_holds(rows: tuple[Row, ...]) -> None:
    assert [row.id for row in rows if row.ok is False] == []


def test_at_least_sixty_rows_are_checked_and_names_are_unique(rows: tuple[Row, ...]) -> None:
    assert sum(row.ok is not None for row in rows) >= 60
    assert len({row.id for row in rows}) == len(rows)


def test_rows_that_inform_only_say_why(rows: tuple[Row, ...]) -> None:
    assert all(row.note for row in rows if row.ok is None)


def test_a_wrong_number_fails(rows: tuple[Row, ...]) -> None:
    for row in rows:
        if row.tolerance is not None and row.computed is not None:
            worse = (
                2.0 * row.published
                if row.kind == "at most"
                else row.published * (1 + 2 * row.tolerance + 1e-9)
            )
            assert replace(row, computed=worse).ok is False


def test_a_missing_number_fails() -> None:
    assert Row("x", "s", "q", 1.0, None, 0.1).ok is False
