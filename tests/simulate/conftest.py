from pathlib import Path

import pytest
import yaml

SHORT = {"duration_s": 60.0, "step_s": 0.05}


@pytest.fixture
def scenario_file(tmp_path: Path):
    """Write a scenario of the reference jacket with the given keys, return its path."""

    def write(**keys) -> Path:
        path = tmp_path / "case.yaml"
        data = {"structure": "jacket15", "time": SHORT, **keys}
        path.write_text(yaml.safe_dump(data), encoding="utf-8")
        return path

    return write
