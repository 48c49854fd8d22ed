"""Damaged files and damaged signals: refused with one clear message, or read and flagged.

Warnings are errors here as everywhere in the tests, so a silent overflow would show too.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record, assess, decimate, detrend, read_record, repair, write_record
from jackettwin.records.readers import formats

DATA = Path(__file__).parent / "data"
WRITABLE = [form.extensions[0] for form in formats() if form.write]


def put_through(record: Record) -> None:
    """Assess, repair, detrend, decimate: an InputError is allowed, nothing else, and no infinity."""
    quality = assess(record)
    assert 0.0 <= quality.score <= 1.0
    try:
        ready = detrend(repair(record, quality))
        ready = decimate(ready, sample_rate_hz=ready.sample_rate_hz / 2)
    except InputError as error:
        assert error.remedy or error.allowed
        return
    assert not np.isinf(ready.data).any()
    assert np.isfinite(ready.data).any()


def damaged(raw: bytes, rng: np.random.Generator) -> bytes:
    """Cut, flip, repeat, drop or overwrite bytes."""
    kind = rng.integers(5)
    a, b = sorted(int(x) for x in rng.integers(0, len(raw), 2))
    if kind == 0:
        return raw[: max(a, 1)]
    if kind == 1:
        flipped = bytearray(raw)
        for at in rng.integers(0, len(raw), 8):
            flipped[at] ^= 1 << int(rng.integers(8))
        return bytes(flipped)
    if kind == 2:
        return raw[:a] + raw[b:] or b"\0"
    if kind == 3:
        return raw[:b] + raw[a:]
    # numbers in headers are small: this one announces two thousand million of anything
    return raw[:a] + struct.pack("<I", 0x7FFFFFFF) + raw[a + 4 :]


def read_or_refuse(path: Path) -> None:
    try:
        record = read_record(path)
    except InputError as error:
        assert str(error.file).startswith(str(path.with_suffix("")))
        return
    put_through(record)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("extension", WRITABLE)
def test_damaged_files_of_ours(extension: str, seed: int, record: Record, tmp_path: Path) -> None:
    rng = np.random.default_rng([seed, WRITABLE.index(extension)])
    path = tmp_path / f"r{extension}"
    write_record(record, path)
    path.write_bytes(damaged(path.read_bytes(), rng))
    read_or_refuse(path)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("name", ["nptdms.tdms", "pyuff_text.uff", "pyuff_binary.uff"])
def test_damaged_files_of_others(name: str, seed: int, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(damaged((DATA / name).read_bytes(), np.random.default_rng([seed, len(name)])))
    read_or_refuse(path)


@pytest.mark.parametrize("seed", range(20))
def test_damaged_descriptions(seed: int, record: Record, tmp_path: Path) -> None:
    write_record(record, tmp_path / "r.parquet")
    beside = tmp_path / "r.json"
    beside.write_bytes(damaged(beside.read_bytes(), np.random.default_rng(seed)))
    read_or_refuse(tmp_path / "r.parquet")


@pytest.mark.parametrize("extension", [e for form in formats() for e in form.extensions])
def test_bytes_without_any_meaning(extension: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    for size in (1, 7, 600, 5000):
        path = tmp_path / f"noise{extension}"
        path.write_bytes(rng.bytes(size))
        read_or_refuse(path)


def holes(y: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return np.where(rng.random(len(y)) < 0.5, np.nan, y)


SIGNALS = {
    "zeros": lambda y, rng: 0.0 * y,
    "constant": lambda y, rng: 0.0 * y + 9.81,
    "nothing": lambda y, rng: np.nan * y,
    "one sample": lambda y, rng: np.where(np.arange(len(y)) == 7, 1.0, np.nan),
    "half missing": holes,
    "every other missing": lambda y, rng: np.where(np.arange(len(y)) % 2, np.nan, y),
    "infinite": lambda y, rng: np.where(rng.random(len(y)) < 0.1, np.inf, y),
    "all infinite": lambda y, rng: np.full(len(y), -np.inf),
    "huge": lambda y, rng: 1e300 * y,
    "one huge": lambda y, rng: np.where(np.arange(len(y)) == 7, 1e308, y),
    "tiny": lambda y, rng: 1e-310 * y,
    "large offset": lambda y, rng: 1e9 + y,
    "two levels": lambda y, rng: np.sign(y),
    "square": lambda y, rng: np.repeat(np.sign(y[::100]), 100)[: len(y)],
    "ramp": lambda y, rng: np.arange(len(y), dtype=float),
    "spikes only": lambda y, rng: (rng.random(len(y)) < 0.01) * 5.0,
    "counter overflow": lambda y, rng: np.arange(len(y)) % 256 - 128.0,
}


@pytest.mark.parametrize("length", [2, 3, 60, 2000])
@pytest.mark.parametrize("kind", SIGNALS)
def test_damaged_signals(kind: str, length: int) -> None:
    """Each signal in one of four channels, and in all of them."""
    rng = np.random.default_rng(length)
    data = rng.normal(size=(4, length))
    channels = tuple(
        Channel(f"acc_{h}_x", height_m=h, direction=(1.0, 0.0, 0.0)) for h in (144.0, 77.0, 41.0, 28.0)
    )
    one = data.copy()
    one[2] = SIGNALS[kind](data[2], rng)
    put_through(Record(one, 20.0, channels, name=kind))
    put_through(Record(np.array([SIGNALS[kind](row, rng) for row in data]), 20.0, channels, name=kind))


def test_absurd_numbers_are_flagged() -> None:
    rng = np.random.default_rng(0)
    data = rng.normal(size=(2, 500))
    data[0, 3], data[0, 9] = np.inf, 1e200
    record = Record(data, 20.0, (Channel("a"), Channel("b")))
    quality = assess(record)
    assert [(f.subject, f.code) for f in quality.findings] == [("a", "gaps"), ("a", "unreadable")]
    assert np.flatnonzero(np.isnan(repair(record, quality).data[0])).tolist() == [3, 9]


HEAD = "time,acc_x [g]\n"
TEXTS = {
    "names alone": HEAD,
    "one row": HEAD + "0,1\n",
    "null bytes": HEAD + "0,\0\n0.1,1\n0.2,3\n",
    "unclosed quote": '"time,acc_x [g]\n0,1\n0.1,2\n',
    "times all missing": HEAD + "nan,1\n" * 30,
    "times that stand still": HEAD + "1.0,1\n" * 30,
    "times that run backwards": HEAD + "".join(f"{30 - k},{k}\n" for k in range(30)),
    "a month too many": HEAD + "2025-13-01T00:00:00,1\n2025-13-01T00:00:01,2\n",
    "numbers beyond all": HEAD + "".join(f"{k},1e400\n" for k in range(30)),
    "nothing but stand-ins": HEAD + "".join(f"{k},-9999\n" for k in range(30)),
    "a page of the web": "<html><body>404</body></html>",
    "a name in another script": "time,加速度_x [g]\n" + "".join(f"{k},{k % 3}\n" for k in range(30)),
    "a thousand channels": ",".join(f"c{i}_x [g]" for i in range(1000)) + "\n" + ("1," * 999 + "2\n") * 30,
    "one name twice": "time,acc_x [g],acc_x [g]\n0,1,2\n1,2,3\n2,3,4\n",
}


@pytest.mark.parametrize("kind", TEXTS)
def test_texts_that_are_hardly_records(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text("# fs: 1\n" + TEXTS[kind], encoding="utf-8")
    read_or_refuse(path)


ARRAYS = {
    "three dimensions": {"data": np.zeros((2, 3, 4)), "fs": 20.0},
    "complex numbers": {"acc_x": 1j * np.ones(50), "fs": 20.0},
    "nothing": {"data": np.zeros((0, 0)), "fs": 20.0},
    "a rate that is none": {"acc_x": np.ones(50), "fs": np.nan},
    "no step": {"acc_x": np.ones(50), "dt": 0.0},
    "unequal lengths": {"a_x": np.ones(50), "b_x": np.ones(49), "fs": 20.0},
    "fewer units than rows": {"data": np.ones((3, 50)), "fs": 20.0, "units": np.array(["g", "g"])},
    "fewer times than samples": {"a_x": np.ones(50), "time": np.arange(40.0)},
    "a broken description": {"data": np.ones((2, 50)), "description": np.array("{")},
}


@pytest.mark.parametrize("kind", ARRAYS)
def test_arrays_that_are_hardly_records(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    np.savez(path, **ARRAYS[kind])
    read_or_refuse(path)
