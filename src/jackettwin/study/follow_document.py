"""A followed twin as the document that ``jackettwin follow`` prints and writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError, located
from jackettwin.study.follow_result import FOLLOWED, Followed
from jackettwin.version import __version__

STORED = "state"
"""Key of what the next run goes on from."""


def follow_document(followed: Followed) -> dict[str, Any]:
    """Return the document of ``jackettwin follow``, with what the next day starts from."""
    drift = followed.drift
    return {
        "name": followed.name,
        "law": followed.law,
        "reference_frequency_hz": followed.reference_hz,
        "wind_speed_m_s": followed.wind_m_s,
        "units": dict(followed.units),
        "days": [
            {
                "time_utc": day.time_utc.isoformat(),
                "records": day.records,
                "status": day.status,
                "parameters": {
                    name: {"median": median, "interval_90": list(day.interval_90[name])}
                    for name, median in day.median.items()
                },
            }
            for day in followed.days
        ],
        "drift": None
        if drift is None
        else {
            "parameters": list(followed.stiffness),
            "log_slope_per_day": drift.slope_per_day,
            "log_slope_per_day_std": drift.std_per_day,
            "log_slope_per_day_interval_90": list(drift.interval_90),
            "detected": drift.detected,
            "scatter": drift.scatter,
            "line": {
                name: [
                    {"median": m, "interval_90": [a, b]}
                    for m, a, b in drift.line(name, followed.days_since_first).tolist()
                ]
                for name in followed.stiffness
            },
        },
        "statement": followed.statement,
        "warnings": list(followed.warnings),
        "code_version": __version__,
        STORED: FOLLOWED.dump(followed),
    }


def read_followed(path: Path) -> Followed:
    """Read what an earlier run of ``jackettwin follow`` left.

    Raises
    ------
    InputError
        If the file is not what ``jackettwin follow`` writes.
    """
    remedy = "give the followed.json of an earlier run"
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError):
        raise InputError("not a JSON document", file=path, remedy=remedy) from None
    if not isinstance(document, dict) or STORED not in document:
        raise InputError("required key is missing", file=path, field=STORED, remedy=remedy)
    with located(file=path, field=STORED):
        return FOLLOWED.load(document[STORED])
