"""``jackettwin restore``: recovery of a store from its backup."""

from __future__ import annotations

import shutil
from pathlib import Path

import click

from jackettwin.cli.console import Reply, answers, messages, say
from jackettwin.cli.store_options import StorePlace, database_option


@click.command("restore")
@click.argument("file", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("store", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--earlier",
    multiple=True,
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="A backup that FILE follows, the whole one first; again for each.",
)
@database_option
@answers
def restore_command(file: Path, store: Path, earlier: tuple[Path, ...], database: str | None) -> Reply:
    """Fill the empty STORE from a backup FILE.

    It is filled completely or not at all.
    """
    made = not store.exists()
    engine = StorePlace(store, database).open(make=True)
    from jackettwin.store.backup import restore

    messages.print("reading tables and samples …")
    try:
        counts = restore(file, engine, store, earlier)
    except BaseException:
        engine.dispose()
        if made:
            shutil.rmtree(store)
        raise
    return Reply(
        {"store": str(store), "tables": counts},
        lambda: say(f"{store}: {counts['records']} records, {counts['observations']} observations"),
    )
