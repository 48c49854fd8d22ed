"""A method that an installed package brings: by command, settings file, comparison, report and Python."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from jackettwin.records import Channel, Record, write_record

METHOD = """
from jackettwin.identification import IdentificationSettings, OrderPoles, PreparedRecord
from jackettwin.identification.pole_methods import by_ssi_dat

def era(ready: PreparedRecord, settings: IdentificationSettings) -> list[OrderPoles]:
    return by_ssi_dat(ready, settings)
"""
ENTRY = "[jackettwin.identification_methods]\nera = other_method:era\n"
METADATA = "Metadata-Version: 2.1\nName: other-method\nVersion: 1.0\n"


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a record ``r.npz`` and the package in ``site``, as pip leaves it."""
    folder = tmp_path_factory.mktemp("plugin")
    info = folder / "site" / "other_method-1.0.dist-info"
    info.mkdir(parents=True)
    (folder / "site" / "other_method.py").write_text(METHOD)
    (info / "METADATA").write_text(METADATA)
    (info / "entry_points.txt").write_text(ENTRY)
    rng, n = np.random.default_rng(4), 4000
    x, w, z = np.zeros(n), 2 * np.pi * 0.5 / 10.0, 0.02
    for k in range(2, n):
        x[k] = 2 * np.exp(-z * w) * np.cos(w) * x[k - 1] - np.exp(-2 * z * w) * x[k - 2] + rng.normal()
    data = np.vstack([x, 0.5 * x]) + 0.1 * rng.normal(size=(2, n))
    write_record(Record(data, 10.0, (Channel("a"), Channel("b")), name="r"), folder / "r.npz")
    return folder


def python(place: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(place / "site"), *sys.path])
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        cwd=place,
        env={**os.environ, "PYTHONPATH": path, "XDG_CACHE_HOME": str(place / "cache")},
    )


def identify(place: Path, *arguments: str) -> dict[str, object]:
    done = python(place, "-m", "jackettwin", "identify", "r.npz", "--json", *arguments)
    assert done.returncode == 0, done.stderr
    found: dict[str, object] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("how", ["command", "settings"])
def test_it_is_chosen_like_ours(place: Path, how: str) -> None:
    (place / "settings.yaml").write_text("method: era\n")
    chosen = ["--method", "era"] if how == "command" else ["--settings", "settings.yaml"]
    modes = identify(place, *chosen)["modes"]
    assert {mode["method"] for mode in modes} == {"era"}
    assert any(mode["frequency_hz"] == pytest.approx(0.5, rel=0.01) for mode in modes)


def test_it_is_compared_and_reported(place: Path) -> None:
    """A method of another package ended the report with a KeyError."""
    compared = identify(place, "--compare", "--report", "r.html")["methods"]["modes"]
    assert list(compared) == ["ssi-cov", "ssi-dat", "plscf", "efdd", "bayoma", "era"]
    assert compared["era"][0]["frequency_hz"] == compared["ssi-dat"][0]["frequency_hz"]
    assert "<th>era</th>" in (place / "r.html").read_text().replace(' scope="col"', "")


def test_it_is_used_from_python(place: Path) -> None:
    code = (
        "from jackettwin.identification import IdentificationSettings, identify\n"
        "from jackettwin.records import read_record\n"
        "found = identify(read_record('r.npz'), IdentificationSettings(method='era'))\n"
        "print(*{mode.method for mode in found.modes})\n"
    )
    assert python(place, "-c", code).stdout == "era\n"


def test_the_help_and_a_refusal_name_it(place: Path) -> None:
    assert "|era]" in "".join(python(place, "-m", "jackettwin", "identify", "--help").stdout.split())
    wrong = python(place, "-m", "jackettwin", "identify", "r.npz", "--method", "erb")
    assert wrong.returncode == 2
    assert "'era'" in wrong.stderr
