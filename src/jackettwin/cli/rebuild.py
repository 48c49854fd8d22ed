"""``jackettwin rebuild``: states again from what is stored."""

from __future__ import annotations

from datetime import datetime

import click

from jackettwin.cli.console import Reply, answers, messages, say
from jackettwin.cli.store_options import StorePlace, store_options


@click.command("rebuild")
@click.option("--asset", help="Only of this one; default: all.")
@click.option("--from", "since", type=click.DateTime(["%Y-%m-%d"]), help="From this UTC day on.")
@click.option("--observe", is_flag=True, help="Observe the raw records again as well; a server does it.")
@answers
@store_options
def rebuild_command(asset: str | None, since: datetime | None, observe: bool, at: StorePlace) -> Reply:
    """Make the states again from observations or raw records.

    They come from the stored observations, or with --observe from the raw records.
    """
    engine = at.open()
    from jackettwin.service import rebuild

    document = rebuild(engine, at.folder, asset, since, observe=observe, progress=messages.print)
    return Reply(
        document, lambda: say(f"{document['days']} days made again, {document['queued']} records queued")
    )
