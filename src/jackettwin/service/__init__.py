"""The living twin as a service: intake, workers, consequences, API, pages."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.service.context import Service as Service
    from jackettwin.service.demonstration import demonstrate as demonstrate
    from jackettwin.service.desk import (
        add_conditions as add_conditions,
        add_twin as add_twin,
        adopt_version as adopt_version,
        archive_asset as archive_asset,
        rebuild as rebuild,
        take_here as take_here,
    )
    from jackettwin.service.intake.files import Accepted as Accepted
    from jackettwin.service.intake.folder import record_files as record_files, watch_folders as watch_folders
    from jackettwin.service.server import serve as serve
    from jackettwin.service.settings import ServiceSettings as ServiceSettings

door(__name__)
