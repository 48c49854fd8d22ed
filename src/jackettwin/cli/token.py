"""``jackettwin token``: how machines log in."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import click

from jackettwin.cli.console import output, print_json
from jackettwin.cli.store_options import opened, store_options


@click.group("token")
def token_command() -> None:
    """Tokens with which machines log in."""


@token_command.command("add")
@click.argument("user")
@click.option("--label", default="", help="What it is for.")
@click.option("--days", default=365, show_default=True, type=click.IntRange(1, 3650))
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def add_token(user: str, label: str, days: int, as_json: bool, store: Path, database: str | None) -> None:
    """Make a token with the role of USER; it is shown this once."""
    engine = opened(store, database)
    from jackettwin.errors import InputError
    from jackettwin.service.auth import new_grant
    from jackettwin.store import writing
    from jackettwin.store.people import find_user, list_users

    now = datetime.now(UTC)
    with writing(engine) as connection:
        if find_user(connection, user) is None:
            known = ", ".join(u.name for u in list_users(connection)) or "none yet"
            raise InputError("no such user", field="user", value=user, allowed=known)
        secret, _ = new_grant(connection, user, "token", label, now, timedelta(days=days))
    document = {"token": secret, "user": user, "expires_utc": (now + timedelta(days=days)).isoformat()}
    if as_json:
        print_json(document)
    else:
        output.print(secret)
