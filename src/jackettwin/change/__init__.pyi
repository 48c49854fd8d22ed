from .changed_structures import Happening as Happening, Standing as Standing, with_mass as with_mass
from .ground import Ground as Ground
from .judge import (
    JUDGED as JUDGED,
    Columns as Columns,
    Days as Days,
    Judged as Judged,
    corrections as corrections,
    finding_of as finding_of,
    history_of as history_of,
    judge as judge,
    sight_of as sight_of,
)
from .table_monitoring import Alarm as Alarm, Watched as Watched
from .watch_document import next_sentence as next_sentence, statement as statement
