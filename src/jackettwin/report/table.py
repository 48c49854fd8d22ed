"""Tables for the terminal and for pages: columns with their formats, and rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

UNKNOWN = "–"


@dataclass(frozen=True)
class TableColumn:
    """A column: heading with unit, value and format.

    Attributes
    ----------
    head : str
        Name and unit, ``f [Hz]``.
    value : str or function
        Key of the row, or function of the row.
    form : str
        Format specification of Python; empty for text.
    scale : float
        Factor from the value's unit to the column's.

    Examples
    --------
    >>> TableColumn("ζ [%]", "damping_ratio", ".2f", 100.0).text({"damping_ratio": 0.0127})
    '1.27'
    """

    head: str
    value: str | Callable[[Any], Any]
    form: str = ""
    scale: float = 1.0

    def text(self, row: Any) -> str:
        """Return the cell of a row."""
        value = row[self.value] if isinstance(self.value, str) else self.value(row)
        return cell(value if value is None or not self.form else self.scale * value, self.form)


def cell(value: Any, form: str = "") -> str:
    """Return a value as text: a dash if it is unknown, and no minus sign for zero.

    >>> cell(-1e-9, ".2f"), cell(None, ".2f"), cell(float("nan"), ".3g"), cell("text")
    ('0.00', '–', '–', 'text')
    """
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return UNKNOWN
    sign = form[:1] if form[:1] == "+" else ""
    return f"{value:{sign}z{form.removeprefix(sign)}}" if form else str(value)


@dataclass(frozen=True)
class Table:
    """Rows under columns.

    Attributes
    ----------
    caption : str
        Content of the table, or the question that it answers.
    columns : sequence of TableColumn or str
        If they are texts, every row is a sequence of cells.
    text_columns : int
        Number of text columns on the left.
    marked : set of int
        Indices of highlighted rows.
    folded : bool
        Whether a page shows the table only on request.
    """

    caption: str
    columns: Sequence[TableColumn | str]
    rows: Sequence[Any]
    text_columns: int = 1
    marked: frozenset[int] = frozenset()
    folded: bool = False
    kind: Literal["table"] = "table"

    @property
    def heads(self) -> tuple[str, ...]:
        """The headings."""
        return tuple(c if isinstance(c, str) else c.head for c in self.columns)

    @cached_property
    def cells(self) -> tuple[tuple[str, ...], ...]:
        """The rows as printed."""
        return tuple(self._row(row) for row in self.rows)

    def _row(self, row: Any) -> tuple[str, ...]:
        given = () if isinstance(row, Mapping) else row
        return tuple(
            cell(given[i]) if isinstance(column, str) else column.text(row)
            for i, column in enumerate(self.columns)
        )
