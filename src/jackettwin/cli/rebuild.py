"""``jackettwin rebuild``: states again from what is kept."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import click

from jackettwin.cli.console import messages, output, print_json
from jackettwin.cli.store_options import opened, store_options


@click.command("rebuild")
@click.option("--asset", help="Only of this one; default: all.")
@click.option("--from", "since", type=click.DateTime(["%Y-%m-%d"]), help="From this UTC day on.")
@click.option("--observe", is_flag=True, help="Observe the raw records again as well; a server does it.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def rebuild_command(
    asset: str | None, since: datetime | None, observe: bool, as_json: bool, store: Path, database: str | None
) -> None:
    """Make the states again from stored observations, or with --observe from raw records."""
    engine = opened(store, database)
    from jackettwin.service import rebuild

    document = rebuild(engine, store, asset, since, observe=observe, progress=messages.print)
    if as_json:
        print_json(document)
    else:
        output.print(f"{document['days']} days made again, {document['queued']} records queued")
