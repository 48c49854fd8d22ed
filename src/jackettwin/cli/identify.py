"""``jackettwin identify``: modes of one record, or of many fused, with uncertainty."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
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
    say,
    say_all,
    show_table,
)
from jackettwin.errors import InputError, located
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.files import KeptInFolder
    from jackettwin.identification import Examination, IdentificationSettings, Pick
    from jackettwin.progress import Progress
    from jackettwin.records import Unsaid

_SHOWN = 5
"""Largest number of printed lines of one kind; the rest is in the JSON."""
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


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
    asked = (method, band, quick, compare, real_poles, sample_rate, unit, gain, zone, whole)
    place = partial(_place, records, (settings_file, picks_file), asked, out)
    known = None if fresh or report is not None else cache.kept_document(place())
    if known is not None:
        messages.print("stored result of an earlier run with the same inputs; --fresh identifies again")
        _deliver(known, out, as_json, _print_many if "groups" in known else _print_one, model)
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
    how: dict[str, Any] = {"picks": picks, "unsaid": _unsaid(sample_rate, unit, gain, zone)}
    for path in (out, report):
        if path is not None:
            check_room(path)
    with tempfile.TemporaryDirectory(prefix="jackettwin-") as passing:
        if not whole:
            files = _without_long(files, Path(passing) / "pieces", how["unsaid"])
        if len(files) == 1:
            how["keep"] = cache.keeping(fresh=fresh)
            document, show = _one(files[0], settings, how, compare, report), _print_one
        else:
            keep = _keep(out, len(files), fresh=fresh) or cache.kept_in(Path(passing))
            document = _many(files, settings, how, keep, workers, report)
            show = _print_many
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


def _without_long(files: tuple[Path, ...], folder: Path, unsaid: Unsaid) -> tuple[Path, ...]:
    """Return the files, with records longer than an hour replaced by ten-minute pieces."""
    from jackettwin.study import LONG, PIECE_S
    from jackettwin.study.many_records.long_records import without_long

    with progress(len(files), "read") as step:
        cut = without_long(files, folder, unsaid, step)
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
    if out is not None:
        _export(document, out)
    if as_json:
        print_json(document)
    else:
        show(document)
        if model is not None:
            _print_beside(document["model"], model)


def _beside(document: Mapping[str, Any], model: str) -> dict[str, Any]:
    from jackettwin.decks import read_structure
    from jackettwin.structure import assemble
    from jackettwin.study import beside_model

    return beside_model(document, assemble(read_structure(model)))


def _print_beside(found: Mapping[str, Any], model: str) -> None:
    """Print which mode of a structure each identified one is most like."""
    columns = (
        TableColumn("f [Hz]", "frequency_hz", ".4f"),
        TableColumn("status", "status"),
        TableColumn("most like", "label"),
        TableColumn("f [Hz]", "model_frequency_hz", ".4f"),
        TableColumn("difference [%]", "relative_difference", ".1f", 100.0),
        TableColumn("MAC", "mac", ".3f"),
    )
    pairs = [pair for pair in found["pairs"] if pair is not None]
    show_table(Table(f"{model} at {len(found['channels'])} channels", columns, pairs))


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
        batch = observe_many(files, model, keep=keep, unsaid=how["unsaid"], workers=workers, progress=step)
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
        messages.print("quick identification: modes are not checked, ok means only that the poles are stable")
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


def _unsaid(sample_rate: float | None, unit: str | None, gain: float | None, zone: str | None) -> Unsaid:
    from jackettwin.quantities import plain_unit, vibration_of
    from jackettwin.records import Unsaid, read_zone

    if unit is not None:
        vibration_of(plain_unit(unit), field="--unit")
    if zone is not None:
        read_zone(zone, field="--timezone")
    return Unsaid(sample_rate, unit, gain, zone)


def _picks(path: str | None, files: Sequence[Path]) -> tuple[Pick, ...]:
    if path is None:
        return ()
    from jackettwin.files import read_mapping
    from jackettwin.identification import parse_picks, refuse_strangers

    with located(file=path):
        picks = parse_picks(read_mapping(path, what="file of picks"))
        refuse_strangers(picks, [file.stem for file in files])
        return picks


def _folder(out: Path) -> bool:
    return out.is_dir() or not out.suffix


def _refuse_format(out: Path | None) -> None:
    """Raise an error on an unsupported extension before the computation."""
    from jackettwin.study import WRITERS, export_modes

    if out is not None and not _folder(out) and out.suffix.lower() not in WRITERS:
        export_modes({}, out)


def _print_one(document: Mapping[str, Any]) -> None:
    columns = (*_NUMBERS, TableColumn("MPC", "mpc", ".3f"), TableColumn("status", "status"))
    show_table(Table(", ".join(document["records"]), columns, document["modes"]))
    _print_reasons(document["modes"])
    if "methods" in document:
        _print_methods(document)
    for pole in document["real_poles"]:
        low, high = pole["rate_interval_95"]
        say(f"real pole: −{pole['rate_rad_s']:.3g} 1/s ({low:.3g} to {high:.3g} in 95 %)")
    if "real_pole_limits" in document:
        _print_limits(document["real_pole_limits"], bool(document["real_poles"]))
    _print_rejected(document["rejected"])
    quality = document["quality"]["findings"]
    for finding in quality:
        say(f"quality: {finding['subject'] or 'record'}: {finding['text']}")
    told = {finding["text"] for finding in quality}
    say_all(document["notes"], "note")
    say_all((text for text in document["warnings"] if text not in told), "warning")


def _print_reasons(modes: Iterable[Mapping[str, Any]]) -> None:
    """Print the reasons that modes are not ok, each once with all frequencies concerned."""
    alike: dict[tuple[str, str], list[str]] = {}
    for m in modes:
        if m["status_reason"] is not None:
            about = (m["status"], m["status_reason"])
            alike.setdefault(about, []).append(f"{m['frequency_hz']:.4f}")
    for (status, reason), f in alike.items():
        say(f"{', '.join(f)} Hz {'is' if len(f) == 1 else 'are'} {status}: {reason}")


def _print_limits(limits: Mapping[str, Any], found: bool) -> None:
    """Print the relaxations that would be detected in 95 of 100 records like this."""
    nothing = "" if found else "no real pole; "
    if limits["kind"] == "release":
        say(
            f"{nothing}release at {limits['release_s']:.1f} s; a relaxation of this amplitude is found with "
            "95 % power:"
        )
        names = list(limits["limits"][0]["amplitude"])
        rows = [
            [f"{one['rate_rad_s']:.3g}", *(f"{one['amplitude'][n]:.2g}" for n in names)]
            for one in limits["limits"]
        ]
        show_table(Table("amplitude of a relaxation", ("rate [1/s]", *names), rows))
        return
    low, high = limits["band_rad_s"]
    band = f"{low:.3g} to {high:.3g} 1/s"
    say(f"{nothing}no statement on rates beyond the band, {band}; inside, with 95 % power:")
    name, rms = max(limits["rms"].items(), key=lambda pair: pair[1])
    for one in limits["limits"]:
        share, (least, most) = one["rms_share"], one["interval_95"]
        said = (
            "at no amplitude up to 8 times the record's rms"
            if share is None
            else f"from {share:.2g} times the record's rms ({least:.2g} to {most:.2g}), "
            f"{share * rms:.2g} in {name}"
        )
        say(f"  a relaxation at {one['rate_rad_s']:.3g} 1/s is found {said}, by {one['trials']} trials")


def _print_methods(document: Mapping[str, Any]) -> None:
    methods = document["methods"]
    modes = zip(document["modes"], *methods["modes"].values(), strict=True)
    rows = [[_both(m) for m in alike] for alike in modes]
    heads = ("f [Hz] / ζ [%]", *methods["modes"])
    show_table(Table("the same modes by every method, not refined", heads, rows))
    for method, why in methods["refused"].items():
        say(f"{method} not applied: {why}")


def _both(m: Mapping[str, Any] | None) -> str | None:
    return None if m is None else f"{m['frequency_hz']:.4f} / {100 * m['damping_ratio']:.2f}"


def _print_many(document: Mapping[str, Any]) -> None:
    from jackettwin.study.many_records.export import group_name

    n = document["records_identified"]
    _print_fused(f"{n} records fused, {document['duration_s'] / 3600:.3g} h", document["modes"], n)
    groups = document["groups"]
    for group in groups if len(groups) > 1 else ():
        _print_fused(group_name(group), group["modes"], len(group["records"]))
    failed = document["failed"]
    for one in failed[:_SHOWN]:
        where = "" if one["problem"].startswith(one["record"]) else f"{one['record']}: "
        say(f"failed: {where}{one['problem']}")
    if len(failed) > _SHOWN:
        say(f"failed: {len(failed) - _SHOWN} more (--json lists them)")
    _print_rejected(document["rejected"])
    _print_findings(document["records"], n)
    say_all(document["warnings"], "warning")


def _print_findings(records: Iterable[Mapping[str, Any]], n: int) -> None:
    """Print the number of records with each fault of each channel, and the first one's sentence."""
    seen: dict[tuple[str | None, str], list[str]] = {}
    for record in records:
        for finding in record["quality"]["findings"]:
            name, code, text = finding["subject"], finding["code"], finding["text"]
            about = text.partition(":")[0] if code == "file" else code
            seen.setdefault((name, about), []).append(text)
    often = sorted(seen.items(), key=lambda item: -len(item[1]))
    for (name, _), texts in often[:_SHOWN]:
        where = f"{name or 'record'}, {len(texts)} of {n} records"
        say(f"quality: {where}: {texts[0]}")
    if len(often) > _SHOWN:
        say(f"quality: {len(often) - _SHOWN} more findings (--json lists them)")


def _print_fused(title: str, modes: Sequence[Mapping[str, Any]], n_records: int) -> None:
    columns = (
        *_NUMBERS,
        TableColumn("scatter of ζ between records [%]", "relative_scatter_damping_ratio", ".0f", 100.0),
        TableColumn("in records", lambda m: f"{m['records_with_mode']} of {n_records}"),
        TableColumn("status", lambda m: f"{m['status']} (ok in {m['records_ok']})"),
    )
    show_table(Table(title, columns, modes))
    _print_reasons(modes)


def _interval(m: Mapping[str, Any]) -> str:
    """Return the 95 % interval of ζ, or its upper limit."""
    interval, most = m["damping_ratio_interval_95"], m.get("damping_ratio_at_most")
    if interval is None:
        return "–" if most is None else f"at most {100 * most:.2f}"
    return f"{100 * interval[0]:.2f} – {100 * interval[1]:.2f}"


_NUMBERS = (
    TableColumn("f [Hz]", "frequency_hz", ".4f"),
    TableColumn("± f [Hz]", "frequency_std_hz", ".2g"),
    TableColumn("ζ [%]", "damping_ratio", ".2f", 100.0),
    TableColumn("95 % interval of ζ [%]", _interval),
)


def _print_rejected(rejected: Iterable[Mapping[str, Any]]) -> None:
    """Print the number of rejected candidates for each reason; the JSON lists all."""
    alike: dict[str, list[tuple[str, float]]] = {}
    for r in rejected:
        alike.setdefault(_NUMBER.sub("", r["reason"]), []).append((r["reason"], r["frequency_hz"]))
    for group in sorted(alike.values(), key=len, reverse=True):
        reasons, f = zip(*group, strict=True)
        where = f"{f[0]:.4g} Hz" if len(f) == 1 else f"{min(f):.3g} to {max(f):.3g} Hz"
        say(f"rejected: {len(f)} × {_spanned(reasons)} ({where})")


def _spanned(texts: Sequence[str]) -> str:
    """Return one text for several that differ only in numbers, with the range of each number."""
    spans = iter(zip(*(_NUMBER.findall(text) for text in texts), strict=True))

    def span(_: re.Match[str]) -> str:
        numbers = sorted(set(next(spans)), key=float)
        return numbers[0] if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"

    return _NUMBER.sub(span, texts[0])
