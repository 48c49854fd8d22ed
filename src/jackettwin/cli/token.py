"""``jackettwin token``: tokens with which machines log in."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import click

from jackettwin.cli.console import CommandGroup, Reply, answers, say, say_all
from jackettwin.cli.store_options import StorePlace, store_options


def now() -> datetime:
    """Return the time."""
    return datetime.now(UTC)


@click.group("token", cls=CommandGroup)
def token_command() -> None:
    """Manage the tokens with which machines log in."""


@token_command.command("add")
@click.argument("user")
@click.option("--label", default="", help="Purpose of the token.")
@click.option("--days", default=365, show_default=True, type=click.IntRange(1, 3650))
@answers
@store_options
def add_token(user: str, label: str, days: int, at: StorePlace) -> Reply:
    """Create a token with the role of USER; it is shown only once."""
    engine = at.open()
    from jackettwin.service.web.auth import new_grant
    from jackettwin.store import note_down, writing
    from jackettwin.store.people import known_user

    made = now()
    with writing(engine) as connection:
        known_user(connection, user)
        note_down(connection, "command line", "token add", f"{user}/{label}", "ok", made)
        secret, _ = new_grant(connection, user, "token", label, made, timedelta(days=days))
    ends = (made + timedelta(days=days)).isoformat()
    return Reply({"token": secret, "user": user, "expires_utc": ends}, lambda: say(secret))


@token_command.command("list")
@answers
@store_options
def list_tokens(at: StorePlace) -> Reply:
    """List the tokens with user, label and expiry.

    Their secrets are not stored.
    """
    engine = at.open()
    from jackettwin.store import people, reading

    with reading(engine) as connection:
        found = people.list_tokens(connection)
    times = ("created_utc", "expires_utc")
    rows = [{**vars(t), **{name: getattr(t, name).isoformat() for name in times}} for t in found]
    lines = [f"{t.user}  {t.label or '-'}  until {t.expires_utc:%Y-%m-%d}" for t in found]
    return Reply({"tokens": rows}, lambda: say_all(lines))


@token_command.command("revoke")
@click.argument("user")
@click.option("--label", help="Only tokens with this label; default: all, and open sessions.")
@answers
@store_options
def revoke_tokens(user: str, label: str | None, at: StorePlace) -> Reply:
    """Revoke the tokens of USER at once.

    To replace a token, create the new one first, then revoke the old one by its label.
    """
    engine = at.open()
    from jackettwin.store import people, writing

    with writing(engine) as connection:
        people.known_user(connection, user)
        count = people.revoke_tokens(connection, user, label)
        people.note_down(connection, "command line", "token revoke", f"{user}/{label or '*'}", "ok", now())
    return Reply({"user": user, "revoked": count}, lambda: say(f"{count} revoked"))
