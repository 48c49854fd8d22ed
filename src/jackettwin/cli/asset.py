"""``jackettwin asset``: the turbines of a store and their twins."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from rich.table import Table

from jackettwin.cli.console import output, print_json
from jackettwin.cli.store_options import opened, store_options
from jackettwin.errors import InputError


@click.group("asset")
def asset_command() -> None:
    """Turbines of a living twin: add, list, show, adopt, archive, conditions."""


@asset_command.command("add")
@click.argument("name")
@click.argument("twin", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--comment", default="", help="What this version changes.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def add(name: str, twin: Path, comment: str, as_json: bool, store: Path, database: str | None) -> None:
    """Add the turbine NAME with its twin file, and copy in every file that this one names.

    For a NAME that is there already, a new version is added; it counts once it is adopted.
    """
    engine = opened(store, database, make=True)
    from jackettwin.service import add_twin

    document = add_twin(engine, store, name, twin, comment)
    if as_json:
        print_json(document)
    else:
        output.print(f"{name}: version {document['version']}, model {document['model_hash'][:12]}")


@asset_command.command("list")
@click.option("--archived", is_flag=True, help="Those that are archived instead.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def list_(archived: bool, as_json: bool, store: Path, database: str | None) -> None:
    """List the turbines with their status, records and findings."""
    engine = opened(store, database)
    from jackettwin.service.web.catalogue import overview
    from jackettwin.store import reading

    with reading(engine) as connection:
        found = [asset.model_dump(mode="json") for asset in overview(connection, archived=archived)]
    if as_json:
        print_json({"assets": found})
        return
    table = Table("asset", "status", "version", "records", "findings", "latest record (UTC)", box=None)
    for asset in found:
        table.add_row(*(str(v) for v in _row(asset)))
    output.print(table if found else "no asset yet: jackettwin asset add NAME TWIN --store STORE")


@asset_command.command("show")
@click.argument("name")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def show(name: str, as_json: bool, store: Path, database: str | None) -> None:
    """Show one turbine and the versions of its twin."""
    engine = opened(store, database)
    from jackettwin.service.web.catalogue import one, versions_out
    from jackettwin.store import reading
    from jackettwin.store.assets import found_version

    with reading(engine) as connection:
        found_version(connection, name)
        document = one(connection, name).model_dump(mode="json")
        versions = [version.model_dump(mode="json") for version in versions_out(connection, name)]
    if as_json:
        print_json({**document, "versions": versions})
        return
    _, status, _, counts, said, _ = _row(document)
    output.print(f"{name}: {status}; records: {counts}; findings: {said}")
    table = Table("version", "adopted", "observations", "created (UTC)", "by", "comment", box=None)
    for v in versions:
        row = (
            v["version"],
            "yes" if v["adopted"] else "",
            v["observations"],
            v["created_utc"][:16],
            v["created_by"],
        )
        table.add_row(*map(str, row), v["comment"])
    output.print(table)


@asset_command.command("adopt")
@click.argument("name")
@click.argument("version", type=click.IntRange(1))
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def adopt(name: str, version: int, as_json: bool, store: Path, database: str | None) -> None:
    """Make a VERSION of the turbine NAME the one whose answers count."""
    engine = opened(store, database)
    from jackettwin.service import adopt_version

    adopt_version(engine, store, name, version)
    if as_json:
        print_json({"asset": name, "adopted_version": version})
    else:
        output.print(f"{name}: version {version} is adopted")


@asset_command.command("archive")
@click.argument("name")
@click.option("--undo", is_flag=True, help="Bring it back.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def archive(name: str, undo: bool, yes: bool, as_json: bool, store: Path, database: str | None) -> None:
    """Archive the turbine NAME: it takes nothing more and leaves the lists; all that is known of it stays."""
    engine = opened(store, database)
    from jackettwin.service import archive_asset

    if not (yes or undo):
        click.confirm(f"{name} takes no records any more; archive it?", abort=True, err=True)
    archive_asset(engine, store, name, undo=undo)
    if as_json:
        print_json({"asset": name, "archived": not undo})
    else:
        output.print(f"{name} is {'back' if undo else 'archived'}")


@asset_command.command("conditions")
@click.argument("name")
@click.argument(
    "tables", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False)
)
@click.option("--clock", default="UTC", show_default=True, help="Zone of times that do not say theirs.")
@click.option(
    "--column", "columns", multiple=True, metavar="THEIRS=OURS", help="Take a column under another name."
)
@click.option("--end-stamped", is_flag=True, help="Rows bear the end of their ten minutes, not the start.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@store_options
def conditions(
    name: str,
    tables: tuple[Path, ...],
    clock: str,
    columns: tuple[str, ...],
    end_stamped: bool,
    as_json: bool,
    store: Path,
    database: str | None,
) -> None:
    """Take conditions of the turbine NAME from TABLES: CSV of ten-minute statistics, as SCADA exports them.

    Records that they belong to are observed again with them, by a server.
    """
    engine = opened(store, database)
    from jackettwin.service import add_conditions

    for column in columns:
        if "=" not in column:
            raise InputError(
                "a column's new name is missing", field="column", value=column, allowed="THEIRS=OURS"
            )
    renamed = dict(column.rsplit("=", 1) for column in columns)
    rows = []
    for path in tables:
        values, again = add_conditions(
            engine, store, name, path, zone=clock, names=renamed, end_stamped=end_stamped
        )
        rows.append({"file": path.name, "count": values, "observed_again": again})
        if not as_json:
            output.print(f"{path.name}: {values} new or changed, {again} records are observed again")
    if as_json:
        print_json({"asset": name, "files": rows})


def _row(asset: dict[str, Any]) -> tuple[Any, ...]:
    counts = ", ".join(f"{n} {status}" for status, n in asset["records"].items()) or "none"
    said = ", ".join(f"{n} {severity}" for severity, n in asset["findings"].items()) or "none"
    last = asset["last_record_utc"] or "–"
    return asset["name"], asset["status"], asset["version"], counts, said, last[:16]
