"""What is kept of the living twin: one database, one folder of waveforms."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.store.database import (
        open_database as open_database,
        reading as reading,
        sqlite_url as sqlite_url,
        writing as writing,
    )
    from jackettwin.store.waveforms import (
        read_waveform as read_waveform,
        waveform_path as waveform_path,
        write_waveform as write_waveform,
    )

door(__name__)
