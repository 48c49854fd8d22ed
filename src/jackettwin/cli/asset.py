"""``jackettwin asset``: the turbines of a store and their twins."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import click

from jackettwin.cli.console import CommandGroup, Reply, answers, say, show_table
from jackettwin.cli.store_options import StorePlace, store_options
from jackettwin.errors import require
from jackettwin.files import find_file
from jackettwin.report import Table, TableColumn


@click.group("asset", cls=CommandGroup)
def asset_command() -> None:
    """Manage the turbines of a living twin and their versions."""


@asset_command.command("add")
@click.argument("name")
@click.argument("twin")
@click.option("--comment", default="", help="What this version changes.")
@answers
@store_options
def add(name: str, twin: str, comment: str, at: StorePlace) -> Reply:
    """Add the turbine NAME with its twin file, and copy in every file that this one names.

    TWIN is a twin file or the name of a shipped twin. If the turbine NAME exists, a new version is added,
    which is used once it is adopted.
    """
    path = find_file(twin, "twins")
    engine = at.open(make=True)
    from jackettwin.service import add_twin

    document = add_twin(engine, at.folder, name, path, comment)
    return Reply(
        document, lambda: say(f"{name}: version {document['version']}, model {document['model_hash'][:12]}")
    )


@asset_command.command("list")
@click.option("--archived", is_flag=True, help="List archived turbines instead.")
@answers
@store_options
def list_(archived: bool, at: StorePlace) -> Reply:
    """List the turbines with their status, records and findings."""
    engine = at.open()
    from jackettwin.service.web.catalogue import overview
    from jackettwin.store import reading

    with reading(engine) as connection:
        found = [asset.model_dump(mode="json") for asset in overview(connection, archived=archived)]
    columns = (
        TableColumn("asset", "name"),
        TableColumn("status", "status"),
        TableColumn("version", "version"),
        TableColumn("records", _records),
        TableColumn("findings", _findings),
        TableColumn("latest record (UTC)", lambda asset: (asset["last_record_utc"] or "–")[:16]),
    )
    nothing = "no asset yet: jackettwin asset add NAME TWIN --store STORE"
    return Reply({"assets": found}, lambda: show_table(Table("", columns, found)) if found else say(nothing))


@asset_command.command("show")
@click.argument("name")
@answers
@store_options
def show(name: str, at: StorePlace) -> Reply:
    """Show one turbine and the versions of its twin."""
    engine = at.open()
    from jackettwin.service.web.catalogue import one, versions_out
    from jackettwin.store import reading
    from jackettwin.store.assets import found_version

    with reading(engine) as connection:
        found_version(connection, name)
        asset = one(connection, name).model_dump(mode="json")
        versions = [version.model_dump(mode="json") for version in versions_out(connection, name)]
    columns = (
        TableColumn("version", "version"),
        TableColumn("adopted", lambda version: "yes" if version["adopted"] else ""),
        TableColumn("observations", "observations"),
        TableColumn("created (UTC)", lambda version: version["created_utc"][:16]),
        TableColumn("by", "created_by"),
        TableColumn("comment", "comment"),
    )

    def people() -> None:
        say(f"{name}: {asset['status']}; records: {_records(asset)}; findings: {_findings(asset)}")
        show_table(Table("", columns, versions))

    return Reply({**asset, "versions": versions}, people)


@asset_command.command("adopt")
@click.argument("name")
@click.argument("version", type=click.IntRange(1))
@answers
@store_options
def adopt(name: str, version: int, at: StorePlace) -> Reply:
    """Adopt a VERSION of the turbine NAME, whose answers are then used."""
    engine = at.open()
    from jackettwin.service import adopt_version

    adopt_version(engine, at.folder, name, version)
    return Reply(
        {"asset": name, "adopted_version": version}, lambda: say(f"{name}: version {version} is adopted")
    )


@asset_command.command("group")
@click.argument("group")
@click.argument("assets", nargs=-1)
@answers
@store_options
def group(group: str, assets: tuple[str, ...], at: StorePlace) -> Reply:
    """Define the ASSETS of the group GROUP, to which users can be given rights (`user add --assets @GROUP`).

    Without ASSETS the group is deleted.
    """
    engine = at.open()
    from jackettwin.store import note_down, rights, writing

    with writing(engine) as connection:
        members = rights.put_group(connection, group, assets)
        by, subject = "command line", f"{group}: {', '.join(members)}"
        note_down(connection, by, "group", subject, "ok", datetime.now(UTC))
    return Reply({"group": group, "assets": members}, lambda: say(subject))


@asset_command.command("place")
@click.argument("name")
@click.argument("latitude_deg", type=click.FloatRange(-90.0, 90.0))
@click.argument("longitude_deg", type=click.FloatRange(-180.0, 180.0))
@answers
@store_options
def place(name: str, latitude_deg: float, longitude_deg: float, at: StorePlace) -> Reply:
    """Set where the turbine NAME stands, for the map: LATITUDE_DEG and LONGITUDE_DEG (WGS 84).

    Negative numbers follow a `--`.
    """
    engine = at.open()
    from jackettwin.service import place_asset

    place_asset(engine, at.folder, name, latitude_deg, longitude_deg)
    said = {"asset": name, "latitude_deg": latitude_deg, "longitude_deg": longitude_deg}
    return Reply(said, lambda: say(f"{name} stands at {latitude_deg:g}, {longitude_deg:g}"))


@asset_command.command("archive")
@click.argument("name")
@click.option("--undo", is_flag=True, help="Bring it back.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@answers
@store_options
def archive(name: str, undo: bool, yes: bool, at: StorePlace) -> Reply:
    """Archive the turbine NAME: it accepts no more records and is not listed.

    All its data remain stored.
    """
    engine = at.open()
    from jackettwin.service import archive_asset

    if not (yes or undo):
        click.confirm(f"{name} will take no more records; archive it?", abort=True, err=True)
    archive_asset(engine, at.folder, name, undo=undo)
    return Reply(
        {"asset": name, "archived": not undo}, lambda: say(f"{name} is {'back' if undo else 'archived'}")
    )


@asset_command.command("conditions")
@click.argument("name")
@click.argument(
    "tables", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False)
)
@click.option("--clock", default="UTC", show_default=True, help="Time zone of times without one.")
@click.option(
    "--column", "columns", multiple=True, metavar="THEIRS=OURS", help="Read a column under another name."
)
@click.option(
    "--end-stamped", is_flag=True, help="Times are the ends of the ten-minute intervals, not the starts."
)
@answers
@store_options
def conditions(
    name: str,
    tables: tuple[Path, ...],
    clock: str,
    columns: tuple[str, ...],
    end_stamped: bool,
    at: StorePlace,
) -> Reply:
    """Import conditions of the turbine NAME from TABLES, as SCADA exports them.

    TABLES are CSV files of ten-minute statistics. A server then observes the affected records again.
    """
    engine = at.open()
    from jackettwin.service import add_conditions

    for column in columns:
        problem, form = "a column's new name is missing", "THEIRS=OURS"
        require("=" in column, problem, field="column", value=column, allowed=form)
    renamed = dict(column.rsplit("=", 1) for column in columns)
    rows = []
    for path in tables:
        values, again = add_conditions(
            engine, at.folder, name, path, zone=clock, names=renamed, end_stamped=end_stamped
        )
        rows.append({"file": path.name, "count": values, "observed_again": again})

    def people() -> None:
        for row in rows:
            again = row["observed_again"]
            say(f"{row['file']}: {row['count']} new or changed, {again} records are observed again")

    return Reply({"asset": name, "files": rows}, people)


def _records(asset: dict[str, Any]) -> str:
    return ", ".join(f"{n} {status}" for status, n in asset["records"].items()) or "none"


def _findings(asset: dict[str, Any]) -> str:
    return ", ".join(f"{n} {severity}" for severity, n in asset["findings"].items()) or "none"
