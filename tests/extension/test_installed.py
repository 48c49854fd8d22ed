"""A package adds one of each kind: installed by pip, used by commands, reports and the API."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.service.servers import Server

from jackettwin.data import __file__ as data_file
from jackettwin.records import read_record

ENTRIES = """[jackettwin.readers]
xyz = other_kinds:FORMAT
[jackettwin.support_laws]
lagging = other_kinds:LAGGING
[jackettwin.identification_methods]
our-own = other_kinds:poles_by_covariances
[jackettwin.soil_curves]
half-as-far = other_kinds:CURVE
[jackettwin.parameters]
guy_wires = other_kinds:PARAMETER
[jackettwin.sensors]
geophone = other_kinds:SENSOR
[jackettwin.causes]
crane = other_kinds:crane_left_behind
"""
METADATA = "Metadata-Version: 2.1\nName: other-kinds\nVersion: 1.0\n"
TWIN = """structure: jacket15
gravity: true
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.183}}
support: {law: lagging}
sensors:
  - {channel: top_x, node: tower_top, direction: [1, 0, 0], quantity: geophone}
  - {channel: top_y, node: tower_top, direction: [0, 1, 0], quantity: geophone}
records: [r.xyz]
identification: {method: our-own}
update: {laws: [lagging], parameters: [guy_wires], particles: 20, starts: 1, damping_of: all}
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the package from its wheel."""
    folder = tmp_path_factory.mktemp("installed")
    wheel, info = folder / "other_kinds-1.0-py3-none-any.whl", "other_kinds-1.0.dist-info"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.write(Path(__file__).with_name("other_kinds.py"), "other_kinds.py")
        archive.writestr(f"{info}/METADATA", METADATA)
        archive.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr(f"{info}/entry_points.txt", ENTRIES)
        archive.writestr(f"{info}/RECORD", "")
    target = folder / "site"
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-index",
        "--no-deps",
        "--target",
        str(target),
    ]
    subprocess.run([*pip, str(wheel)], check=True)
    return target


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A twin, and five minutes of a shipped record in the format of the other logger."""
    folder = tmp_path_factory.mktemp("twin")
    record = read_record(Path(data_file).parent / "records" / "pile_U12_s301.parquet").of_quantity(
        "acceleration"
    )
    (x, y) = (record.data[next(i for i, c in enumerate(record.channels) if c.direction[k])] for k in range(2))
    head = {"names": ["top_x", "top_y"], "rate_hz": record.sample_rate_hz}
    samples = np.stack([x, y])[:, : int(300 * record.sample_rate_hz)].astype("<f4")
    (folder / "r.xyz").write_bytes(json.dumps(head).encode() + b"\n" + samples.tobytes())
    (folder / "twin.yaml").write_text(TWIN)
    return folder


def with_package(site: Path) -> str:
    """Return PYTHONPATH of an environment that has the package."""
    return os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])


def command(site: Path, *words: str | Path) -> subprocess.CompletedProcess[str]:
    """Run a command in that environment."""
    return subprocess.run(
        [sys.executable, "-m", "jackettwin", *map(str, words)],
        capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": with_package(site)},
    )  # fmt: skip


def run(site: Path, *words: str | Path) -> Any:
    """Return the JSON of a command."""
    done = command(site, *words, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def ran(site: Path, folder: Path) -> tuple[dict[str, Any], str]:
    """What ``run`` answers of the twin that uses everything, and the text of its report."""
    document = run(site, "run", folder / "twin.yaml", "--out", folder / "out")
    return document, (folder / "out" / "report.html").read_text("utf-8")


def test_a_support_law_by_command(site: Path) -> None:
    """It is Kelvin and Voigt's in other parameters: the same modes."""
    own = run(site, "modes", "jacket15", "--support", "lagging:k=2.5e9,tau_s=0.304", "--number", "4")
    known = run(site, "modes", "jacket15", "--support", "kelvin-voigt:k=2.5e9,c=7.6e8", "--number", "4")
    for key in ("frequency_hz", "damping_ratio"):
        ours, theirs = ([mode[key] for mode in found["modes"]] for found in (own, known))
        np.testing.assert_allclose(ours, theirs, rtol=1e-9)


def test_a_support_law_in_updating_and_report(site: Path, ran: tuple[dict[str, Any], str]) -> None:
    document, page = ran
    assert [update["law"] for update in document["updates"]] == ["lagging"]
    assert {"k", "tau_s"} <= set(document["updates"][0]["parameters"])
    assert "lagging" in page and "a spring whose force comes late" in page


def test_a_parameter_in_updating_and_report(ran: tuple[dict[str, Any], str]) -> None:
    document, page = ran
    known = document["updates"][0]["parameters"]["guy_wires"]
    assert 1e3 < known["value"] < 1e7 and known["unit"] == "N/m"
    assert "guy_wires" in page


def test_a_reader_a_sensor_and_a_method_lead_to_modes(site: Path, ran: tuple[dict[str, Any], str]) -> None:
    document, _ = ran
    first = [mode for mode in document["modes"] if mode["label"].endswith("_1")]
    assert first and all(
        0.15 < mode["frequency_hz"] < 0.2 for mode in first if "torsion" not in mode["label"]
    )


def test_a_method_by_option_in_the_comparison_and_its_report(site: Path, folder: Path) -> None:
    page = folder / "compared.html"
    options = ("--method", "our-own", "--compare", "--report", page)
    found = run(site, "identify", folder / "r.xyz", *options)
    assert min(abs(mode["frequency_hz"] - 0.18) for mode in found["modes"]) < 0.02
    assert "our-own" in page.read_text("utf-8")


def test_a_soil_curve_by_command_and_on_its_page(site: Path, folder: Path) -> None:
    own = (Path(data_file).parent / "foundations" / "jacket15.yaml").read_text("utf-8")
    (folder / "ground.yaml").write_text(
        own.replace("{sand_tz: rp2a}", "{sand_tz: rp2a, sand_py: half-as-far}")
    )
    (folder / "usual.yaml").write_text(own)
    page = folder / "soil.html"
    stiff = run(site, "soil", folder / "ground.yaml", "--out", page)
    usual = run(site, "soil", folder / "usual.yaml", "--out", folder / "usual.html")
    ours, theirs = (np.array(one["head_stiffness"])[0, 0] for one in (stiff, usual))
    assert ours > 1.001 * theirs
    assert "half-as-far" in page.read_text("utf-8")


def test_a_cause_of_a_change_by_command_and_on_its_page(site: Path, folder: Path) -> None:
    """Both first modes lose 1 %, as under more mass at the top."""
    rng, days = np.random.default_rng(3), np.arange(0.0, 130.0, 0.25)
    rows = ["time,label,frequency_hz,damping_ratio"]
    for day in days:
        time = np.datetime64("2024-03-01", "s") + np.timedelta64(int(86400 * day), "s")
        for label, f in (("side_side_1", 0.1832), ("fore_aft_1", 0.1859), ("torsion_1", 0.572)):
            seen = f * np.exp(0.002 * rng.standard_normal()) * (0.99 if day > 100 and f < 0.2 else 1.0)
            rows.append(f"{time}Z,{label},{seen:.6f},0.012")
    (folder / "modes.csv").write_text("\n".join(rows))
    options = ("--structure", "jacket15", "--baseline-days", "90", "--out", folder / "watched")
    found = run(site, "watch", folder / "modes.csv", *options)
    named = {cause["cause"] for alarm in found["alarms"] for cause in alarm["causes"]}
    assert "a crane left on the top" in named
    assert "a crane left on the top" in (folder / "watched" / "report.html").read_text("utf-8")


def test_an_unknown_name_is_answered_with_what_the_package_adds(site: Path, folder: Path) -> None:
    law = command(site, "update", "thesis_table_6_1", "--law", "late")
    method = command(site, "identify", folder / "r.xyz", "--method", "ours")
    for done, added in ((law, "lagging"), (method, "our-own")):
        assert done.returncode == 2 and added in done.stderr
    assert "|our-own" in "".join(command(site, "identify", "--help").stdout.split())


def test_all_of_them_by_the_api(
    site: Path, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A server in the same environment observes a record in the other logger's format by the other method."""
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    )
    run(site, "asset", "add", "wtg", folder / "twin.yaml", "--store", tmp_path / "store")
    with Server(tmp_path / "store", "--workers", "1") as server:
        said = json.dumps({"start_utc": "2025-03-01T12:00:00Z"})
        assert server.post("r.xyz", (folder / "r.xyz").read_bytes(), said).status_code in (200, 202)
        server.wait_until_observed(1)
        modes = server.get("/api/v1/assets/wtg/modes").json()["items"]
        assert any(0.15 < mode["frequency_hz"] < 0.2 for mode in modes)
        twin = known_twin(server)["parameters"]
        assert twin["law"] == "lagging" and {"k", "tau_s", "guy_wires"} <= set(twin["parameters"])


def known_twin(server: Server, seconds: float = 600.0) -> dict[str, Any]:
    """Return what the API says of the supports, once it is known."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found: dict[str, Any] = server.get("/api/v1/assets/wtg/twin").json()
        if found["parameters"]["law"]:
            return found
        time.sleep(1.0)
    raise TimeoutError(str(found))
