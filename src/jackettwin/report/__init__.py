"""The report: figures, tables, one self-contained page."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.report.build import build_report
    from jackettwin.report.page import Plot, Section, Table, Text

__all__ = ["Plot", "Section", "Table", "Text", "build_report"]

door(
    __name__,
    {
        "build": "build_report",
        "page": "Plot Section Table Text",
    },
)
