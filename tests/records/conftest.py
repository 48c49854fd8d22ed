from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from jackettwin.records import Channel, Record


@pytest.fixture
def record(rng: np.random.Generator) -> Record:
    """Three channels of two kinds with a hole, and everything a record can know."""
    data = rng.normal(size=(3, 400))
    data[1, 30:45] = np.nan
    channels = (
        Channel("acc_top_x", height_m=144.0, direction=(1.0, 0.0, 0.0)),
        Channel("acc_top_y", node="tower_top", direction=(0.0, 1.0, 0.0)),
        Channel("wind_hub_x", "wind speed", "m/s", height_m=149.6, direction=(1.0, 0.0, 0.0)),
    )
    return Record(
        data,
        12.5,
        channels,
        start_utc=datetime(2025, 1, 1, 13, tzinfo=UTC),
        conditions={"mean_wind_speed_m_s": 12.0, "yaw_deg": 30.0, "state": "parked"},
        metadata={"source": "a test", "turbine": {"row": 3}},
        name="r",
    )
