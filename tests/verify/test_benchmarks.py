"""Others' benchmarks hold, their misses are the known ones, and a wrong sign is seen."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.structure import Structure
from jackettwin.verify import Row, benchmark_rows, median_error
from jackettwin.verify.benchmarks import frames, piles


@pytest.fixture(scope="module")
def rows() -> tuple[Row, ...]:
    return benchmark_rows()


def test_every_row_holds_or_says_why_it_misses(rows: tuple[Row, ...]) -> None:
    assert [row.id for row in rows if row.ok is False] == [row.id for row in rows if row.missed]


def test_there_are_forty_rows_and_the_median_error_is_small(rows: tuple[Row, ...]) -> None:
    """The issue asks for 40 rows, and 2 % where the benchmark fixes the answer."""
    assert sum(row.ok is not None for row in rows) >= 40
    assert len({row.id for row in rows}) == len(rows)
    assert median_error(rows) < 0.02


def test_every_row_has_a_source_and_a_reason_for_its_tolerance(rows: tuple[Row, ...]) -> None:
    # a tolerance of the printed digits needs no reason
    assert [row.id for row in rows if not row.note] == [
        "column-tip-weight",
        *(f"linear-{share}" for share in ("0.1", "0.2", "0.5")),
    ]
    assert all(row.source for row in rows)


def test_a_wrong_number_fails_and_a_known_miss_does_not(rows: tuple[Row, ...]) -> None:
    for row in rows:
        if row.ok is None:
            continue
        assert row.tolerance is not None
        wrong = replace(row, computed=row.published * (1.0 + 2.0 * row.tolerance) + 1e-3 * row.published)
        assert wrong.ok is False
        assert wrong.failed == (not row.missed)


def test_a_wrong_sign_of_the_weight_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Weight that stiffens would let no column buckle: the factor turns negative or infinite."""
    original = frames.assemble

    def lifted(structure: Structure, *, gravity: bool = False):
        one = original(structure, gravity=gravity)
        if not gravity:
            return one
        elastic = original(structure)
        return replace(one, stiffness=2.0 * elastic.stiffness - one.stiffness)

    monkeypatch.setattr(frames, "assemble", lifted)
    assert frames._columns()["column-tip-weight"] != pytest.approx(2.4674, rel=0.5)


def test_coefficients_of_piles_do_not_depend_on_the_pile(monkeypatch: pytest.MonkeyPatch) -> None:
    before = piles.pile_benchmarks()
    monkeypatch.setattr(piles, "_PILE", replace(piles._PILE, outer_diameter_m=0.8, length_m=70.0))
    after = piles.pile_benchmarks()
    names = [name for name in before if not name.startswith("winkler")]
    np.testing.assert_allclose([after[n] for n in names], [before[n] for n in names], rtol=2e-5)


def test_no_row_has_no_median() -> None:
    assert np.isnan(median_error(()))
