"""The report: figures, tables, one self-contained page."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.report.build import build_report as build_report
    from jackettwin.report.page import (
        Plot as Plot,
        PageSection as PageSection,
        PageTable as PageTable,
        Text as Text,
    )

door(__name__)
