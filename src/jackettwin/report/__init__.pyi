from .build import build_report as build_report
from .pages.follow import stiffness_section as stiffness_section
from .pages.page import (
    PageSection as PageSection,
    Plot as Plot,
    Text as Text,
    with_library as with_library,
    without_library as without_library,
)
from .sections.structure import structure_view as structure_view
from .table import UNKNOWN as UNKNOWN, Table as Table, TableColumn as TableColumn, cell as cell
from .tables.light import Light as Light, light as light
from .tables.numbers import quantity as quantity, words as words
from .tables.sentences import sentences as sentences, span_words as span_words
from .tables.sentences_fit import value_words as value_words
from .view.motions import record_motion as record_motion
from .view.page import (
    ColouredQuantity as ColouredQuantity,
    View as View,
    view_document as view_document,
)
from .view.quantities import thickness_quantities as thickness_quantities
