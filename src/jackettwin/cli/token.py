"""``jackettwin token``: how machines log in."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import click

from jackettwin.cli.console import output, print_json
from jackettwin.cli.store_options import opened, store_options


def now() -> datetime:
    """Return the time."""
    return datetime.now(UTC)


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
    from jackettwin.service.web.auth import new_grant
    from jackettwin.store import writing
    from jackettwin.store.people import known_user, note_down

    at = now()
    with writing(engine) as connection:
        known_user(connection, user)
        note_down(connection, "command line", "token add", f"{user}/{label}", "ok", at)
        secret, _ = new_grant(connection, user, "token", label, at, timedelta(days=days))
    document = {"token": secret, "user": user, "expires_utc": (at + timedelta(days=days)).isoformat()}
    if as_json:
        print_json(document)
    else:
        output.print(secret)


@token_command.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def list_tokens(as_json: bool, store: Path, database: str | None) -> None:
    """List the tokens: whose, what for, and until when; their secrets are not kept."""
    engine = opened(store, database)
    from jackettwin.store import people, reading

    with reading(engine) as connection:
        found = people.list_tokens(connection)
    if as_json:
        times = ("created_utc", "expires_utc")
        rows = [{**vars(t), **{name: getattr(t, name).isoformat() for name in times}} for t in found]
        print_json({"tokens": rows})
        return
    for token in found:
        output.print(f"{token.user}  {token.label or '-'}  until {token.expires_utc:%Y-%m-%d}")


@token_command.command("revoke")
@click.argument("user")
@click.option("--label", help="Only the tokens of this label; default: all of them, and open sessions.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def revoke_tokens(user: str, label: str | None, as_json: bool, store: Path, database: str | None) -> None:
    """End the tokens of USER at once: make the new one before, then end the old one by its label."""
    engine = opened(store, database)
    from jackettwin.store import people, writing

    with writing(engine) as connection:
        people.known_user(connection, user)
        count = people.revoke_tokens(connection, user, label)
        people.note_down(connection, "command line", "token revoke", f"{user}/{label or '*'}", "ok", now())
    if as_json:
        print_json({"user": user, "revoked": count})
    else:
        output.print(f"{count} revoked")
