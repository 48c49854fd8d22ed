from .columns import rounded as rounded
from .database import (
    open_database as open_database,
    private_folder as private_folder,
    reading as reading,
    sqlite_url as sqlite_url,
    writing as writing,
)
from .export import ADMINS as ADMINS, Exported as Exported, exported as exported
from .people import note_down as note_down
from .results import StoredObservation as StoredObservation
from .streams import Packet as Packet
from .waveforms import (
    is_waveform as is_waveform,
    read_extremes as read_extremes,
    read_waveform as read_waveform,
    waveform_path as waveform_path,
    without_false_digits as without_false_digits,
    write_waveform as write_waveform,
)
