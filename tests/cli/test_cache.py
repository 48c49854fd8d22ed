"""Identifications kept between runs: the same to the last digit, by content, settings and code; or none."""

from __future__ import annotations

import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from jackettwin.cli import cache as module
from jackettwin.cli.cache import cache_folder, keeping
from jackettwin.files.codec import encode
from jackettwin.identification import Examination, IdentificationSettings, examine
from jackettwin.records import Channel, Record

examine_module = import_module("jackettwin.identification.examination")
SETTINGS = IdentificationSettings(refine=False)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "jackettwin" / "kept"


@pytest.fixture
def record() -> Record:
    """A damped oscillator under noise, 200 s at 10 Hz."""
    rng, n = np.random.default_rng(4), 2000
    x = np.zeros(n)
    w, z = 2 * np.pi * 0.5 / 10.0, 0.02
    for k in range(2, n):
        x[k] = 2 * np.exp(-z * w) * np.cos(w) * x[k - 1] - np.exp(-2 * z * w) * x[k - 2] + rng.normal()
    data = np.vstack([x, 0.5 * x]) + 0.1 * rng.normal(size=(2, n))
    return Record(data, 10.0, (Channel("a"), Channel("b")), name="r")


def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that grows with every identification."""
    calls: list[str] = []
    identify = examine_module.identify

    def counting(record: Record, *rest: object, **how: object) -> object:
        calls.append(record.name)
        return identify(record, *rest, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(examine_module, "identify", counting)
    return calls


def again(record: Record, **how: bool) -> Examination:
    return examine(record, SETTINGS, keep=keeping(**how))


def test_a_second_run_gives_the_same_and_identifies_nothing(
    record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = counted(monkeypatch)
    first, second = again(record), again(record)
    assert calls == ["r"]
    assert encode(second.identification) == encode(first.identification)
    assert len(second.identification.stabilisation.order)
    assert again(record, fresh=True).identification.modes
    assert calls == ["r", "r"]


def test_what_changes_is_identified_again(record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = counted(monkeypatch)
    again(record)
    again(replace(record, data=record.data * 1.001))
    again(replace(record, name="s"))
    examine(record, SETTINGS.model_copy(update={"highest_frequency_hz": 2.0}), keep=keeping())
    monkeypatch.setattr(module, "_code", lambda: "another")
    again(record)
    assert len(calls) == 5


def test_a_damaged_or_forbidden_cache_does_no_harm(
    record: Record, folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    calls = counted(monkeypatch)
    again(record)
    (file,) = folder.glob("*.json")
    file.write_text("{")
    again(record)
    assert len(calls) == 2
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert again(record).identification.modes


def test_the_oldest_go(record: Record, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    again(record)
    (old,) = folder.glob("*.json")
    time.sleep(0.02)  # files are told apart by their times
    again(replace(record, name="s"))
    monkeypatch.setattr(module, "MOST_BYTES", int(1.5 * old.stat().st_size))
    keeping()
    assert not old.exists()
    assert len(list(folder.glob("*.json"))) == 1


def test_a_relative_cache_home_is_not_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert cache_folder() == Path.home() / ".cache" / "jackettwin"
