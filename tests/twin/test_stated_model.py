"""A record that states its model decides what a twin leaves out; a twin that says otherwise is told so."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from jackettwin.cli import main
from jackettwin.errors import InputError
from jackettwin.records import read_record
from jackettwin.twin import read_twin


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record that was simulated without gravity."""
    folder = tmp_path_factory.mktemp("stated")
    scenario = {
        "structure": "jacket15",
        "gravity": False,
        "support": "kelvin-voigt:k=2.5e9,c=7.6e8",
        "wind": {"speed_m_s": 12},
        "time": {"duration_s": 60, "step_s": 0.05},
    }
    (folder / "s.yaml").write_text(yaml.safe_dump(scenario))
    result = CliRunner().invoke(
        main, ["simulate", str(folder / "s.yaml"), "--out", str(folder / "r.parquet")]
    )
    assert result.exit_code == 0, result.output
    return folder / "r.parquet"


def twin(record: Path, **keys: object) -> Path:
    path = record.with_name("t.yaml")
    path.write_text(yaml.safe_dump({"structure": "jacket15", "records": [record.name], **keys}))
    return path


def test_the_records_model_fills_what_the_twin_leaves_out(record: Path) -> None:
    config = read_twin(twin(record))
    assert not config.gravity
    assert "gravity" in config.of_records
    said = read_twin(twin(record, gravity=True))
    assert said.gravity
    assert "gravity" not in said.of_records


def test_gravity_is_the_default_of_scenarios_and_twins_alike(tmp_path: Path) -> None:
    (tmp_path / "t.yaml").write_text("structure: jacket15\ntargets: [{mode: 1, frequency_hz: 0.17}]\n")
    assert read_twin(tmp_path / "t.yaml").gravity
    (tmp_path / "s.yaml").write_text("structure: jacket15\nsupport: pinned\n")
    from jackettwin.simulate import read_scenario

    assert read_scenario(tmp_path / "s.yaml").asset.gravity


def test_a_draft_takes_the_records_model_and_says_so(record: Path) -> None:
    out = record.with_name("draft.yaml")
    result = CliRunner().invoke(
        main, ["init", "jacket15", str(record), "--out", str(out), "--force", "--json"]
    )
    assert result.exit_code == 0, result.output
    assert "gravity false" in json.loads(result.stdout)["notes"][0]
    assert not read_twin(out).gravity


def test_an_emptied_description_says_how_it_was_emptied(record: Path, tmp_path: Path) -> None:
    (tmp_path / "x.parquet").write_bytes(record.read_bytes())
    (tmp_path / "x.json").write_text("")
    with pytest.raises(InputError, match=r"x\.json: is empty.*describes the record.*another name"):
        read_record(tmp_path / "x.parquet")
