"""``jackettwin simulate-set``: many records of one asset, in parallel."""

from __future__ import annotations

from pathlib import Path

import click

from jackettwin.cli.console import Reply, answers, progress, say


@click.command("simulate-set")
@click.argument("set_file", metavar="SET", default="dlc64")
@click.option(
    "--out", required=True, type=click.Path(file_okay=False, path_type=Path), help="Folder to write."
)
@click.option("--workers", type=click.IntRange(1, 1024), help="Processes; default one per core.")
@answers
def simulate_set_command(set_file: str, out: Path, workers: int | None) -> Reply:
    """Simulate every case of SET on all cores.

    SET is a shipped name (dlc64) or a YAML file; existing records are not simulated again. The
    command writes a record for each case, and manifest.json with conditions and true modes.
    """
    from jackettwin.simulate import pending_cases, read_set, run_set

    chosen = read_set(set_file)
    pending = pending_cases(chosen, out)
    with progress(len(pending), f"{len(pending)} of {len(chosen.cases)} cases") as step:
        manifest = run_set(chosen, out, workers=workers, step=step)
    said = f"{out}: {len(manifest['cases'])} records, {len(pending)} of them new; manifest.json"
    return Reply(manifest, lambda: say(said))
