"""``jackettwin user``: who may use a server."""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path

import click

from jackettwin.cli.console import output, print_json
from jackettwin.cli.store_options import opened, store_options
from jackettwin.errors import InputError


@click.group("user")
def user_command() -> None:
    """Users of a server; with the first one, everybody must log in."""


@user_command.command("add")
@click.argument("name")
@click.option("--role", required=True, type=click.Choice(["viewer", "engineer", "admin"]))
@click.option("--password-stdin", is_flag=True, help="Read the password from standard input.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def add_user(
    name: str, role: str, password_stdin: bool, as_json: bool, store: Path, database: str | None
) -> None:
    """Add the user NAME, or give one another role and password."""
    if not password_stdin and not sys.stdin.isatty():
        raise InputError(
            "there is no terminal to ask for it on",
            field="password",
            remedy="give it on standard input, with --password-stdin",
        )
    engine = opened(store, database, make=True)
    from jackettwin.service.web.auth import hashed
    from jackettwin.store import writing
    from jackettwin.store.people import User, add_user as keep, note_down

    password = (
        sys.stdin.readline().rstrip("\n")
        if password_stdin
        else click.prompt("password", hide_input=True, confirmation_prompt=True)
    )
    user = User(name, role, hashed(password), datetime.now(UTC))
    with writing(engine) as connection:
        keep(connection, user)
        note_down(connection, "command line", "user add", name, role, user.created_utc)
    if as_json:
        print_json({"user": name, "role": role})
    else:
        output.print(f"{name} is {role}; from now on everybody logs in")


@user_command.command("remove")
@click.argument("name")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def remove_user(name: str, as_json: bool, store: Path, database: str | None) -> None:
    """Remove the user NAME; sessions and tokens end at once."""
    engine = opened(store, database)
    from jackettwin.store import people, writing

    with writing(engine) as connection:
        people.known_user(connection, name)
        people.remove_user(connection, name)
        people.note_down(connection, "command line", "user remove", name, "ok", datetime.now(UTC))
        left = people.any_user(connection)
    if as_json:
        print_json({"user": name, "removed": True})
    else:
        nobody = "; nobody is left: who is on this machine may do everything"
        output.print(f"{name} is removed{'' if left else nobody}")
