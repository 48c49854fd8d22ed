"""A published number beside ours, and the table of those that were published."""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass
from importlib.resources import files
from typing import Any, Literal

THESIS, OTHERS = "published.csv", "benchmarks.csv"
"""The tables: of the thesis, and of everybody else."""
Computed = dict[str, float | tuple[float, float]]
"""Our number by the row's id; the reference and ours, where the reference is computed as well."""


@dataclass(frozen=True)
class Row:
    """One published number, recomputed.

    Attributes
    ----------
    tolerance : float or None
        Largest allowed relative error; for ``kind="at most"`` the bound itself is ``published``. None marks a
        row that informs only, for the reason in its note.
    kind : {"equal", "at most"}
        ``at most`` rows hold a figure that must not exceed the published one (an error of a fit).
    note : str
        Why the tolerance is what it is, why a row informs only, or which misprint is corrected.
    missed : str
        Why ours lies outside the tolerance, where that is known; such a row stays in sight and fails nothing.
    """

    id: str
    source: str
    quantity: str
    published: float
    computed: float | None
    tolerance: float | None
    kind: Literal["equal", "at most"] = "equal"
    note: str = ""
    missed: str = ""

    @property
    def relative_error(self) -> float | None:
        """computed/published − 1; None where it makes no sense."""
        if self.computed is None or self.kind == "at most" or self.published == 0.0:
            return None
        return self.computed / self.published - 1.0

    @property
    def ok(self) -> bool | None:
        """Whether the row holds; None if it informs only."""
        if self.tolerance is None:
            return None
        if self.computed is None:
            return False
        if self.kind == "at most":
            return bool(self.computed <= self.published * (1.0 + self.tolerance))
        error = self.relative_error
        return error is not None and bool(abs(error) <= self.tolerance)

    @property
    def failed(self) -> bool:
        """Whether the row does not hold, and nothing says why."""
        return self.ok is False and not self.missed

    def document(self) -> dict[str, Any]:
        """Return the row as JSON data."""
        return {**asdict(self), "relative_error": self.relative_error, "ok": self.ok}


def rows_of(computed: Computed, table: str = THESIS) -> tuple[Row, ...]:
    """Return the rows of a table beside what was computed for them."""
    return tuple(_row(entry, computed[entry["id"]]) for entry in _entries(table))


def published(key: str) -> tuple[float, ...]:
    """Return the published frequencies [Hz] of the modes of a table: ``T5.2``, ``T5.4-ROSAP``."""
    return tuple(float(e["published"]) for e in _entries(THESIS) if e["id"].startswith(f"{key}-f"))


def _entries(table: str) -> list[dict[str, Any]]:
    text = (files("jackettwin.verify") / table).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def _row(entry: dict[str, Any], computed: float | tuple[float, float]) -> Row:
    text, tolerance = entry.pop("published"), entry.pop("tolerance")
    reference, ours = computed if isinstance(computed, tuple) else (float(text), computed)
    allowed = _rounding(text) if tolerance == "printed" else float(tolerance) if tolerance else None
    return Row(**entry, published=reference, computed=ours, tolerance=allowed)


def _rounding(text: str) -> float:
    """Return the largest relative error that printing a number with these decimals can make."""
    decimals = len(text.partition(".")[2])
    return 0.5 * 10.0**-decimals / abs(float(text)) * 1.001
