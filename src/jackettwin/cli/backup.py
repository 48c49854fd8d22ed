"""``jackettwin backup``: a whole store in one file."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import Reply, answers, messages, say
from jackettwin.cli.store_options import StorePlace, database_option


@click.command("backup")
@click.argument("store", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--since",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="An earlier backup: what is large and stands there is left out here.",
)
@database_option
@answers
def backup_command(store: Path, file: Path, since: Path | None, database: str | None) -> Reply:
    """Write everything of STORE into FILE, while it is served.

    The file is written completely or not at all, whether or not the store is being served.
    """
    engine = StorePlace(store, database).open()
    from jackettwin.store.backup import backup

    messages.print("writing tables and samples …")
    counts = backup(engine, store, file, since)
    return Reply(
        {"file": str(file), "tables": counts},
        lambda: say(f"{file}: {counts['records']} records, {counts['observations']} observations"),
    )
