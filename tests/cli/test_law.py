"""``jackettwin law``: numbers, page, table, refusals."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli.main import main

ZENER = "zener:k0=1.48e6,c=5e4,k1=3.1096e5"


def run(*arguments: str) -> object:
    return CliRunner().invoke(main, ["law", *arguments])


def test_the_thesis_s_oscillator_as_json_page_and_table(tmp_path: Path) -> None:
    """Table 4.1 and (4.16)–(4.18): 0.1836 Hz and a real pole at −6.176 rad/s."""
    page, table = tmp_path / "law.html", tmp_path / "law.csv"
    result = run(
        ZENER, "springpot:k=1.48e6,alpha=0.1,f0=0.18", "--mass", "1.12e6", "--csv", str(table),
        "--out", str(page), "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    zener, springpot = document["laws"]
    motion = zener["free_vibration"]
    assert round(motion["frequency_hz"], 4) == 0.1836 and motion["regime"] == "underdamped"
    assert round(motion["pole_real_rad_s"][-1], 3) == -6.176
    # a springpot loses the same share at every frequency: tan(απ/2)
    np.testing.assert_allclose(springpot["loss_factor"], np.tan(0.05 * np.pi), rtol=1e-9)
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * len(zener["frequency_hz"])
    assert float(rows[3]["storage_n_m"]) == zener["storage_n_m"][3]
    for heading in ("Harmonic motion", "In time", "A mass on it"):
        assert heading in page.read_text("utf-8")
    assert "1.48 MN/m" in page.read_text("utf-8") and "× 10⁶" not in page.read_text("utf-8")


def test_tables_say_the_regime(tmp_path: Path) -> None:
    result = run(
        "kelvin-voigt:k=1,c=2", "kelvin-voigt:k=1,c=4", "--mass", "1", "--out", str(tmp_path / "x.html")
    )
    assert result.exit_code == 0, result.output
    assert "critically damped" in result.stdout and "overdamped" in result.stdout
    assert "0.2679, 3.732" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("foo:k=1",), "no such law"),
        (("zener:k0=1",), "argument is missing"),
        (("maxwell-3:k=1,loss_factor=0.1",), "give f0="),
        (("kelvin-voigt:k=1,c=-1",), "feed energy in"),
        (("elastic:k=0", "--mass", "1"), "without stiffness and damping"),
        (("elastic:k=1", "--mass", "0"), "--mass"),
        (("elastic:k=1", "--mass", "nan"), "--mass"),
        (("elastic:k=1", "--band-hz", "1,1"), "0 < LOW < HIGH"),
        (("elastic:k=1", "--band-hz", "1"), "--band-hz"),
        (("elastic:k=1", "--csv", "/no/where/x.csv"), "no such folder"),
    ],
)
def test_what_is_no_law_is_refused(arguments: tuple[str, ...], words: str, tmp_path: Path) -> None:
    page = tmp_path / "law.html"
    result = run(*arguments, "--out", str(page))
    assert result.exit_code == 2, result.output
    assert words in result.stderr
    assert not page.exists()
