"""Two years of daily modes with a season and, from one day on, a scour: numbers made for a picture."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np


def write_table(path: Path) -> None:
    """Write frequencies f1, f2, f3 [Hz] by day; from day 520 on f1 is 0.4, f2 0.4 and f3 0.1 % lower."""
    rng = np.random.default_rng(1)
    days = np.arange(730)
    season = np.sin(2 * np.pi * days / 365.25)
    changed = days >= 520
    begin = datetime(2024, 1, 1, tzinfo=UTC)
    columns = [
        f0 * (1 + swing * season - drop * changed + 0.001 * rng.standard_normal(730))
        for f0, swing, drop in ((0.175, 0.002, 0.004), (0.178, 0.002, 0.004), (0.744, 0.004, 0.001))
    ]
    rows = [
        f"{begin + timedelta(days=int(day)):%Y-%m-%dT%H:%M:%SZ},"
        + ",".join(f"{column[day]:.5f}" for column in columns)
        for day in days
    ]
    path.write_text("time_utc,f1,f2,f3\n" + "\n".join(rows) + "\n")
