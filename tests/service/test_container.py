"""The Containerfile starts what the command line knows, and installs what there is to install."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

from jackettwin.cli.main import main
from jackettwin.cli.serve import serve_command

ROOT = Path(__file__).parents[2]
CONTAINER = (ROOT / "Containerfile").read_text()


def test_the_container_serves_as_the_command_line_does() -> None:
    text = (ROOT / "Containerfile").read_text()
    (entry,), command = (
        json.loads(re.search(rf"^{word} (.*)$", text, re.M)[1]) for word in ("ENTRYPOINT", "CMD")
    )
    assert (entry, command[0]) == ("jackettwin", "serve")
    assert "serve" in main.list_commands(None)
    with serve_command.make_context("serve", command[1:]) as context:
        assert context.params["behind_proxy"] and context.params["host"] == "0.0.0.0"
        assert f"VOLUME {context.params['store']}\n" in CONTAINER
        assert f"EXPOSE {context.params['port']}\n" in CONTAINER


def test_the_container_installs_extras_that_there_are() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = re.search(r"/src\[([\w,]+)\]", CONTAINER)[1].split(",")
    assert set(extras) <= set(project["optional-dependencies"])
    assert f"python:{project['requires-python'].removeprefix('>=')}-slim" in CONTAINER
