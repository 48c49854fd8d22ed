"""``jackettwin explore``: any twin, any law, a structure alone; what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli.main import main

TWIN = "thesis_table_6_1"


def run(*arguments: str) -> object:
    return CliRunner().invoke(main, ["explore", *arguments])


def test_a_twins_law_as_json_and_page(tmp_path: Path) -> None:
    """The thesis's simplex from its own second point, figures 8.2 to 8.6 in one."""
    page = tmp_path / "kv.html"
    result = run(
        TWIN, "--law", "kelvin-voigt", "--method", "nelder-mead", "--start", "k=1.1e8,c=1e12",
        "--starts", "2", "--grid", "9", "--modes", "1,4", "--along", "c", "--out", str(page), "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert [mode["mode"] for mode in document["modes"]] == [1, 4]
    # a stiffer foot lifts the first mode and damps it less; a stronger dashpot damps it more
    first = document["modes"][0]
    assert first["frequency_sensitivity"]["k"] > 0.0 > first["damping_sensitivity"]["k"]
    assert first["damping_sensitivity"]["c"] > 0.0
    assert document["largest_difference_from_central_differences"] < 1e-7
    (locus,) = document["loci"]
    assert locus["parameter"] == "c" and locus["values"][0] == pytest.approx(1e4)
    branch = locus["branches"][0]
    assert branch["most_damping_ratio"] == max(branch["damping_ratio"]) < 0.016
    assert np.shape(document["surface"]["cost"]) == (9, 9)
    assert np.min(document["surface"]["cost"]) > document["solutions"][0]["cost"]
    assert [path["start"]["k"] for path in document["paths"]][0] == pytest.approx(1.1e8)
    assert document["paths"][0]["fate"] == "solution"
    text = page.read_text("utf-8")
    for heading in ("Ends of the searches", "Shape of the cost", "Sensitivity of the modes", "Root locus"):
        assert heading in text


def test_a_structure_alone_has_modes_and_no_cost(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    result = run(
        "jacket15", "--support", "springpot:k=3e9,alpha=0.1", "--rayleigh", "0.01,0.1832", "--modes", "1,2",
        "--out", str(page), "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["law"] == "springpot" and document["surface"] is None and document["paths"] == []
    assert [locus["parameter"] for locus in document["loci"]] == ["k", "alpha"]
    assert "Shape of the cost" not in page.read_text("utf-8")


def test_tables_name_the_point_and_every_parameter(tmp_path: Path) -> None:
    result = run(TWIN, "--at", "k=3e9", "--starts", "1", "--grid", "5", "--out", str(tmp_path / "page.html"))
    assert result.exit_code == 0, result.output
    for words in (
        "solution 1",
        "∂ ln f/∂ ln θ",
        "largest damping",
        "How far can c change each mode",
        "wrote",
    ):
        assert words in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("jacket15",), "is a structure, not a twin"),
        (("nowhere",), "no such twin"),
        ((TWIN, "--law", "zenner"), "did you mean 'zener'"),
        ((TWIN, "--along", "kk"), "no such parameter"),
        ((TWIN, "--over", "k"), "not two parameters"),
        ((TWIN, "--over", "k,k"), "two names"),
        ((TWIN, "--modes", "0"), "--modes"),
        ((TWIN, "--modes", "4000"), "fewer modes"),
        ((TWIN, "--at", "k=1"), "1e+07 to 1e+14 N/m"),
        ((TWIN, "--at", "k"), "not a value"),
        ((TWIN, "--at", "k=1e9,k=2e9"), "given twice"),
        ((TWIN, "--start", "k=nan"), "not a finite number"),
        ((TWIN, "--start", "q=1"), "no such parameter"),
        ((TWIN, "--rayleigh", "0.01,0.2"), "--support"),
        (("jacket15", "--support", "foo:k=1"), "no such law"),
        (("jacket15", "--support", "zener:k0=1e9,c=1e8"), "argument is missing"),
        (("jacket15", "--support", "kelvin-voigt:k=-1,c=1e8"), "out of range"),
        (("jacket15", "--support", "kelvin-voigt:k=1e9,c=1e8", "--at", "k=1e9"), "applies to a twin"),
    ],
)
def test_what_cannot_be_explored_is_refused(arguments: tuple[str, ...], words: str, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    result = run(*arguments, "--starts", "1", "--grid", "5", "--out", str(page))
    assert result.exit_code == 2, result.output
    assert words in result.stderr
    assert not page.exists()
