"""``jackettwin alerts``: messages sent on findings, and failures to send them."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import Reply, answers, say_all
from jackettwin.cli.store_options import StorePlace, store_options


@click.command("alerts")
@click.option("--limit", default=100, show_default=True, type=click.IntRange(1, 100_000), help="Lines.")
@click.option(
    "--try",
    "file",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Alerts file: send a test message by each of its channels, and report which accept it.",
)
@answers
@store_options
def alerts_command(limit: int, file: Path | None, at: StorePlace) -> Reply:
    """List the messages sent on a store's findings, newest first."""
    engine = at.open()
    from jackettwin.store import alerts, reading

    if file is not None:
        from jackettwin.service import tried_channels

        tried = tried_channels(file)
        return Reply({"channels": tried}, lambda: say_all(f"{k}  {v or 'took it'}" for k, v in tried.items()))
    with reading(engine) as connection:
        found = alerts.newest(connection, limit)
    names = ("channel", "key", "state", "tries", "problem")
    rows = [{"due_utc": a.due_utc.isoformat(), **{name: getattr(a, name) for name in names}} for a in found]
    lines = [
        f"{r['due_utc'][:19]}  {r['channel']}  {r['state']}  {r['key']}  {r['problem'] or ''}" for r in rows
    ]
    return Reply({"alerts": rows}, lambda: say_all(lines))
