"""``jackettwin audit``: log of the users' actions."""

from __future__ import annotations

import click

from jackettwin.cli.console import Reply, answers, say_all
from jackettwin.cli.store_options import StorePlace, store_options


@click.command("audit")
@click.option("--limit", default=100, show_default=True, type=click.IntRange(1, 100_000), help="Lines.")
@answers
@store_options
def audit_command(limit: int, at: StorePlace) -> Reply:
    """List the actions of users in a store, newest first."""
    engine = at.open()
    from jackettwin.store import people, reading

    with reading(engine) as connection:
        found = people.read_audit(connection, limit)
    rows = [{**vars(line), "time_utc": line.time_utc.isoformat()} for line in found]
    lines = [f"{r['time_utc'][:19]}  {r['who']}  {r['action']}  {r['subject']}  {r['outcome']}" for r in rows]
    return Reply({"audit": rows}, lambda: say_all(lines))
