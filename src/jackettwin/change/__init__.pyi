from .alarms import Alarm as Alarm
from .changed_structures import Happening as Happening, Standing as Standing, with_mass as with_mass
from .ground import Ground as Ground
from .judge import (
    JUDGED as JUDGED,
    Columns as Columns,
    Days as Days,
    StoredMonitoring as StoredMonitoring,
    corrections as corrections,
    finding_of as finding_of,
    history_of as history_of,
    judge as judge,
    monitoring_document as monitoring_document,
    sight_of as sight_of,
)
from .smallest_changes import (
    smallest_documents as smallest_documents,
    smallest_sentence as smallest_sentence,
)
from .table_monitoring import (
    MonitoredTable as MonitoredTable,
    statement as statement,
    watched_document as watched_document,
)
from .watch_document import (
    alike_sentence as alike_sentence,
    corrected_sentence as corrected_sentence,
    next_sentence as next_sentence,
    verdict_words as verdict_words,
)
from .working_rotor import WorkingRotor as WorkingRotor
