"""Every published number, recomputed: of the thesis, and of everybody else."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import nan
from statistics import median

from jackettwin.verify import chapters, open_questions, supports, tables
from jackettwin.verify.benchmarks import BENCHMARKS
from jackettwin.verify.rows import OTHERS, Computed, Row, published, rows_of

__all__ = ["STEPS", "STEPS_OF_OTHERS", "Row", "benchmark_rows", "median_error", "published", "published_rows"]

_CHAPTERS: dict[str, Callable[[], Computed]] = {
    "chapter 3: cantilever": chapters.cantilever,
    "chapter 4: viscoelasticity": chapters.viscoelasticity,
    "chapter 5: jacket": chapters.jacket,
    "chapters 3 and 5: one geometry for all tables": tables.tables,
    "chapter 8: the thesis's own parameters": supports.own_parameters,
    "chapter 8: fit kelvin-voigt to Table 6.1": partial(supports.fit, "kelvin-voigt"),
    "chapter 8: fit zener to Table 6.1": partial(supports.fit, "zener"),
    "chapter 10: open questions": open_questions.open_questions,
}
STEPS = len(_CHAPTERS)
"""Number of steps that ``published_rows`` announces."""
STEPS_OF_OTHERS = len(BENCHMARKS)
"""Number of steps that ``benchmark_rows`` announces."""


def published_rows(step: Callable[[str], None] = lambda _: None) -> tuple[Row, ...]:
    """Return every published number beside ours, in the order of the thesis."""
    computed: Computed = {}
    for chapter, recompute in _CHAPTERS.items():
        step(chapter)
        computed |= recompute()
    return rows_of(computed)


def benchmark_rows(step: Callable[[str], None] = lambda _: None) -> tuple[Row, ...]:
    """Return others' published benchmarks beside ours."""
    computed: Computed = {}
    for name, recompute in BENCHMARKS.items():
        step(name)
        computed |= recompute()
    return rows_of(computed, OTHERS)


def median_error(rows: tuple[Row, ...]) -> float:
    """Return the median of the absolute relative errors of rows that are checked; nan if none is."""
    errors = [
        abs(row.relative_error) for row in rows if row.ok is not None and row.relative_error is not None
    ]
    return median(errors) if errors else nan
