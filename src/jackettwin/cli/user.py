"""``jackettwin user``: who may use a server."""

from __future__ import annotations

import sys
from datetime import UTC, datetime

import click

from jackettwin.cli.console import CommandGroup, Reply, answers, say
from jackettwin.cli.store_options import StorePlace, store_options
from jackettwin.errors import require


@click.group("user", cls=CommandGroup)
def user_command() -> None:
    """Manage the users of a server.

    With the first one, everybody must log in.
    """


@user_command.command("add")
@click.argument("name")
@click.option("--role", required=True, type=click.Choice(["viewer", "engineer", "admin"]))
@click.option("--password-stdin", is_flag=True, help="Read the password from standard input.")
@answers
@store_options
def add_user(name: str, role: str, password_stdin: bool, at: StorePlace) -> Reply:
    """Add the user NAME, or give one another role and password."""
    require(
        password_stdin or sys.stdin.isatty(),
        "there is no terminal to ask for it on",
        field="password",
        remedy="give it on standard input, with --password-stdin",
    )
    engine = at.open(make=True)
    from jackettwin.service.web.auth import hashed
    from jackettwin.store import note_down, writing
    from jackettwin.store.people import User, add_user as keep

    password = (
        sys.stdin.readline().rstrip("\n")
        if password_stdin
        else click.prompt("password", hide_input=True, confirmation_prompt=True)
    )
    user = User(name, role, hashed(password), datetime.now(UTC))
    with writing(engine) as connection:
        keep(connection, user)
        note_down(connection, "command line", "user add", name, role, user.created_utc)
    return Reply(
        {"user": name, "role": role}, lambda: say(f"{name} is {role}; from now on everybody logs in")
    )


@user_command.command("remove")
@click.argument("name")
@answers
@store_options
def remove_user(name: str, at: StorePlace) -> Reply:
    """Remove the user NAME; sessions and tokens end at once."""
    engine = at.open()
    from jackettwin.store import people, writing

    with writing(engine) as connection:
        people.known_user(connection, name)
        people.remove_user(connection, name)
        people.note_down(connection, "command line", "user remove", name, "ok", datetime.now(UTC))
    return Reply({"user": name, "removed": True}, lambda: say(f"{name} is removed"))
