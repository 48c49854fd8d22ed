"""Tables printed by ``jackettwin identify``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from jackettwin.cli.console import say, say_all, show_table
from jackettwin.report import Table, TableColumn

_SHOWN = 5
"""Largest number of printed lines of one kind; the rest is in the JSON."""
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def show_one(document: Mapping[str, Any]) -> None:
    """Print the modes of one record, what was rejected, and what to beware of."""
    columns = (*_NUMBERS, TableColumn("MPC", "mpc", ".3f"), TableColumn("status", "status"))
    show_table(Table(", ".join(document["records"]), columns, document["modes"]))
    quality = document["quality"]["findings"]
    _print_reasons(document["modes"], [finding["text"] for finding in quality])
    if "methods" in document:
        _print_methods(document)
    for pole in document["real_poles"]:
        low, high = pole["rate_interval_90"]
        say(f"real pole: −{pole['rate_rad_s']:.3g} 1/s ({low:.3g} to {high:.3g} in 90 %)")
    if "real_pole_limits" in document:
        _print_limits(document["real_pole_limits"], bool(document["real_poles"]))
    _print_rejected(document["rejected"])
    _print_quality(quality)
    say_all(document["notes"], "note")
    limits = [f for f in document["findings"] if f["severity"] != "info"]
    told = [f in quality for f in limits]
    say_all((text for text, twice in zip(document["warnings"], told, strict=True) if not twice), "warning")


def _print_quality(findings: Iterable[Mapping[str, Any]]) -> None:
    """Print what was found in the record, once for all channels in which it differs in numbers only."""
    alike: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for f in findings:
        # the numbers in what was read from names are parts of the names
        about = (f["code"], f["text"] if f["code"] == "file" else _NUMBER.sub("", f["text"]))
        alike.setdefault(about, []).append((f["subject"] or f.get("record", "record"), f["text"]))
    for group in alike.values():
        names, texts = zip(*dict.fromkeys(group), strict=True)
        more = " …" if len(names) > _SHOWN else ""
        say(f"quality: {', '.join(names[:_SHOWN])}{more}: {_spanned(texts)}")


def _print_reasons(modes: Iterable[Mapping[str, Any]], told: Iterable[str] = ()) -> None:
    """Print the reasons that modes are not ok, each once with all frequencies concerned.

    Reasons that are ``told`` with the record's quality are those of the whole record.
    """
    alike: dict[tuple[str, str], list[str]] = {}
    for m in modes:
        if m["status_reason"] is not None:
            about = (m["status"], m["status_reason"])
            alike.setdefault(about, []).append(f"{m['frequency_hz']:.4f}")
    for (status, reason), f in alike.items():
        for text in told:
            reason = reason.replace(text, "the record's quality, below")
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
        share, (least, most) = one["rms_share"], one["interval_90"]
        said = (
            "at no amplitude up to 8 times the record's rms"
            if share is None
            else f"from {share:.2g} times the record's rms ({least:.2g} to {most:.2g} in 90 %), "
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
    if m is None:
        return None
    zeta = m["damping_ratio"]
    return f"{m['frequency_hz']:.4f} / {'unknown' if zeta is None else f'{100 * zeta:.2f}'}"


def show_many(document: Mapping[str, Any]) -> None:
    """Print the modes of many records, fused and by group."""
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


def _frequency_interval(m: Mapping[str, Any]) -> str:
    """Return the 90 % interval of f."""
    interval = m["frequency_interval_90"]
    return "–" if interval is None else f"{interval[0]:.4f} – {interval[1]:.4f}"


def _damping_interval(m: Mapping[str, Any]) -> str:
    """Return the 90 % interval of ζ, or its upper limit."""
    interval, most = m["damping_ratio_interval_90"], m.get("damping_ratio_at_most")
    if interval is None:
        return "–" if most is None else f"at most {100 * most:.2f}"
    return f"{100 * interval[0]:.2f} – {100 * interval[1]:.2f}"


_NUMBERS = (
    TableColumn("f [Hz]", "frequency_hz", ".4f"),
    TableColumn("90 % of f [Hz]", _frequency_interval),
    TableColumn("ζ [%]", "damping_ratio", ".2f", 100.0),
    TableColumn("90 % of ζ [%]", _damping_interval),
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


def show_comparison(found: Mapping[str, Any], model: str) -> None:
    """Print which mode of a structure each identified one is most like."""
    columns = (
        TableColumn("f [Hz]", "frequency_hz", ".4f"),
        TableColumn("status", "status"),
        TableColumn("most like", "label"),
        TableColumn("f [Hz]", "model_frequency_hz", ".4f"),
        TableColumn("difference [%]", "relative_difference", ".1f", 100.0),
        TableColumn("MAC", "mac", ".3f"),
        TableColumn("others as alike", "modes_as_alike", ".0f"),
    )
    pairs = [pair for pair in found["pairs"] if pair is not None]
    show_table(Table(f"{model} at {len(found['channels'])} channels", columns, pairs))
