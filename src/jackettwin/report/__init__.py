"""The report: figures, tables, one self-contained page."""

from jackettwin.report.build import build_gallery, build_report
from jackettwin.report.page import Plot, Section, Table, Text

__all__ = ["Plot", "Section", "Table", "Text", "build_gallery", "build_report"]
