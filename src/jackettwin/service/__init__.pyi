from .alerts.outbox import tried_channels as tried_channels
from .context import Service as Service
from .demonstration import demonstrate as demonstrate
from .intake.files import Accepted as Accepted
from .intake.folder import record_files as record_files, watch_folders as watch_folders
from .logs import start_logging as start_logging
from .server import serve as serve
from .settings import ServiceSettings as ServiceSettings, read_settings as read_settings
from .store_commands import (
    add_conditions as add_conditions,
    add_twin as add_twin,
    adopt_version as adopt_version,
    archive_asset as archive_asset,
    place_asset as place_asset,
    rebuild as rebuild,
    take_here as take_here,
)
