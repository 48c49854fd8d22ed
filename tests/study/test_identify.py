"""Many records: the same as one by one, on several cores, with what is broken listed, resumable."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy.io import netcdf_file

from jackettwin.errors import InputError
from jackettwin.files import KeptInFolder, json_pieces
from jackettwin.identification import IdentificationSettings
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.progress import CallbackProgress
from jackettwin.records import Record, read_record, write_record
from jackettwin.records.readers import record_files
from jackettwin.study.many_records.document import many_document
from jackettwin.study.many_records.export import export_modes
from jackettwin.study.many_records.identify import Batch, observe_many
from jackettwin.study.many_records.summary import fuse_batch
from jackettwin.twin import TwinModel

module = import_module("jackettwin.twin.observe_files")

SETTINGS = IdentificationSettings(lowest_frequency_hz=0.3, max_order=24, refine=False)
MODEL = TwinModel("test", identification=SETTINGS)
WIND = (7.2, 8.4, 12.1, 8.1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four records of one system at 8 and 12 m/s, and one that is no record at all."""
    folder = tmp_path_factory.mktemp("records")
    rng = np.random.default_rng(5)
    system = ModalSystem(
        np.array([0.5, 1.3]),
        np.array([0.02, 0.015]),
        np.array([[1.0, 0.6, 0.3], [-0.4, 0.5, 1.0]]),
        np.eye(2),
    )
    for i, wind in enumerate(WIND):
        record = simulate(system, rng, duration_s=300.0, sample_rate_hz=10.0)
        conditions = {"mean_wind_speed_m_s": wind, "yaw_deg": 0.0, "state": "idling"}
        write_record(replace(record, conditions=conditions), folder / f"r{i}.parquet")
    (folder / "r9.parquet").write_bytes(b"not a parquet file")
    return folder


@pytest.fixture(scope="module")
def batch(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Batch:
    results = tmp_path_factory.mktemp("results")
    return observe_many(record_files([folder]), MODEL, keep=KeptInFolder(results), workers=1)


@pytest.fixture(scope="module")
def document(batch: Batch) -> dict:
    return many_document(batch, fuse_batch(batch))


def test_a_broken_record_stops_nothing(batch: Batch) -> None:
    assert [s.identification.records[0] for s in batch] == ["r0", "r1", "r2", "r3"]
    assert len(batch.failed) == 1
    assert "r9.parquet" in batch.failed[0].problem


def test_a_fault_of_ours_in_one_record_stops_nothing(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever is raised: alone such a record shows the traceback, in a batch its reason."""
    whole = module.observe

    def broken(record: Record, model: TwinModel):
        if record.name == "r1":
            raise FloatingPointError("underflow")
        return whole(record, model)

    monkeypatch.setattr(module, "observe", broken)
    files = [folder / "r0.parquet", folder / "r1.parquet"]
    found = observe_many(files, MODEL, keep=KeptInFolder(tmp_path), workers=1)
    assert [s.identification.records[0] for s in found] == ["r0"]
    assert "FloatingPointError: underflow" in found.failed[0].problem


def test_processes_give_the_same_as_one(folder: Path, tmp_path: Path, batch: Batch) -> None:
    files = [folder / "r0.parquet", folder / "r9.parquet", folder / "r1.parquet"]
    again = observe_many(files, MODEL, keep=KeptInFolder(tmp_path), workers=2)
    for one, before in zip(again, batch, strict=False):
        assert one.identification.records == before.identification.records
        a, b = one.identification.modes[0], before.identification.modes[0]
        # another number of BLAS threads rounds differently, and may pick the pole of another model order
        assert abs(a.frequency_hz - b.frequency_hz) < b.frequency_std_hz
    assert again.failed == batch.failed


def test_what_was_done_before_an_interruption_is_not_done_again(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, batch: Batch, document: dict
) -> None:
    files = record_files([folder])
    started: list[str] = []
    monkeypatch.setattr(module, "observe", counted(module.observe, started))
    keep = KeptInFolder(tmp_path)

    def interrupt(what: str) -> None:
        if "r2.parquet" in what:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        observe_many(files, MODEL, keep=keep, workers=1, progress=CallbackProgress(interrupt))
    again = observe_many(files, MODEL, keep=keep, workers=1)
    assert started == ["r0", "r1", "r2", "r3"]
    # to the last digit and letter
    assert "".join(json_pieces(many_document(again, fuse_batch(again)))) == "".join(json_pieces(document))
    # other settings are another result
    others = replace(MODEL, identification=SETTINGS.model_copy(update={"max_order": 20}))
    observe_many(files[:1], others, keep=keep, workers=1)
    assert started[4:] == ["r0"]
    # a result that is damaged is computed again
    for file in tmp_path.iterdir():
        file.write_text('{"identification": {')
    observe_many(files[:1], MODEL, keep=keep, workers=1)
    assert started[5:] == ["r0"]


def counted(function, started: list[str]):
    def one(record: Record, model: TwinModel):
        started.append(record.name)
        return function(record, model)

    return one


def test_a_renamed_copy_counts_once_and_is_named(folder: Path, tmp_path: Path, batch: Batch) -> None:
    """Fused twice, a record would narrow every interval by √2 without a word."""
    write_record(replace(read_record(folder / "r1.parquet"), name="copy"), tmp_path / "copy.parquet")
    files = [folder / "r0.parquet", folder / "r1.parquet", tmp_path / "copy.parquet"]
    once = observe_many(files[:2], MODEL, keep=KeptInFolder(tmp_path), workers=1)
    twice = observe_many(files, MODEL, keep=KeptInFolder(tmp_path), workers=1)
    assert twice.results == once.results
    assert [(f.subject, f.params["as"]) for f in twice.findings] == [("copy.parquet", "r1.parquet")]
    assert "copy.parquet" in many_document(twice, fuse_batch(twice))["warnings"][0]


def test_groups_are_bins_of_wind(document: dict) -> None:
    groups = document["groups"]
    assert [(g["wind_speed_m_s"], g["records"]) for g in groups] == [
        ((7.0, 9.0), ["r0", "r1", "r3"]),
        ((11.0, 13.0), ["r2"]),
    ]
    assert all(g["yaw_deg"] == (-15.0, 15.0) and g["state"] == "idling" for g in groups)


def test_the_document_is_json_and_complete(document: dict) -> None:
    written = json.loads("".join(json_pieces(document)))
    assert [len(written[key]) for key in ("records", "quality")] == [4, 4]
    assert {pick["record"] for pick in written["picks"]} == {"r0", "r1", "r2", "r3"}
    first = document["modes"][0]
    assert first["records_with_mode"] == 4
    assert [step["n_records"] for step in first["convergence"]] == [1, 2, 4]
    last = first["convergence"][-1]
    assert last["damping_ratio"] == pytest.approx(first["damping_ratio"])
    assert last["damping_ratio_interval_90"] == pytest.approx(first["damping_ratio_interval_90"])
    for mode, f in zip(document["modes"], (0.5, 1.3), strict=False):
        # five standard deviations of the best estimate from 1200 s
        assert mode["frequency_hz"] == pytest.approx(f, rel=5 * np.sqrt(0.02 / (2 * np.pi * f * 1200)))
    assert document["failed"][0]["record"].endswith("r9.parquet")


def test_records_of_other_sensors_stand_for_themselves(folder: Path, tmp_path: Path) -> None:
    record = read_record(folder / "r1.parquet")
    channels = tuple(replace(c, name=f"b{i}") for i, c in enumerate(record.channels))
    write_record(replace(record, channels=channels), tmp_path / "other.parquet")
    files = [folder / "r0.parquet", tmp_path / "other.parquet"]
    batch = observe_many(files, MODEL, keep=KeptInFolder(tmp_path / "results"), workers=1)
    document = many_document(batch, fuse_batch(batch))
    assert document["modes"] == []
    assert "records share no channel" in document["warnings"][0]
    assert len(list(document["records"])) == 2


def test_tables_hold_every_mode_of_every_set(document: dict, tmp_path: Path) -> None:
    export_modes(document, tmp_path / "m.csv")
    with (tmp_path / "m.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    sets = list(dict.fromkeys(row["set"] for row in rows))
    assert sets[:3] == [
        "fused",
        "wind 7 to 9 m/s, yaw -15 to 15 deg, idling",
        "wind 11 to 13 m/s, yaw -15 to 15 deg, idling",
    ]
    assert sets[3:] == ["r0", "r1", "r2", "r3"]
    assert float(rows[0]["damping_ratio"]) == document["modes"][0]["damping_ratio"]
    assert float(rows[0]["shape_real_a1"]) == document["modes"][0]["mode_shape"]["a1"][0]

    export_modes(document, tmp_path / "m.nc")
    with netcdf_file(str(tmp_path / "m.nc"), mmap=False) as file:
        f = file.variables["frequency_hz"]
        assert f.units == b"Hz"
        assert f[:].tolist() == [float(row["frequency_hz"]) for row in rows]
        names = [b"".join(text).decode().strip() for text in file.variables["channel_name"][:]]
        assert names == ["a0", "a1", "a2"]
        assert file.variables["mode_shape_real"][0, 1] == document["modes"][0]["mode_shape"]["a1"][0]

    export_modes(document, tmp_path / "m.json")
    assert json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))["duration_s"] == 1200.0


def test_bad_sources_and_formats_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder holds no record"):
        record_files([tmp_path])
    with pytest.raises(InputError, match=r"gone.parquet.*no such file"):
        record_files([tmp_path / "gone.parquet", tmp_path / "also.parquet"])
    with pytest.raises(InputError, match=r"cannot export to this format.*\.csv"):
        export_modes({}, tmp_path / "m.xlsx")
