from .correction import in_step as in_step, stretch as stretch
from .delays import phases as phases
from .grid import (
    between_ticks as between_ticks,
    regularise as regularise,
    shortest_decimal as shortest_decimal,
    without_hours as without_hours,
)
from .loggers import clocks_of as clocks_of
from .results import LoggerClocks as LoggerClocks, clock_findings as clock_findings
