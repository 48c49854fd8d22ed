from .build import build_report as build_report
from .pages.page import PageSection as PageSection, Plot as Plot, Text as Text
from .table import UNKNOWN as UNKNOWN, Table as Table, TableColumn as TableColumn, cell as cell
from .tables.sentences import sentences as sentences
from .view.page import ColouredQuantity as ColouredQuantity
