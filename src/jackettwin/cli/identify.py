"""``jackettwin identify``: modes of one record, or of many fused, with uncertainty."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.cli import cache
from jackettwin.cli.console import (
    FiniteFloat,
    PageFile,
    json_option,
    messages,
    print_json,
    progress,
)
from jackettwin.cli.identify_tables import show_comparison, show_many, show_one
from jackettwin.errors import InputError, located

if TYPE_CHECKING:
    from jackettwin.files import KeptInFolder
    from jackettwin.identification import Examination, IdentificationSettings, Pick
    from jackettwin.progress import Progress
    from jackettwin.records import FileDefaults, Record


class _Method(click.types.StringParamType):
    """Name of a registered method; the registry is imported when needed."""

    name = "method"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return the possible names for the help text."""
        from jackettwin.identification import method_names

        return f"[{'|'.join(method_names())}]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the name; raise an error if there is no such method."""
        from jackettwin.identification import method_names
        from jackettwin.identification.methods import is_method

        if not is_method(value):
            self.fail(f"{value!r} is not one of {', '.join(map(repr, method_names()))}.", param, ctx)
        return str(value)


@click.command("identify")
@click.argument("records", nargs=-1, required=True)
@click.option("--settings", "settings_file", help="YAML file with identification settings.")
@click.option(
    "--method",
    type=_Method(),
    help="Method that finds poles; default ssi-cov.",
)
@click.option(
    "--report",
    type=PageFile(),
    help="HTML page: spectra, stabilisation and moving shapes of one record, or modes tracked over many.",
)
@click.option("--band", help="LOW,HIGH in Hz: band of the modes; default from the lowest clear peak.")
@click.option("--quick", is_flag=True, help="Omit uncertainty, refinement and further checks.")
@click.option("--model", help="Structure whose mode shapes are compared by MAC at the sensors.")
@click.option(
    "--merge",
    type=click.Choice(["poser", "preger"]),
    default="poser",
    help="Whether setups with moved sensors are merged after (poser) or before (preger) the identification.",
)
@click.option("--compare", is_flag=True, help="Identify one record by every method, for comparison.")
@click.option("--real-poles", is_flag=True, help="Also identify relaxations: poles that do not oscillate.")
@click.option(
    "--picks",
    "picks_file",
    help="Poles that replace the automatic selection: the JSON of an earlier run, or YAML.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="File to write (.json, .csv, .nc, or .uff of shapes), or a folder for the first three, which also "
    "stores the result of every record, so that an interrupted run can continue.",
)
@click.option(
    "--sample-rate",
    type=FiniteFloat(min=0.0, min_open=True),
    help="Sample rate [Hz] of files that do not state it.",
)
@click.option("--unit", help="Unit of channels without one, e.g. g or mm/s, which also gives their quantity.")
@click.option("--gain", type=FiniteFloat(), help="Value of one count or volt of unscaled channels in --unit.")
@click.option("--timezone", "zone", help="Time zone of clocks without one, e.g. Europe/Berlin or +02:00.")
@click.option("--fresh", is_flag=True, help="Ignore stored identifications of earlier runs.")
@click.option(
    "--whole", is_flag=True, help="Do not divide records longer than an hour into ten-minute pieces."
)
@click.option("--workers", type=click.IntRange(1), help="Processes for many records; default one per core.")
@json_option
def identify_command(
    records: tuple[str, ...],
    settings_file: str | None,
    method: str | None,
    report: Path | None,
    band: str | None,
    quick: bool,
    model: str | None,
    merge: str,
    compare: bool,
    real_poles: bool,
    picks_file: str | None,
    out: Path | None,
    sample_rate: float | None,
    unit: str | None,
    gain: float | None,
    zone: str | None,
    fresh: bool,
    whole: bool,
    workers: int | None,
    as_json: bool,
) -> None:
    """Identify the modes of RECORDS: files, or folders of files.

    Several records are fused: over all of them and by wind speed, yaw and state.
    """
    asked = (method, band, quick, merge, compare, real_poles, sample_rate, unit, gain, zone, whole)
    place = partial(_place, records, (settings_file, picks_file), asked, out)
    known = None if fresh or report is not None else cache.kept_document(place())
    if known is not None:
        messages.print("stored result of an earlier run with the same inputs; --fresh identifies again")
        _deliver(known, out, as_json, show_many if "groups" in known else show_one, model)
        return
    from jackettwin.files import check_room
    from jackettwin.records import record_files

    settings = _settings(settings_file, method, band, quick=quick, real_poles=real_poles)
    _refuse_format(out)
    files = record_files(records)
    picks = _picks(picks_file, files)
    if compare and len(files) > 1:
        n = f"{len(files)} records"
        raise InputError("takes one record", field="--compare", value=n, remedy="run it for each record")
    if merge == "preger":
        _refuse_preger(len(files), {"--report": report, "--picks": picks_file})
    how: dict[str, Any] = {"picks": picks, "defaults": _unsaid(sample_rate, unit, gain, zone)}
    for path in (out, report):
        if path is not None:
            check_room(path)
    with tempfile.TemporaryDirectory(prefix="jackettwin-") as passing:
        if not whole and merge == "poser":
            files = _without_long(files, Path(passing) / "pieces", how["defaults"])
        _refuse_shapes_of_first(out, files, how["defaults"])
        if merge == "preger":
            document, show = _setups(files, settings, how["defaults"]), show_one
        elif len(files) == 1:
            how |= {"keep": cache.keeping(fresh=fresh), "whole": whole}
            how["refuse"] = partial(_refuse_shapes, out)
            document, show = _one(files[0], settings, how, compare, report), show_one
        else:
            keep = _keep(out, len(files), fresh=fresh) or cache.kept_in(Path(passing))
            document = _many(files, settings, how, keep, workers, report)
            show = show_many
        if report is None and not document.get("failed"):
            cache.keep_document(document, place())
        _deliver(document, out, as_json, show, model)


def _place(
    records: Sequence[str], choices: Sequence[str | None], asked: tuple[object, ...], out: Path | None
) -> Path | None:
    """Return the path in the cache of this command's document."""
    folder = cache.kept_folder()
    if folder is None:
        return None
    chosen = [path for path in choices if path is not None]
    beside = out / "records" if out is not None and _folder(out) else None
    results = sorted(beside.iterdir()) if beside is not None and beside.is_dir() else beside
    return cache.document_place(folder, [*records, *chosen], (asked, len(records), choices, results))


def _keep(out: Path | None, n_records: int, *, fresh: bool) -> KeptInFolder | None:
    """Return the store of a batch's observations, in its output folder if it has one."""
    if out is not None and _folder(out):
        return cache.kept_in(out / "records", fresh=fresh)
    folder = cache.kept_folder() if n_records <= cache.MOST_RECORDS else None
    return None if folder is None else cache.kept_in(folder, fresh=fresh)


def _without_long(files: tuple[Path, ...], folder: Path, defaults: FileDefaults) -> tuple[Path, ...]:
    """Return the files, with records longer than an hour replaced by ten-minute pieces."""
    from jackettwin.study import LONG, PIECE_S
    from jackettwin.study.many_records.long_records import without_long

    with progress(len(files), "read") as step:
        cut = without_long(files, folder, defaults, step)
    if len(cut) > len(files):
        messages.print(
            f"records longer than {LONG * PIECE_S / 3600:g} h are identified in pieces of {PIECE_S:g} s on "
            "UTC boundaries and fused; --whole identifies each as one record"
        )
    return cut


def _deliver(
    document: Mapping[str, Any],
    out: Path | None,
    as_json: bool,
    show: Callable[[Mapping[str, Any]], None],
    model: str | None,
) -> None:
    if model is not None:
        document = {**document, "model": _beside(document, model)}
    try:
        if out is not None:
            _export(document, out)
    finally:  # what cannot be written is shown
        if as_json:
            print_json(document)
        else:
            show(document)
            if model is not None:
                show_comparison(document["model"], model)


def _beside(document: Mapping[str, Any], model: str) -> dict[str, Any]:
    from jackettwin.decks import read_structure
    from jackettwin.structure import assemble
    from jackettwin.study import beside_model

    return beside_model(document, assemble(read_structure(model)))


def _export(document: Mapping[str, Any], out: Path) -> None:
    from jackettwin.files import write_json
    from jackettwin.study import ALWAYS, export_modes

    for path in [out / f"modes{ending}" for ending in ALWAYS] if _folder(out) else [out]:
        export_modes(document, path)
        messages.print(f"wrote {path}")
    if _folder(out):
        write_json({"picks": document["picks"]}, out / "picks.json")


def _one(
    file: Path,
    settings: IdentificationSettings,
    how: Mapping[str, Any],
    compare: bool,
    report: Path | None,
) -> dict[str, Any]:
    from jackettwin.identification import examine_file, identification_document

    limits = settings.real_poles and settings.method == "ssi-cov"
    with progress(1 + (report is not None) + limits, "identify") as step:
        step(f"identify {file.name}")
        seen = examine_file(file, settings, compare=compare or report is not None, **how)
        document = identification_document(
            seen.identification, seen.quality.summary(), seen.record.conditions, seen.comparison
        )
        if limits:
            step("detection limit of relaxations")
            document["real_pole_limits"] = _limits(seen, settings, step)
        if report is not None:
            from jackettwin.report.pages.identification import build_identification_page

            step("write the report")
            build_identification_page(seen, report)
    if report is not None:
        messages.print(f"wrote {report}")
    return document


def _setups(
    files: Sequence[Path], settings: IdentificationSettings, defaults: FileDefaults
) -> dict[str, Any]:
    from jackettwin.identification import preger_document
    from jackettwin.records import read_record

    with progress(len(files) + 1, "identify") as step:

        def read(path: Path) -> Record:
            step(f"read {path.name}")
            return read_record(path, defaults)

        return preger_document(map(read, files), settings, step)


def _refuse_preger(n_files: int, options: Mapping[str, object]) -> None:
    """Raise an error on one record, or on options that need the identification of single records."""
    if n_files < 2:
        raise InputError(
            "takes several setups", field="--merge preger", value=f"{n_files} record", remedy="name them all"
        )
    given = [name for name, value in options.items() if value]
    if given:
        raise InputError(
            "does not go with --merge preger",
            field=given[0],
            remedy="omit one of both, or take --merge poser",
        )


def _limits(seen: Examination, settings: IdentificationSettings, step: Progress) -> dict[str, Any]:
    """Return the detection limits of relaxations, after a release or in ambient vibration."""
    from jackettwin.identification import ambient_limits, limits_document, release_relaxations

    release = release_relaxations(seen.record)
    return limits_document(
        ambient_limits(seen.record, settings, progress=step) if release is None else release
    )


def _many(
    files: Sequence[Path],
    settings: IdentificationSettings,
    how: Mapping[str, Any],
    keep: KeptInFolder,
    workers: int | None,
    report: Path | None,
) -> dict[str, Any]:
    """Return the document; its long lists are streamed from the stored results."""
    from jackettwin.study.many_records.document import many_document
    from jackettwin.study.many_records.identify import observe_many
    from jackettwin.study.many_records.summary import fuse_batch
    from jackettwin.twin import TwinModel

    model = TwinModel("identify", identification=settings, picks=how["picks"])
    with progress(len(files), "identify") as step:
        batch = observe_many(
            files, model, keep=keep, defaults=how["defaults"], workers=workers, progress=step
        )
    if not len(batch):
        raise InputError(
            f"none of {len(batch.failed)} records could be identified; the first: {batch.failed[0].problem}",
            field="RECORD",
            remedy="identify one alone to see the cause",
        )
    together = fuse_batch(batch)
    if report is not None:
        from jackettwin.report.pages.many_records import build_many_page

        build_many_page(together, batch.failed, report)
        messages.print(f"wrote {report}")
    return many_document(batch, together)


def _settings(
    path: str | None, method: str | None, band: str | None, *, quick: bool, real_poles: bool
) -> IdentificationSettings:
    from jackettwin.files import read_yaml, validate
    from jackettwin.identification import IdentificationSettings

    settings = IdentificationSettings()
    if path is not None:
        settings = validate(IdentificationSettings, read_yaml(path, what="settings file"), file=path)
    settings = settings if method is None else settings.with_method(method)
    if quick and real_poles:
        raise InputError("needs the uncertainty that --quick omits", field="--real-poles", remedy="omit one")
    if quick:
        messages.print("quick identification: modes are not checked, their poles are stable")
    elif settings.method != "ssi-cov":
        messages.print(f"{settings.method}: modes are not checked as those of ssi-cov are")
    update: dict[str, Any] = {"real_poles": True} if real_poles else {}
    update |= {"blocks": 0, "refine": False} if quick else {}
    update |= _band(band)
    with located(field="--band"):
        return validate(IdentificationSettings, {**dict(settings), **update}) if update else settings


def _band(text: str | None) -> dict[str, float]:
    """Return the settings for a band given as LOW,HIGH."""
    if text is None:
        return {}
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        low, high = 0.0, 0.0
    if not 0.0 < low < high < float("inf"):
        raise InputError(
            "is not a band",
            field="--band",
            value=text,
            allowed="two frequencies in Hz, 0 < LOW < HIGH",
            remedy="write e.g. --band 0.1,12",
        )
    return {"lowest_frequency_hz": low, "highest_frequency_hz": high}


def _unsaid(
    sample_rate: float | None, unit: str | None, gain: float | None, zone: str | None
) -> FileDefaults:
    from jackettwin.quantities import plain_unit, vibration_of
    from jackettwin.records import FileDefaults, read_zone

    if unit is not None:
        vibration_of(plain_unit(unit), field="--unit")
    if zone is not None:
        read_zone(zone, field="--timezone")
    return FileDefaults(sample_rate, unit, gain, zone)


def _picks(path: str | None, files: Sequence[Path]) -> tuple[Pick, ...]:
    if path is None:
        return ()
    from jackettwin.files import read_mapping
    from jackettwin.identification import parse_picks, refuse_strangers

    with located(file=path):
        picks = parse_picks(read_mapping(path, what="file of picks", list_of="picks"))
        refuse_strangers(picks, [file.stem for file in files])
        return picks


def _folder(out: Path) -> bool:
    return out.is_dir() or not out.suffix


def _refuse_format(out: Path | None) -> None:
    """Raise an error on an unsupported extension before the computation."""
    from jackettwin.study import WRITERS, export_modes

    if out is not None and not _folder(out) and out.suffix.lower() not in WRITERS:
        export_modes({}, out)


def _refuse_shapes(out: Path | None, record: Record) -> None:
    """Raise an error if a record has no directions, which UFF needs."""
    from jackettwin.study.many_records.shapes_uff import pointing

    if out is not None and out.suffix.lower() == ".uff":
        pointing({c.name: {"quantity": c.quantity, "direction": c.direction} for c in record.channels})


def _refuse_shapes_of_first(out: Path | None, files: Sequence[Path], defaults: FileDefaults) -> None:
    """Raise an error if the first of many records has no directions, before the computation."""
    from jackettwin.records import read_record_pieces

    if out is None or out.suffix.lower() != ".uff" or len(files) < 2:
        return
    piece = None
    with suppress(InputError):  # what cannot be read is refused where it is identified
        piece = next(read_record_pieces(files[0], defaults=defaults), None)
    if piece is not None:
        _refuse_shapes(out, piece)
