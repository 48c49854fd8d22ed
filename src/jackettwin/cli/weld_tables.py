"""Tables of welds on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jackettwin.cli.console import say, show_table
from jackettwin.report import Table, TableColumn

SHOWN = 10
"""Largest number of rows in a table."""
SIDE = tuple(TableColumn(name, name) for name in ("joint", "brace", "side"))
POINT = (TableColumn("point", "position"), TableColumn("environment", "environment"))


def show_welds(title: str, columns: Sequence[TableColumn], rows: Sequence[dict[str, Any]]) -> None:
    """Print the first welds, and how many others there are."""
    show_table(Table(title, columns, rows[:SHOWN]))
    if len(rows) > SHOWN:
        say(f"and {len(rows) - SHOWN} more welds; --json has all of them")
