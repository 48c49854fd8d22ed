"""``jackettwin user``: users of a server and their rights."""

from __future__ import annotations

import sys
from datetime import UTC, datetime

import click

from jackettwin.cli.console import CommandGroup, Reply, answers, say, say_all
from jackettwin.cli.store_options import StorePlace, store_options
from jackettwin.errors import require


@click.group("user", cls=CommandGroup)
def user_command() -> None:
    """Manage the users of a server.

    Once there is a user, everybody must log in.
    """


@user_command.command("add")
@click.argument("name")
@click.option("--role", required=True, type=click.Choice(["viewer", "engineer", "admin"]))
@click.option("--password-stdin", is_flag=True, help="Read the password from standard input.")
@click.option("--no-password", is_flag=True, help="The user logs in by OIDC or a proxy only.")
@click.option(
    "--assets",
    help="Turbines that the user may see, separated by commas, groups as @NAME; default: all, also later "
    "ones.",
)
@click.option("--until", type=click.DateTime(["%Y-%m-%d"]), help="UTC day on which the user's rights end.")
@answers
@store_options
def add_user(
    name: str,
    role: str,
    password_stdin: bool,
    no_password: bool,
    assets: str | None,
    until: datetime | None,
    at: StorePlace,
) -> Reply:
    """Add the user NAME, or change role, password and rights of an existing one."""
    require(
        password_stdin or no_password or sys.stdin.isatty(),
        "there is no terminal to enter it",
        field="password",
        remedy="give it on standard input, with --password-stdin",
    )
    engine = at.open(make=True)
    from jackettwin.service.web.auth import in_words
    from jackettwin.store import note_down, rights, writing
    from jackettwin.store.people import User, add_user as keep

    ends, now = None if until is None else until.replace(tzinfo=UTC), datetime.now(UTC)
    password = "" if no_password else _asked_hash(password_stdin)
    with writing(engine) as connection:
        scope = None if assets is None else rights.checked_scope(connection, _listed(assets))
        user = User(name, role, password, now, scope=scope, expires_utc=ends, password_utc=now)
        keep(connection, user)
        note_down(connection, "command line", "user add", name, in_words(user), now)
    said = {"user": name, "role": role, "assets": scope, "expires_utc": ends and ends.isoformat()}
    return Reply(said, lambda: say(f"{name} is {in_words(user)}; from now on everybody must log in"))


def _asked_hash(password_stdin: bool) -> str:
    from jackettwin.service.web.auth import hashed

    if password_stdin:
        return hashed(sys.stdin.readline().rstrip("\n"))
    return hashed(click.prompt("password", hide_input=True, confirmation_prompt=True))


def _listed(names: str) -> list[str]:
    return [name.strip() for name in names.split(",") if name.strip()]


@user_command.command("list")
@answers
@store_options
def list_users(at: StorePlace) -> Reply:
    """List the users with their rights and expiry."""
    engine = at.open()
    from jackettwin.service.web.auth import in_words
    from jackettwin.store import people, reading

    with reading(engine) as connection:
        found = people.list_users(connection)
    rows = [
        {
            "user": u.name,
            "role": u.role,
            "assets": u.scope,
            "expires_utc": u.expires_utc and u.expires_utc.isoformat(),
        }
        for u in found
    ]
    return Reply({"users": rows}, lambda: say_all([f"{u.name}  {in_words(u)}" for u in found]))


@user_command.command("remove")
@click.argument("name")
@answers
@store_options
def remove_user(name: str, at: StorePlace) -> Reply:
    """Remove the user NAME; all sessions and tokens end at once."""
    engine = at.open()
    from jackettwin.store import people, writing

    with writing(engine) as connection:
        people.known_user(connection, name)
        people.remove_user(connection, name)
        people.note_down(connection, "command line", "user remove", name, "ok", datetime.now(UTC))
    return Reply({"user": name, "removed": True}, lambda: say(f"{name} is removed"))
