"""Every tutorial and notebook runs from its first line to its last, in an empty folder."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main

ROOT = Path(__file__).parents[1]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))
BLOCK = re.compile(r"^```(python|console|yaml)\n(.*?)^```", re.MULTILINE | re.DOTALL)

FILE = re.compile(r"# ([\w-]+\.yaml)\n")
"""First line of a block that is a file of the tutorial."""


def blocks(path: Path) -> list[tuple[str, str]]:
    """Return the blocks of code of a page, or of a notebook's cells."""
    if path.suffix == ".md":
        return BLOCK.findall(path.read_text(encoding="utf-8"))
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [("python", "".join(cell["source"])) for cell in cells if cell["cell_type"] == "code"]


@pytest.mark.parametrize("path", [*TUTORIALS, *NOTEBOOKS], ids=lambda p: p.stem)
def test_it_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    found = blocks(path)
    assert found
    for kind, code in found:
        if kind == "yaml":
            name = FILE.match(code)
            if name:
                (tmp_path / name[1]).write_text(code, encoding="utf-8")
            continue
        if kind == "python":
            exec(compile(code, str(path), "exec"), namespace)
            continue
        for line in code.splitlines():
            command = line.removeprefix("$ jackettwin ").split()
            result = CliRunner().invoke(main, command)
            assert result.exit_code == 0, (line, result.output)


def test_there_are_seven_tutorials_and_two_notebooks() -> None:
    assert (len(TUTORIALS), len(NOTEBOOKS)) == (7, 2)
