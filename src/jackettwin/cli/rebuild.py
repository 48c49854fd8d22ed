"""``jackettwin rebuild``: recomputation of states from stored data."""

from __future__ import annotations

from datetime import datetime

import click

from jackettwin.cli.console import Reply, answers, messages, say
from jackettwin.cli.store_options import StorePlace, store_options


@click.command("rebuild")
@click.option("--asset", help="Only this turbine; default: all.")
@click.option("--from", "since", type=click.DateTime(["%Y-%m-%d"]), help="From this UTC day on.")
@click.option("--observe", is_flag=True, help="Also observe the raw records again, which a server does.")
@answers
@store_options
def rebuild_command(asset: str | None, since: datetime | None, observe: bool, at: StorePlace) -> Reply:
    """Recompute the states from observations or raw records.

    Stored observations are used, or with --observe the raw records.
    """
    engine = at.open()
    from jackettwin.service import rebuild

    document = rebuild(engine, at.folder, asset, since, observe=observe, progress=messages.print)
    return Reply(
        document, lambda: say(f"{document['days']} days recomputed, {document['queued']} records queued")
    )
