"""``jackettwin intake``: import of files and folders into a store."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import BAD_INPUT, json_option, messages, print_json, say
from jackettwin.cli.store_options import StorePlace, store_options


@click.command("intake")
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True))
@click.option("--asset", required=True, help="Turbine of the records.")
@click.option("--watch", is_flag=True, help="Continue with new files until Ctrl-C.")
@json_option
@store_options
def intake_command(paths: tuple[Path, ...], asset: str, watch: bool, as_json: bool, at: StorePlace) -> None:
    """Take records from PATHS, files or folders, into a store.

    A server that serves the store observes them.
    """
    engine = at.open()
    from jackettwin.service import Accepted, record_files, take_here, watch_folders

    def take(path: Path) -> Accepted:
        took = take_here(engine, at.folder, asset, path)
        if took.problem is not None:
            remedy = took.problem.get("remedy") or ""
            messages.print(f"{path.name}: refused: {took.problem['detail']}; {remedy}")
        elif not as_json:
            several = f" and {took.records - 1} before it" if took.records > 1 else ""
            say(f"{path.name}: {took.record_id}{several} {'taken' if took.new else 'known already'}")
        return took

    if watch:
        messages.print(f"watching {', '.join(map(str, paths))}; Ctrl-C ends")
        watch_folders(paths, take)
        return
    took = [(path, take(path)) for path in record_files(paths)]
    if as_json:
        print_json({"asset": asset, "files": [{"file": file.name, **vars(one)} for file, one in took]})
    if not took:
        messages.print("there is no file to import")
    refused = sum(one.problem is not None for _, one in took)
    if refused:
        messages.print(f"{refused} of {len(took)} files were refused")
        raise SystemExit(BAD_INPUT)
