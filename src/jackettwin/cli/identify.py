"""``jackettwin identify``: modes of records, with uncertainty."""

from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from jackettwin.cli.console import number, output, print_json, progress
from jackettwin.errors import located
from jackettwin.files import read_yaml
from jackettwin.identification import IdentificationSettings
from jackettwin.twin import Observation, observation_document, observe


@click.command("identify")
@click.argument("records", nargs=-1, required=True)
@click.option("--settings", "settings_file", help="YAML file with identification settings.")
@click.option(
    "--drop-dead", is_flag=True, help="Leave channels that carry nothing out instead of refusing the record."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def identify_command(
    records: tuple[str, ...], settings_file: str | None, drop_dead: bool, as_json: bool
) -> None:
    """Identify the modes of each of RECORDS."""
    settings = _settings(settings_file)
    found: list[Observation] = []
    with progress(len(records), "identify") as step:
        for name in records:
            step(f"identify {Path(name).name}")
            found.append(observe(Path(name), settings, drop_dead=drop_dead))
    documents = [observation_document(seen) for seen in found]
    if as_json:
        print_json(documents[0] if len(documents) == 1 else {"records": documents})
        return
    for seen in found:
        _print(seen)


def _settings(path: str | None) -> IdentificationSettings:
    if path is None:
        return IdentificationSettings()
    with located(file=path):
        return IdentificationSettings.from_mapping(read_yaml(path, what="settings file"))


def _print(seen: Observation) -> None:
    found = seen.identification
    table = Table(
        "f [Hz]",
        "± f [Hz]",
        "ζ [%]",
        "95 % interval of ζ [%]",
        "MPC",
        "status",
        title=", ".join(found.records),
    )
    for m in found.modes:
        interval = m.damping_ratio_interval_95
        table.add_row(
            f"{m.frequency_hz:.4f}",
            number(m.frequency_std_hz, 2),
            f"{100 * m.damping_ratio:.2f}",
            "–" if interval is None else f"{100 * interval[0]:.2f} – {100 * interval[1]:.2f}",
            f"{m.mpc:.3f}",
            m.status,
        )
    output.print(table)
    for r in found.rejected:
        output.print(f"rejected {r.frequency_hz:.4f} Hz: {r.reason}")
    for finding in seen.quality.findings:
        output.print(f"quality: {finding.channel or 'record'}: {finding.text}")
    for warning in found.warnings:
        output.print(f"warning: {warning}")
