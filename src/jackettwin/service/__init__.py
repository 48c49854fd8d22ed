"""The living twin as a service: intake, workers, consequences, API, pages."""

from jackettwin.service.context import Service, open_service
from jackettwin.service.demonstration import demonstrate
from jackettwin.service.desk import add_conditions, add_twin, adopt_version, rebuild, take_here
from jackettwin.service.intake.files import Accepted
from jackettwin.service.intake.folder import record_files, watch_folders
from jackettwin.service.server import running, serve
from jackettwin.service.settings import ServiceSettings

__all__ = [
    "Accepted",
    "Service",
    "ServiceSettings",
    "add_conditions",
    "add_twin",
    "adopt_version",
    "demonstrate",
    "open_service",
    "rebuild",
    "record_files",
    "running",
    "serve",
    "take_here",
    "watch_folders",
]
