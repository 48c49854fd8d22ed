"""What holds of every command: JSON, help, a line in the README; output goes to out/ unless named."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.cli import main

README = Path(__file__).parents[2] / "README.md"


@pytest.mark.parametrize("name", sorted(main.commands))
def test_every_command_speaks_json_and_says_what_it_does(name: str) -> None:
    options = {option for p in main.commands[name].params for option in p.opts}
    assert "--json" in options
    assert main.commands[name].help


def test_the_readme_lists_every_command_and_no_other() -> None:
    listed = re.findall(r"^\| `([a-z-]+)", README.read_text(), re.MULTILINE)
    assert set(listed) == set(main.commands)


def test_the_commands_of_the_readme_name_real_options() -> None:
    for line in re.findall(r"^\$ jackettwin (.*)$", README.read_text(), re.MULTILINE):
        name, *words = line.split()
        options = {option for p in main.commands[name].params for option in p.opts}
        assert {word for word in words if word.startswith("--")} <= options, line


def test_a_page_goes_to_out_and_json_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["view", "jacket15", "--modes", "2", "--subdivide", "1", "--json"])
    assert done.exit_code == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["page"] == "out/jacket15.html"
    assert Path(said["page"]).exists()
    assert len(said["motions"]) == 2
