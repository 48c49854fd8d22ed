"""``jackettwin backup``: a whole store in one file."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import messages, output, print_json
from jackettwin.cli.store_options import database_option, opened


@click.command("backup")
@click.argument("store", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@database_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def backup_command(store: Path, file: Path, database: str | None, as_json: bool) -> None:
    """Write everything of STORE into FILE, while it is served or not; whole or not at all."""
    engine = opened(store, database)
    from jackettwin.store.backup import backup

    messages.print("writing tables and samples …")
    counts = backup(engine, store, file)
    if as_json:
        print_json({"file": str(file), "tables": counts})
    else:
        output.print(f"{file}: {counts['records']} records, {counts['observations']} observations")
