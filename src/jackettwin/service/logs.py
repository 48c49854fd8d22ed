"""Log lines as text, or as JSON for log collectors."""

from __future__ import annotations

import json
import logging
from datetime import UTC, datetime


class JsonLines(logging.Formatter):
    """Formatter of JSON lines with ``time_utc``, ``level``, ``logger``, ``message`` and any ``trace``."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line of a log record."""
        said = {
            "time_utc": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        if record.exc_info:
            said["trace"] = self.formatException(record.exc_info)
        return json.dumps(said, ensure_ascii=False)


def start_logging(level: str, *, as_json: bool) -> None:
    """Write log messages from a level of :mod:`logging` to the standard error stream.

    From other libraries only warnings are written, or with ``debug`` everything.
    """
    handler = logging.StreamHandler()
    plain = logging.Formatter("%(asctime)s %(levelname)s %(message)s")
    handler.setFormatter(JsonLines() if as_json else plain)
    if level.lower() != "debug":
        handler.addFilter(lambda r: r.name.startswith("jackettwin") or r.levelno >= logging.WARNING)
    logging.basicConfig(level=level.upper(), handlers=[handler])
