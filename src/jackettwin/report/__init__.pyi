from .build import build_report as build_report
from .pages.page import PageSection as PageSection, PageTable as PageTable, Plot as Plot, Text as Text
