"""``jackettwin restore``: a store from its backup."""

from __future__ import annotations

import shutil
from pathlib import Path

import click

from jackettwin.cli.console import messages, output, print_json
from jackettwin.cli.store_options import database_option, needs_service, opened


@click.command("restore")
@click.argument("file", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("store", type=click.Path(path_type=Path, file_okay=False))
@database_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def restore_command(file: Path, store: Path, database: str | None, as_json: bool) -> None:
    """Fill the empty STORE from a backup FILE; whole or not at all."""
    needs_service()
    made = not store.exists()
    engine = opened(store, database, make=True)
    from jackettwin.store.backup import restore

    messages.print("reading tables and samples …")
    try:
        counts = restore(file, engine, store)
    except BaseException:
        engine.dispose()
        if made:
            shutil.rmtree(store)
        raise
    if as_json:
        print_json({"store": str(store), "tables": counts})
    else:
        output.print(f"{store}: {counts['records']} records, {counts['observations']} observations")
