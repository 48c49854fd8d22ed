"""The page on the thesis has its 74 rows, and every command, key, file and name on it is real."""

from __future__ import annotations

import json
import re
import shlex
from collections import Counter
from importlib import import_module
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from jackettwin.cli.main import main
from jackettwin.decks import read_structure
from jackettwin.simulate.scenario.files import ScenarioSchema
from jackettwin.twin.schema import TwinSchema

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "verification" / "thesis.md"
TEXT = PAGE.read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in TEXT.splitlines()
    if re.match(r"\| \d+ \|", line)
]
FILES = ("twin", "scenario", "structure")
CODE = [(row[0], code, before) for row in ROWS for before, code in re.findall(r"(\w*) ?`([^`]+)`", row[3])]
KEYS = [one for one in CODE if one[2] in FILES and not one[1].startswith("jackettwin ")]
TWIN: dict[str, Any] = {
    "structure": "jacket15",
    "damping": {"rayleigh": {"ratio": 0.01, "frequency_hz": 0.18}},
}


def test_each_of_the_74_is_there_once_with_its_state() -> None:
    assert [int(row[0]) for row in ROWS] == list(range(1, 75))
    states = Counter(re.split(r"[: ]", row[2])[0] for row in ROWS)
    assert set(states) <= {"works", "in", "missing", "left"}
    # what is lacking is said, and what works is shown
    assert all(row[2].startswith("in part: ") for row in ROWS if row[2].startswith("in"))
    assert all("`" in row[3] or "](" in row[3] for row in ROWS if row[2] != "missing")


@pytest.mark.parametrize(
    "command",
    sorted({code for _, code, _ in CODE if code.startswith("jackettwin ")}),
    ids=lambda text: text[:60],
)
def test_every_command_can_be_given(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parsed with its options, choices and ranges, beside the user's own files; nothing is computed."""
    monkeypatch.chdir(tmp_path)
    _, name, *arguments = shlex.split(command)
    for own in (tmp_path / text for text in arguments if text.endswith((".csv", ".parquet", ".yaml"))):
        own.parent.mkdir(exist_ok=True)
        own.touch()
    found = main.get_command(click.Context(main), name)
    assert found is not None, f"no command {name}"
    found.make_context(name, arguments)


@pytest.mark.parametrize(("row", "text", "kind"), KEYS)
def test_every_key_can_be_written(row: str, text: str, kind: str, tmp_path: Path) -> None:
    given = yaml.safe_load(text)
    if kind == "twin":
        TwinSchema.model_validate({**TWIN, **given})
    elif kind == "scenario":
        ScenarioSchema.model_validate({"structure": "jacket15", **given})
    else:
        name = next(iter(given["sections"]))
        nodes = {
            "nodes": {"a": [0, 0, 0], "b": [0, 0, 9]},
            "members": [{"nodes": ["a", "b"], "section": name}],
        }
        path = tmp_path / "own.yaml"
        path.write_text(yaml.safe_dump({**given, **nodes, "reaction_nodes": ["a"]}))
        assert set(read_structure(path).nodes) == {"a", "b"}


def test_everything_else_that_is_named_is_there() -> None:
    for row, code, kind in CODE:
        if (row, code, kind) in KEYS or code.startswith("jackettwin "):
            continue
        if code.startswith("jackettwin."):
            *module, name = code.split(".")
            while module[-1][0].isupper():
                name = f"{module.pop()}.{name}"
            thing = import_module(".".join(module))
            for part in name.split("."):
                thing = getattr(thing, part)
        elif code.startswith("make "):
            assert re.search(rf"^{code[5:]}:", (ROOT / "Makefile").read_text(), re.MULTILINE), row
        else:
            assert (ROOT / code).exists(), f"row {row}: {code}"


def test_the_rows_from_python_on_an_own_structure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the block computes, beside each other: poles, a planted ground, a pull's decrement."""
    (tmp_path / "own.yaml").write_text((ROOT / "examples" / "three_leg_jacket.yaml").read_text())
    (tmp_path / "piles.yaml").write_text((ROOT / "qualify" / "decks" / "piles.yaml").read_text())
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    done: dict[str, Any] = {}
    exec(compile(block, str(PAGE), "exec"), done)
    poles = np.linalg.eigvals(done["A"])
    lowest = np.sort(np.abs(poles[poles.imag > 0.0]))[: done["true"].eigenvalues.size]
    np.testing.assert_allclose(lowest, np.abs(done["true"].eigenvalues), rtol=1e-6)
    # the targets are those of a Kelvin-Voigt ground, which that law and no other has exactly
    np.testing.assert_allclose(done["fits"][0].best.theta, [1.5e9, 2e7], rtol=1e-4)
    assert [rank.place for rank in done["ranked"](done["fits"])] == [1, 1, 1]
    decrement = done["record"].metadata["decrement"]
    assert decrement["damping_ratio"] == pytest.approx(decrement["pole_damping_ratio"], rel=1e-4)
    here = done["locus"].poles[done["locus"].origin]
    np.testing.assert_allclose(np.abs(here[0]), np.abs(done["true"].eigenvalues[0]), rtol=1e-3)
    assert done["reduced"].M.shape == (18, 18)


def test_the_numbers_of_the_open_questions_are_those_that_verify_computes() -> None:
    from jackettwin.verify.open_questions import fit, ways

    def damping(law: str, **how: bool) -> list[str]:
        return [f"{100 * float(zeta):.2f}" for zeta in fit(law, **how).modes.damping_ratio[[0, 2]]]

    rows = {
        tuple(re.split(r" *\| *", line.strip("| "))[:2]): line
        for line in TEXT.splitlines()
        if line.startswith("| ")
    }
    for law, named in (
        ("kelvin-voigt", "Kelvin–Voigt"),
        ("zener", "Zener"),
        ("maxwell-3",) * 2,
        ("springpot",) * 2,
    ):
        assert damping(law, zeta_4=False)[1] in rows[named, "f, ζ₁"]
    assert damping("zener", zeta_4=True) == ["1.27", "2.81"]
    assert damping("kelvin-voigt", zeta_4=True, free_steel=True) == ["1.27", "2.81"]
    lowest = fit("kelvin-voigt", zeta_4=False).best
    assert f"{lowest.cost:.3g}".replace("e-0", "e-") in TEXT
    assert f"k = {lowest.theta[0] / 1e9:.2f}e9" in TEXT and f"c = {lowest.theta[1] / 1e8:.2f}e8" in TEXT
    fates = {
        law: Counter(path.fate for path in ways(law, "nelder-mead")[2:]) for law in ("kelvin-voigt", "zener")
    }
    assert fates["kelvin-voigt"] == {"solution": 9, "plateau": 7}
    assert fates["zener"] == {"solution": 5, "plateau": 9, "stalled": 2}


def test_every_row_that_verify_checks_holds() -> None:
    """Here, since the searches above are those it tells of."""
    keys = {"id", "source", "quantity", "published", "computed", "relative_error", "tolerance", "ok"}
    result = CliRunner().invoke(main, ["verify", "--json"])
    assert result.exit_code == 0, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert all(set(row) >= keys for row in rows)
    assert sum(row["ok"] is True for row in rows) >= 60
    assert all((row["ok"] is None) == (row["tolerance"] is None) for row in rows)
