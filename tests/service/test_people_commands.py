"""Users and tokens from the command line, as an operator changes them beside a running server."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from click.testing import CliRunner

from jackettwin.cli.main import main


def ran(store: Path, *words: str, given: str = "", code: int = 0) -> Any:
    found = CliRunner().invoke(main, [*words, "--store", str(store), "--json"], input=given)
    assert found.exit_code == code, found.output
    return json.loads(found.stdout) if code == 0 else found.output


def test_a_token_is_changed_without_a_moment_without_one(tmp_path: Path) -> None:
    password = "three small words\n"
    ran(tmp_path, "user", "add", "anna", "--role", "admin", "--password-stdin", given=password)
    ran(tmp_path, "user", "add", "logger", "--role", "engineer", "--password-stdin", given=password)
    for label in ("2025", "2026"):
        assert len(ran(tmp_path, "token", "add", "logger", "--label", label)["token"]) > 30
    assert [t["label"] for t in ran(tmp_path, "token", "list")["tokens"]] == ["2025", "2026"]
    assert ran(tmp_path, "token", "revoke", "logger", "--label", "2025") == {"user": "logger", "revoked": 1}
    assert [t["label"] for t in ran(tmp_path, "token", "list")["tokens"]] == ["2026"]
    assert ran(tmp_path, "user", "remove", "logger") == {"user": "logger", "removed": True}
    assert ran(tmp_path, "token", "list") == {"tokens": []}


def test_who_is_not_there_is_an_error_of_input(tmp_path: Path) -> None:
    password = "three small words\n"
    ran(tmp_path, "user", "add", "anna", "--role", "viewer", "--password-stdin", given=password)
    for words in (("user", "remove", "ana"), ("token", "revoke", "ana"), ("token", "add", "ana")):
        assert "no such user" in ran(tmp_path, *words, code=2)


def test_without_a_terminal_nobody_is_asked(tmp_path: Path) -> None:
    assert "--password-stdin" in ran(tmp_path, "user", "add", "anna", "--role", "viewer", code=2)


def test_a_question_that_is_denied_is_no_fault_of_ours(tmp_path: Path) -> None:
    (tmp_path / "twin.yaml").write_text("structure: jacket15\n")
    ran(tmp_path, "asset", "add", "wtg", str(tmp_path / "twin.yaml"))
    assert "nothing was changed" in ran(tmp_path, "asset", "archive", "wtg", given="n\n", code=130)
