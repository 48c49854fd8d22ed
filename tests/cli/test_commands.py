"""What holds of every command: JSON, help, a line in the README; output goes to out/ unless named."""

import importlib
import json
import os
import re
import subprocess
import sys
import time
from importlib.resources import files
from pathlib import Path
from threading import Event

import click
import pytest
from click.testing import CliRunner

from jackettwin.cli import console, main

README = Path(__file__).parents[2] / "README.md"
COMMANDS = main.summaries


def command(name: str) -> click.Command:
    found = main.get_command(click.Context(main), name)
    assert found is not None
    return found


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_speaks_json_and_says_what_it_does(name: str) -> None:
    found = command(name)
    for one in found.commands.values() if isinstance(found, click.Group) else (found,):
        assert "--json" in {option for p in one.params for option in p.opts}, one.name
    # the list of commands says what each says of itself
    assert COMMANDS[name] == command(name).get_short_help_str(limit=1000)


def test_a_help_text_loads_no_numerics() -> None:
    """A help text took 1767 modules and 3 CPU-seconds, SciPy's and Numba's among them."""
    code = (
        "import sys; sys.argv = ['jackettwin', '--help']\n"
        "from jackettwin.__main__ import run\n"
        "try: run()\n"
        "except SystemExit: print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.splitlines()[-1].split()
    assert "jackettwin.cli.main" in loaded
    # Python's own, click and rich's console: 172 with Python 3.11
    assert len(loaded) < 250
    assert not {"numpy", "scipy", "numba", "pydantic", "plotly", "pyarrow"} & set(loaded)


def test_no_help_of_a_command_waits_for_the_numerics() -> None:
    """The help of ``run`` took 1.7 CPU-seconds. Some options take their choices from light NumPy modules."""
    code = (
        "import sys, click; from jackettwin.cli import main\n"
        "for name in sys.argv[1:]: main.get_command(click.Context(main), name)\n"
        "print(*sys.modules)"
    )
    names = [name for name in COMMANDS if name != "superelement"]
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True, check=True)
    assert not {"scipy", "numba", "pydantic", "plotly", "pyarrow"} & set(done.stdout.split())


def test_a_command_says_what_it_does_before_it_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """However slow the disk: the line waits for no library."""
    said = Event()

    class Heard:
        lines: list[str] = []

        def print(self, line: str, **_: object) -> None:
            self.lines.append(line)
            said.set()

    monkeypatch.setattr(console, "messages", Heard())
    monkeypatch.setattr(
        console, "import_module", lambda name: said.wait(10.0) and importlib.import_module(name)
    )
    start = time.monotonic()
    assert main.get_command(click.Context(main), "run") is not None
    assert time.monotonic() - start < 5.0  # waits 0.3 s; a machine may be busy
    assert (
        Heard.lines[0]
        == "run: Go from records to modes to updated supports, and report it (loading the program)"
    )


def test_watching_a_table_needs_no_statistics_library() -> None:
    """``scipy.stats`` takes half a second to load."""
    code = "import sys, jackettwin.cli.watch; print('scipy.stats' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False"]


def test_a_slow_command_says_so_at_most_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    lines: list[str] = []
    monkeypatch.setattr(console, "_PATIENCE_S", 0.0)
    monkeypatch.setattr(console, "EVERY_S", 0.0)
    monkeypatch.setattr(console.messages, "print", lambda line, **_: lines.append(line))
    with console._reading_said("run", "Run it."):
        time.sleep(0.3)
    assert lines == ["run: Run it (loading the program)", "still loading the program"]


def test_a_command_without_steps_says_that_it_continues(monkeypatch: pytest.MonkeyPatch) -> None:
    """``modes``, ``check``, ``view`` and others were silent while they computed; steps report themselves."""
    lines: list[str] = []
    monkeypatch.setattr(console, "EVERY_S", 0.05)
    monkeypatch.setattr(console.messages, "print", lambda line, **_: lines.append(line))

    @click.command("modes")
    @console.answers
    def slow() -> console.Reply:
        time.sleep(0.3)
        with console.working("a step"):
            inside.append(len(lines))
            time.sleep(0.2)
            inside.append(len([line for line in lines if "computing" in line]))
        return console.Reply({}, lambda: None)

    inside: list[int] = []
    slow.main(["--json"], prog_name="modes", standalone_mode=False)
    assert lines[0].startswith("modes: computing, ")
    # no line of its own beside those of the step
    assert inside[1] <= inside[0]


def test_the_help_has_the_groups_of_the_readme_and_breaks_no_line() -> None:
    shown = CliRunner().invoke(main, ["--help"], terminal_width=80).stdout
    headings = re.findall(r"^\| \*\*(.*?)\*\*", README.read_text(), re.MULTILINE)
    assert [line[:-1].lower() for line in shown.splitlines() if line.endswith(":")][2:] == headings
    for name, summary in COMMANDS.items():
        assert re.search(rf"^  {name} +{re.escape(summary)}$", shown, re.MULTILINE), name


def test_an_identification_loads_what_it_uses(tmp_path: Path) -> None:
    """It took 3.6 CPU-seconds, 1.4 of them to load 1471 modules; kept before, it loads nothing numerical."""
    record = files("jackettwin.data") / "records" / "pile_U12_s301.parquet"
    code = (
        f"import sys; sys.argv = ['jackettwin', 'identify', {str(record)!r}, '--json']\n"
        "from jackettwin.__main__ import run\n"
        "try: run()\n"
        "except SystemExit: print(*sys.modules)"
    )
    env = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    first, again = (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env)
        for _ in range(2)
    )
    document, _, loaded = first.stdout.rpartition("}\n")
    modules = set(loaded.split())
    rooms = {f"jackettwin.{room}" for room in ("structure", "soil", "loads", "response", "updating")}
    slow = {f"scipy.{part}" for part in ("stats", "signal", "io", "optimize", "cluster", "spatial", "fft")}
    unused = {*slow, "numba", "plotly", "jinja2", "pandas", "pyarrow.compute"}
    assert "jackettwin.identification.automatic" in modules
    assert not modules & (rooms | unused)
    kept, _, loaded = again.stdout.rpartition("}\n")
    assert kept == document
    assert len(loaded.split()) < 250
    assert not {"numpy", "scipy", "numba", "pydantic", "plotly", "pyarrow"} & set(loaded.split())


def test_an_unknown_command_is_bad_input() -> None:
    done = CliRunner().invoke(main, ["mods"])
    assert done.exit_code == 2 and "No such command" in done.stderr
    for words in (["--nonsense", "--json"], ["--json", "--nonsense", "run"], ["mods", "--json"]):
        done = CliRunner().invoke(main, words)
        assert done.exit_code == 2 and "No such" in json.loads(done.stdout)["error"]["message"]


def test_the_readme_lists_every_command_and_no_other() -> None:
    listed = re.findall(r"^\| `([a-z-]+)", README.read_text(), re.MULTILINE)
    assert set(listed) == set(COMMANDS)


def test_the_commands_of_the_readme_name_real_options() -> None:
    for line in re.findall(r"^\$ jackettwin (.*)$", README.read_text(), re.MULTILINE):
        name, *words = line.split()
        options = {option for p in command(name).params for option in p.opts}
        assert {word for word in words if word.startswith("--")} <= options, line


def test_a_page_goes_to_out_and_json_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["view", "jacket15", "--modes", "2", "--subdivide", "1", "--json"])
    assert done.exit_code == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["page"] == "out/jacket15.html"
    assert Path(said["page"]).exists()
    assert len(said["motions"]) == 2
