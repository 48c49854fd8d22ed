"""``jackettwin init``: draft of a twin file from a structure and records."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jackettwin.caveats import Omission, omission_documents
from jackettwin.cli.console import FiniteFloat, Reply, answers, messages, progress, say, say_all
from jackettwin.errors import InputError, located

if TYPE_CHECKING:
    from jackettwin.records import FileDefaults, Record
    from jackettwin.study.draft import Draft


_MOST_READ = 20
"""Largest number of records that are read; further ones are only listed."""
_QUESTIONS = {
    "unit": ("unit", "Unit of the channels without one (g, mg, m/s^2, mm/s)", str),
    "sample_rate_hz": ("sample_rate_hz", "Sample rate of the files [Hz]", float),
    "gain": ("gain", "Value of one count in the unit", float),
}
"""Missing property → its name in ``FileDefaults``, the prompt, and its type."""


@click.command("init")
@click.argument("structure")
@click.argument("records", nargs=-1, required=True)
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("twin.yaml"),
    show_default=True,
    help="Twin file to write.",
)
@click.option("--unit", help="Unit of channels without one, e.g. g or mm/s.")
@click.option("--gain", type=FiniteFloat(), help="Value of one count or volt of unscaled channels in --unit.")
@click.option(
    "--sample-rate",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Sample rate [Hz] of files that do not state it.",
)
@click.option("--timezone", "zone", help="Time zone of clocks without one, e.g. Europe/Berlin or +02:00.")
@click.option("--force", is_flag=True, help="Overwrite an existing file.")
@answers
def init_command(
    structure: str,
    records: tuple[str, ...],
    out: Path,
    unit: str | None,
    gain: float | None,
    sample_rate: float | None,
    zone: str | None,
    force: bool,
) -> Reply:
    """Write a commented twin file for STRUCTURE and RECORDS.

    The file is checked, and missing data are listed.     Sensors are placed by the names of the channels.
    What the files do not say of unit, clock and rate is taken from the options, else asked once.
    """
    from jackettwin.decks import read_structure
    from jackettwin.files import atomic_path, check_room
    from jackettwin.records import FileDefaults, read_zone, record_files
    from jackettwin.study.draft import assembled_as_stated, draft_twin
    from jackettwin.twin import model_of_records, read_twin

    if out.exists() and not force:
        raise InputError("exists already", file=out, remedy="choose another --out, or --force")
    check_room(out, least_bytes=10_000)
    if zone is not None:
        read_zone(zone, field="--timezone")
    files = record_files(records)
    built = read_structure(structure)
    with progress(2 + min(len(files), _MOST_READ), "init") as step:
        step(f"assemble {structure}")
        stated = model_of_records(files)
        assembly = assembled_as_stated(built, stated)
        read, left_out, apart, defaults = [], [], [], FileDefaults(sample_rate, unit, gain, zone)
        for file in files[:_MOST_READ]:
            step(f"read {file.name}")
            try:
                record, defaults = _read(file, defaults)
            except InputError as error:
                if str(file) in records:
                    raise
                apart.append(file)
                left_out.append(error.at(file=file))  # other files in a folder of records
                messages.print(f"left out: {error}", soft_wrap=True, markup=False)
                continue
            read.append((_beside(file, out), record))
        if not read:
            raise left_out[0]
        step("write and check")
        further = [_beside(file, out) for file in files[_MOST_READ:]]
        draft = draft_twin(
            _structure_name(structure, out), assembly, read, defaults, further, left_out=left_out
        )
        with atomic_path(out) as temporary:
            temporary.write_text(draft.text, encoding="utf-8")
        if draft.complete:
            read_twin(out)
    said = ", ".join(f"{key} {str(value).lower()}" for key, value in stated.items())
    notes = [f"the records state their model, which the twin adopts: {said}"] if said else []

    def show() -> None:
        _print(draft, out)
        say_all(notes, "note")
        say_all([str(error) for error in left_out], "left out")

    document = _document(draft, out, [str(file) for file in files if file not in apart])
    left = omission_documents(Omission(str(error)) for error in left_out)
    return Reply({**document, "left_out": left, "notes": notes}, show)


def _read(file: Path, defaults: FileDefaults) -> tuple[Record, FileDefaults]:
    """Return a record, and the properties the user was asked for to read it."""
    from jackettwin.identification import moving_channels
    from jackettwin.records import read_record, read_zone
    from jackettwin.records.readers.stamps import UNSAID

    while True:
        try:
            record = read_record(file, defaults)
            with located(file=file):
                moving_channels(record)
        except InputError as error:
            lacking = (error.field or "").rsplit(".", 1)[-1]
            if lacking not in _QUESTIONS or "missing" not in error.problem and lacking != "gain":
                raise
            key, question, kind = _QUESTIONS[lacking]
            if getattr(defaults, key) is not None or not sys.stdin.isatty():
                raise
            defaults = replace(defaults, **{key: click.prompt(question, type=kind, err=True)})
            continue
        if UNSAID not in record.metadata.get("remarks", ()) or not sys.stdin.isatty():
            return record, defaults
        answer = click.prompt("Zone of the logger's clock", default="UTC", err=True)
        read_zone(answer)
        defaults = replace(defaults, timezone=answer)


def _structure_name(source: str, out: Path) -> str:
    return _beside(Path(source), out) if Path(source).exists() else source


def _beside(file: Path, out: Path) -> str:
    """Return a path relative to the folder of the twin file."""
    return Path(os.path.relpath(file.resolve(), out.resolve().parent)).as_posix()


def _print(draft: Draft, out: Path) -> None:
    for place in draft.places:
        s = place.sensor
        where = s.node if s.node is not None else "?" if s.height_m is None else f"{s.height_m:g} m"
        direction = ", ".join(f"{v:g}" for v in s.direction)
        note = f"lacks {place.lacks}" if place.lacks else place.why or "as the record states"
        say(f"{s.channel}: {where}, [{direction}]: {note}")
    without = sum(bool(place.lacks) for place in draft.places)
    say_all(draft.missing[without:], "missing")
    messages.print(f"wrote {out}")
    first = f"complete the {without} sensors commented out in {out}, then " if without else ""
    say(f"next: {first}jackettwin run {out}")


def _document(draft: Draft, out: Path, records: Sequence[str]) -> dict[str, object]:
    return {
        "twin": str(out),
        "complete": draft.complete,
        "sensors": [
            {
                "channel": place.sensor.channel,
                "node": place.sensor.node,
                "height_m": place.sensor.height_m,
                "direction": list(place.sensor.direction),
                "read_from": place.why or None,
                "lacks": place.lacks or None,
            }
            for place in draft.places
        ],
        "records": list(records),
        "missing": list(draft.missing),
    }
