"""A small tower on two legs, a record of it, and a twin that joins them: the least that ``run`` needs."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml


@dataclass
class Case:
    """Files of one run, as data that a test may spoil before it writes them."""

    folder: Path
    structure: dict
    record: dict
    signals: dict
    twin: dict

    def write(self) -> Path:
        """Write the files; return the twin's path."""
        self.folder.mkdir(exist_ok=True)
        (self.folder / "frame.yaml").write_text(yaml.safe_dump(self.structure))
        (self.folder / "day.json").write_text(json.dumps(self.record))
        pq.write_table(pa.table(self.signals), self.folder / "day.parquet")
        (self.folder / "twin.yaml").write_text(yaml.safe_dump(self.twin))
        return self.folder / "twin.yaml"


@pytest.fixture
def case(tmp_path: Path, rng: np.random.Generator) -> Case:
    """Return a case without a mistake; its record holds noise, so it is for refusals only."""
    structure = {
        "sections": {"tube": {"outer_diameter_m": 2.0, "thickness_m": 0.04}},
        "nodes": {"a": [0, 0, 0], "b": [20, 0, 0], "c": [0, 20, 0], "hip": [7, 7, 40], "top": [7, 7, 90]},
        "members": [
            {"name": name, "nodes": nodes, "section": "tube"}
            for name, nodes in {
                "leg_a": ["a", "hip"],
                "leg_b": ["b", "hip"],
                "leg_c": ["c", "hip"],
                "tower": ["hip", "top"],
            }.items()
        ],
        "masses": [{"node": "top", "mass_kg": 3e5}],
        "reaction_nodes": ["a", "b", "c"],
        "interface_nodes": ["hip"],
    }
    channel = {"quantity": "acceleration", "unit": "m/s^2"}
    record = {
        "sample_rate_hz": 20.0,
        "start_utc": "2025-01-01T00:00:00Z",
        "channels": {
            "top_x": {**channel, "node": "top", "direction": [1, 0, 0]},
            "top_y": {**channel, "node": "top", "direction": [0, 1, 0]},
        },
    }
    return Case(
        folder=tmp_path / "case",
        structure=structure,
        record=record,
        signals={name: rng.normal(size=12000) for name in ("top_x", "top_y")},
        twin={
            "structure": "frame.yaml",
            "damping": {"rayleigh": {"ratio": 0.01, "frequency_hz": 0.4}},
            "records": ["day.parquet"],
            "identification": {"lowest_frequency_hz": 0.2},
            "update": {"laws": ["kelvin-voigt"]},
        },
    )
