"""Damaged records through ``identify`` and ``run``: refused in one message, or identified and flagged.

Never a traceback, never NaN in the JSON, never another exit code than 0 and 2.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from click.testing import CliRunner, Result

from jackettwin.cli import main
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record, write_record

from .conftest import Case

RATE_HZ = 20.0
SYSTEM = ModalSystem(
    np.array([0.187, 0.189]), np.array([0.015, 0.015]), np.eye(2), np.eye(2)
)  # the first pair of the frame of ``case``


@pytest.fixture(scope="module")
def clean() -> np.ndarray:
    return simulate(SYSTEM, np.random.default_rng(1), duration_s=300.0, sample_rate_hz=RATE_HZ).data


def put(row: int, value: object) -> Callable[..., np.ndarray]:
    def change(y: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        y[row] = value
        return y

    return change


TIME_S = np.arange(6000) / RATE_HZ
TONES = np.sin(2 * np.pi * 0.8 * TIME_S) + np.sin(2 * np.pi * 1.3 * TIME_S)

REFUSED_SIGNALS: dict[str, tuple[Callable[..., np.ndarray], str]] = {
    "all missing": (lambda y, rng: np.nan * y, "no channel carries a signal"),
    "infinite": (lambda y, rng: np.inf * np.ones_like(y), "no channel carries a signal"),
    "1e300": (lambda y, rng: 1e300 * y, "no channel carries a signal"),
    "1e-300": (lambda y, rng: 1e-300 * y, "no channel carries a signal"),
    "a ramp": (lambda y, rng: np.arange(y.size, dtype=float).reshape(y.shape), "no channel carries a signal"),
    "all constant": (lambda y, rng: 0.0 * y + 9.81, "no channel carries a signal"),
    "zero": (lambda y, rng: 0.0 * y, "no channel carries a signal"),
    "impulse": (lambda y, rng: 0.0 * y + (np.arange(6000) == 500), "no usable vibration channel"),
    "one sample": (lambda y, rng: y[:, :1], "holds no samples"),
    "two samples": (lambda y, rng: y[:, :2], "too short"),
    "a hundred samples": (lambda y, rng: y[:, :100], "no spectral peak"),
    "noise alone": (lambda y, rng: rng.standard_normal(y.shape), "no spectral peak"),
    "nine in ten missing": (
        lambda y, rng: np.where(rng.random(y.shape) < 0.85, np.nan, y), "no usable vibration channel",
    ),
}  # fmt: skip

FLAGGED_SIGNALS: dict[str, tuple[Callable[..., np.ndarray], str]] = {
    "one missing": (put(1, np.nan), "empty"),
    "one constant": (put(0, 9.81), "dead"),
    "one infinite": (lambda y, rng: np.where(np.arange(6000) == 77, np.inf, y), "gaps"),
    "spikes": (lambda y, rng: np.where(rng.random(y.shape) < 0.005, 50 * y.std(), y), "spikes"),
    "clipped": (lambda y, rng: np.clip(y, -y.std(), y.std()), "clipped"),
    "gaps in common": (lambda y, rng: np.where(np.arange(6000) % 1000 < 200, np.nan, y), "gaps"),
    "every other missing": (lambda y, rng: np.where(np.arange(6000) % 2, np.nan, y), "gaps"),
    "drift": (lambda y, rng: y + 1e3 * y.std() * np.linspace(0, 1, 6000) ** 2, "drift"),
    "frozen": (lambda y, rng: np.where((TIME_S > 50) & (TIME_S < 150), y[:, 999:1000], y), "stuck"),
    "growing": (lambda y, rng: y * np.exp(np.linspace(0, 6, 6000)), "unsteady"),
    "tones alone": (lambda y, rng: np.outer([1.0, 0.5], TONES), ""),
    "twice the same": (lambda y, rng: y[[0, 0]], ""),
}
"""With the fault that must be found; what tones and copies need is not a fault."""


def into(*path: str, value: object) -> Callable[[dict], object]:
    def change(record: dict) -> None:
        for key in path[:-1]:
            record = record[key]
        record[path[-1]] = value

    return change


X = ("channels", "top_x")
DESCRIPTIONS: dict[str, tuple[Callable[[dict], object], str]] = {
    "zero rate": (into("sample_rate_hz", value=0), "sample_rate_hz"),
    "negative rate": (into("sample_rate_hz", value=-20), "sample_rate_hz"),
    "rate in words": (into("sample_rate_hz", value="fast"), "sample_rate_hz"),
    "rate true": (into("sample_rate_hz", value=True), "sample_rate_hz"),
    "rate NaN": (into("sample_rate_hz", value=float("nan")), "NaN is not a JSON number"),
    "rate of 1e300": (into("sample_rate_hz", value=1e300), "sample_rate_hz"),
    "no rate": (into("sample_rate_hz", value=None), "sample_rate_hz"),
    "wrong unit": (into(*X, "unit", value="furlong"), "channels.top_x.unit"),
    "no unit": (into(*X, "unit", value=""), "channels.top_x.unit"),
    "wrong quantity": (into(*X, "quantity", value="love"), "channels.top_x.quantity"),
    "unit of another quantity": (into(*X, "quantity", value="velocity"), "channels.top_x.unit"),
    "direction of two": (into(*X, "direction", value=[1, 0]), "channels.top_x.direction"),
    "height in words": (into(*X, "height_m", value="top"), "channels.top_x.height_m"),
    "yaw in words": (into("conditions", value={"yaw_deg": "north"}), "conditions.yaw_deg"),
    "wind in words": (into("conditions", value={"mean_wind_speed_m_s": [5]}), "mean_wind_speed_m_s"),
    "start in words": (into("start_utc", value="yesterday"), "start_utc"),
    "channels in a list": (into("channels", value=["top_x"]), "channels"),
    "channel that is not there": (into("channels", "ghost", value={}), "ghost"),
}  # fmt: skip

HEAD, UNITS = "top_x,top_y", "m/s^2,m/s^2"
STAMPED = ("time," + HEAD, "s," + UNITS)
TEXTS: dict[str, tuple[Callable[[list[str]], str], str]] = {
    "words": (lambda r: "\n".join([HEAD, UNITS, *r[:50], "a,b", *r[50:]]), "line 53, channel top_x"),
    "no rate": (lambda r: "\n".join([HEAD, UNITS, *r]), "sample_rate_hz"),
    "no header": (lambda r: "\n".join(r), "--sample-rate"),
    "a header alone": (lambda r: "# fs: 20\n" + HEAD, "no samples"),
    "twice one name": (lambda r: "\n".join(["# fs: 20", "top_x,top_x", UNITS, *r]), "given twice"),
    "zero rate": (lambda r: "\n".join(["# fs: 0", HEAD, UNITS, *r]), "fs"),
    "wrong units": (lambda r: "\n".join(["# fs: 20", "acc_x,acc_y", "g,parsec", *r]), "channels.acc_y.unit"),
    "time backwards": (
        lambda r: "\n".join([*STAMPED, *(f"{-k / 20},{row}" for k, row in enumerate(r))]),
        "time stamps do not increase",
    ),
    "time that jumps": (
        lambda r: "\n".join(
            [*STAMPED, *(f"{k / 20 + 1e9 * (k > 99)},{row}" for k, row in enumerate(r))]
        ),
        "time stamps jump",
    ),
    "time in strange seconds": (
        lambda r: "\n".join([*STAMPED, *(f"{k * 1e200},{row}" for k, row in enumerate(r))]),
        "no logger's",
    ),
}  # fmt: skip

DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "nothing": lambda raw: b"",
    "magic": lambda raw: b"\0\1\2\3" * 9,
    "a web page": lambda raw: b"<html><body>404</body></html>",
    "an end": lambda raw: raw[: int(0.9 * len(raw))],
}
FORMATS = (".parquet", ".npz", ".h5", ".mat", ".uff", ".tdms", ".out", ".outb")


def signals(case: Case, y: np.ndarray) -> Path:
    case.signals = {"top_x": y[0], "top_y": y[1]}
    case.twin["identification"] = {}
    case.twin["update"] |= {"starts": 2, "particles": 20, "modes": [1, 2]}
    return case.write().with_name("day.parquet")


def identify(path: Path) -> Result:
    return CliRunner().invoke(main, ["identify", str(path), "--json"])


def run(path: Path, out: Path) -> Result:
    twin = yaml.safe_load((path.parent / "twin.yaml").read_text())
    (path.parent / "twin.yaml").write_text(yaml.safe_dump(twin | {"records": [path.name]}))
    return CliRunner().invoke(main, ["run", str(path.parent / "twin.yaml"), "--out", str(out), "--json"])


def refused(path: Path, words: str) -> None:
    """Assert that both commands refuse the record, name the file and say what is wrong."""
    for result in (identify(path), run(path, path.parent / "out")):
        message = result.stderr.replace("\n", " ")
        assert result.exit_code == 2, result.output
        error = json.loads(result.stdout)["error"]
        assert (error["kind"], error["message"] in message) == ("error", True)
        assert error["problem"] in error["message"] and path.stem in error["file"]
        assert path.stem in message
        assert words in message
        assert "internal" not in message
    assert not (path.parent / "out").exists()


def flagged(result: Result) -> dict[str, Any]:
    """Assert that a result is whole; return it."""
    assert result.exit_code == 0, result.output

    def not_json(name: str) -> None:
        raise AssertionError(f"{name} in the JSON")

    document: dict[str, Any] = json.loads(result.stdout, parse_constant=not_json)
    return document


@pytest.mark.parametrize("name", REFUSED_SIGNALS)
def test_signals_that_carry_nothing(name: str, case: Case, clean: np.ndarray) -> None:
    change, words = REFUSED_SIGNALS[name]
    refused(signals(case, change(clean.copy(), np.random.default_rng(3))), words)


@pytest.mark.parametrize("name", FLAGGED_SIGNALS)
def test_signals_with_faults(name: str, case: Case, clean: np.ndarray) -> None:
    change, fault = FLAGGED_SIGNALS[name]
    document = flagged(identify(signals(case, change(clean.copy(), np.random.default_rng(3)))))
    assert not fault or fault in {finding["code"] for finding in document["quality"]["findings"]}
    if name == "tones alone":
        assert document["modes"] == []


def test_samples_that_stand_for_several_are_used_once(case: Case, clean: np.ndarray) -> None:
    document = flagged(identify(signals(case, np.repeat(clean[:, ::10], 10, axis=1))))
    assert any(
        "every sample of every channel is repeated 10 times" in warning for warning in document["warnings"]
    )
    assert not [mode for mode in document["modes"] if mode["status"] == "ok"]


def test_run_goes_through_with_flagged_signals(case: Case, clean: np.ndarray, tmp_path: Path) -> None:
    change, _ = FLAGGED_SIGNALS["spikes"]
    path = signals(case, change(clean.copy(), np.random.default_rng(3)))
    flagged(run(path, tmp_path / "out"))
    assert "of the samples are spikes" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_descriptions(name: str, case: Case, clean: np.ndarray) -> None:
    change, words = DESCRIPTIONS[name]
    change(case.record)
    refused(signals(case, clean), words)


@pytest.mark.parametrize("name", TEXTS)
def test_delimited_text(name: str, case: Case, clean: np.ndarray) -> None:
    make, words = TEXTS[name]
    path = signals(case, clean).with_name("text.csv")
    path.write_text(make([f"{a:.6g},{b:.6g}" for a, b in clean.T]))
    refused(path, words)


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("extension", FORMATS)
def test_files(extension: str, damage: str, case: Case, clean: np.ndarray) -> None:
    path = signals(case, clean).with_name(f"file{extension}")
    if extension in (".tdms", ".out", ".outb"):  # read, not written: anything else is as wrong
        path.write_bytes(clean.tobytes())
    else:
        record = Record(clean, RATE_HZ, (Channel("top_x", node="top"), Channel("top_y", node="top")))
        write_record(record, path)
    path.write_bytes(DAMAGE[damage](path.read_bytes()))
    refused(path, "")


def test_names_that_are_markup(case: Case, clean: np.ndarray) -> None:
    path = signals(case, clean).with_name("names.csv")
    rows = "\n".join(f"{a:.6g},{b:.6g}" for a, b in clean.T)
    path.write_text(f"# fs: 20\nacc_[red]_x,加速度_<b>_y\n{UNITS}\n{rows}")
    document = flagged(identify(path))
    assert set(document["modes"][0]["mode_shape"]) == {"acc_[red]_x", "加速度_<b>_y"}
