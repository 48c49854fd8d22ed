"""Records to measured modes: one that fails is listed, the others count."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, read_record, write_record
from jackettwin.study import run_twin
from jackettwin.study.measure import Measured, measure
from jackettwin.study.narrative import cautions
from jackettwin.twin import ALL, TwinModel, read_twin
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.model import twin_model

module = import_module("jackettwin.twin.observe_files")


@cache
def twin() -> tuple[TwinConfig, TwinModel]:
    """Return two records' twin without the life of its welds, and its model."""
    whole = read_twin("openfast_pile")
    config = replace(whole, records=whole.records[:2], life=None)
    return config, twin_model(config)


def measured(config: TwinConfig) -> Measured:
    return measure(config, twin()[1])


@pytest.fixture
def config() -> TwinConfig:
    return twin()[0]


def test_a_record_that_fails_is_left_out_and_said_to_be(config: TwinConfig, tmp_path: Path) -> None:
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"not a parquet file")
    found = measured(replace(config, records=(broken, config.records[0])))
    assert [seen.name for seen in found.observations] == [config.records[0].stem]
    assert found.observations[0].modes
    assert "broken.parquet" in found.failed[0].problem
    assert cautions(config, found, (), ())[0].startswith("left out: ")


def test_a_record_of_another_turbine_is_measured_and_counts_nowhere(
    config: TwinConfig, tmp_path: Path
) -> None:
    """The shipped record played 1.7 times as fast: shapes of the twin, at frequencies that are not."""
    other = tmp_path / "other.parquet"
    own = read_record(config.records[0], config.defaults)
    write_record(replace(own, sample_rate_hz=1.7 * own.sample_rate_hz, metadata={}), other)
    both = measured(replace(config, records=(config.records[0], other)))
    assert [seen.name for seen in both.observations] == [config.records[0].stem]
    assert both.state.totals[ALL].conditions.records == 1
    assert [(said.code, said.subject) for said in both.findings] == [("record_mismatched", "other")]
    # alone it is shown, as a record of another turbine, and no mode of this one is learnt from it
    alone = measured(replace(config, records=(other,)))
    (seen,) = alone.observations
    assert seen.mismatched and len(seen.identification.modes) > 2 and not seen.modes
    assert not alone.state.days and not alone.state.totals


def test_a_fault_of_ours_costs_one_record(config: TwinConfig, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = module.observe

    def faulty(record: Record, model: TwinModel):
        if record.name == config.records[1].stem:
            raise ValueError("shapes disagree")
        return whole(record, model)

    monkeypatch.setattr(module, "observe", faulty)
    found = measured(config)
    assert len(found.observations) == 1
    assert "ValueError: shapes disagree" in found.failed[0].problem


def test_without_any_record_the_first_reason_is_raised(config: TwinConfig, tmp_path: Path) -> None:
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"not a parquet file")
    with pytest.raises(InputError, match="not readable"):
        measured(replace(config, records=(broken,)))
    # a name that is wrong is no record
    with pytest.raises(InputError, match="no such file"):
        measured(replace(config, records=(config.records[0], tmp_path / "missing.parquet")))


def test_a_missing_record_is_named_by_twin_and_key_before_any_is_read(config: TwinConfig) -> None:
    gone = replace(config, records=(config.records[0], Path("missing.parquet")))
    with pytest.raises(InputError, match=r"\.yaml: records\[1\]: missing\.parquet: no such file"):
        run_twin(gone)


def test_a_renamed_copy_counts_once_and_is_named(config: TwinConfig, tmp_path: Path) -> None:
    first = config.records[0]
    for ending in (".parquet", ".json"):
        shutil.copy(first.with_suffix(ending), tmp_path / f"copy{ending}")
    once = measured(replace(config, records=(first,)))
    twice = measured(replace(config, records=(first, tmp_path / "copy.parquet")))
    assert twice.state == once.state
    assert [seen.name for seen in twice.observations] == [first.stem]
    assert [(f.code, f.subject) for f in twice.findings] == [("record_doubled", "copy")]
