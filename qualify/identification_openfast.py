"""Modes of records made by an independent aeroelastic program, against its own linearised modes.

Usage: ``python qualify/identification_openfast.py [FOLDER] [OUT.md]``. Every ``NAME.parquet`` of the folder
(default: the shipped records) with a ``NAME.json`` beside it that holds its ``true_modes``.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from common.command import arguments
from scipy.signal import welch

from jackettwin.identification import Identification, ModalEstimate, fuse, identify
from jackettwin.identification.many_records.pairs import along_axes
from jackettwin.records import Record, read_record

SHIPPED = Path(str(files("jackettwin") / "data" / "records"))
IN_TURBULENCE = 0.855
"""Mean aerodynamic damping of the side-side modes in turbulence over that of a steady wind: 0.82–0.89."""
DIRECTIONS = ("side_side", "fore_aft")
EXPLANATION = f"""\
Ten minutes each, made with OpenFAST (an independent program): turbulent wind on the parked rotor, rigid
blades. The truth is linearised in steady wind. Side-side, its aerodynamic part (which grows with the wind
from zero) is multiplied by {IN_TURBULENCE:g}, as the mean damping in turbulence is lower: the estimate is an
effective damping of the ten minutes. Fore-aft and side-side differ by their shape; close pairs are rotated
to the rotor's axes, which are known. Intervals are 90 %; ✗ misses the truth.
"""


@dataclass(frozen=True)
class Case:
    """One mode of one record."""

    record: str
    label: str
    wind_m_s: float
    true_frequency_hz: float
    true_damping_ratio: float
    mode: ModalEstimate | None

    @property
    def frequency_inside(self) -> bool:
        interval = None if self.mode is None else self.mode.frequency_interval_90
        return interval is not None and interval[0] < self.true_frequency_hz < interval[1]

    @property
    def damping_inside(self) -> bool:
        interval = None if self.mode is None else self.mode.damping_ratio_interval_90
        return interval is not None and interval[0] < self.true_damping_ratio < interval[1]


def truths(folder: Path) -> dict[str, dict[str, Any]]:
    """Return the documents of the records whose modes are known."""
    found = {p.stem: json.loads(p.read_text(encoding="utf-8")) for p in sorted(folder.glob("*.json"))}
    return {name: d for name, d in found.items() if d.get("true_modes")}


def expected_damping(documents: dict[str, dict], name: str, label: str) -> float:
    """Return the damping expected in turbulence; without wind, by a straight line through the records."""
    asset = [d for d in documents.values() if d["asset"] == documents[name]["asset"]]
    wind = [d["conditions"]["mean_wind_speed_m_s"] for d in asset]
    zeta = [_true(d, label)["damping_ratio"] for d in asset]
    own = _true(documents[name], label)["damping_ratio"]
    if not label.startswith("side_side") or len(set(wind)) < 2:
        return own
    still = float(np.polyval(np.polyfit(wind, zeta, 1), 0.0))
    return still + IN_TURBULENCE * (own - still)


def _true(document: dict, label: str) -> dict:
    return next(m for m in document["true_modes"] if m["label"] == label)


def cases(documents: dict[str, dict], results: dict[str, Identification]) -> list[Case]:
    """Return both bending pairs of every record: each direction its own mode, or none."""
    out = []
    for name, result in results.items():
        for pair in (1, 2):
            labels = [f"{direction}_{pair}" for direction in DIRECTIONS]
            f = [_true(documents[name], label)["frequency_hz"] for label in labels]
            near = [m for m in result.modes if abs(m.frequency_hz / np.mean(f) - 1.0) < 0.07]
            near = sorted(near, key=lambda m: fore_aft_share(result, m)) if len(near) == 2 else [None, None]
            out += [
                Case(
                    name,
                    label,
                    documents[name]["conditions"]["mean_wind_speed_m_s"],
                    frequency,
                    expected_damping(documents, name, label),
                    mode,
                )
                for label, frequency, mode in zip(labels, f, near, strict=True)
            ]
    return out


def fore_aft_share(result: Identification, mode: ModalEstimate) -> float:
    """Return the share of the channels along x in the size of the shape."""
    along = np.array([c.direction is not None and abs(c.direction[0]) > 0.7 for c in result.channels])
    size = np.abs(mode.mode_shape) ** 2
    return float(size[along].sum() / size.sum())


def table(found: list[Case]) -> list[str]:
    rows = [
        "| record | mode | f [Hz] | true | ζ [%] | interval | true | method |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for c in found:
        if c.mode is None or c.mode.damping_ratio_interval_90 is None:
            rows.append(f"| {c.record} | {c.label} | – | {c.true_frequency_hz:.4f} | – | – | – | missed |")
            continue
        low, high = c.mode.damping_ratio_interval_90
        miss = "" if c.damping_inside else " ✗"
        rows.append(
            f"| {c.record} | {c.label} | {c.mode.frequency_hz:.4f} | {c.true_frequency_hz:.4f} "
            f"| {100 * c.mode.damping_ratio:.2f} | {100 * low:.2f}–{100 * high:.2f}{miss} "
            f"| {100 * c.true_damping_ratio:.2f} | {c.mode.method} |"
        )
    share = [np.mean([getattr(c, what) for c in found]) for what in ("frequency_inside", "damping_inside")]
    return [
        *rows,
        "",
        f"{len(found)} modes: {sum(c.mode is None for c in found)} missed; truth inside the interval of f in "
        f"{100 * share[0]:.0f} %, of ζ in {100 * share[1]:.0f} %.",
    ]


def fused_table(documents: dict[str, dict], results: dict[str, Identification]) -> list[str]:
    rows = ["| asset | mode | f fused / true | interval of f | ζ fused / true |", "|---|---|---|---|---|"]
    for asset in sorted({d["asset"] for d in documents.values()}):
        names = [n for n in results if documents[n]["asset"] == asset]
        fused = fuse([results[n] for n in names])
        for pair in (1, 2):
            for direction in DIRECTIONS:
                label = f"{direction}_{pair}"
                f = np.mean([_true(documents[n], label)["frequency_hz"] for n in names])
                zeta = np.mean([expected_damping(documents, n, label) for n in names])
                near = [m for m in fused.modes if abs(m.frequency_hz / f - 1.0) < 0.07]
                near.sort(key=lambda m: fore_aft_share(results[names[0]], m))
                if len(near) != 2:
                    rows.append(f"| {asset} | {label} | – | – | – |")
                    continue
                m = near[DIRECTIONS.index(direction)]
                low, high = m.frequency_interval_90
                rows.append(
                    f"| {asset} ({len(names)}) | {label} | {m.frequency_hz / f:.4f} "
                    f"| {low / f:.4f}–{high / f:.4f} | {m.damping_ratio / zeta:.2f} |"
                )
    return rows


def views(record: Record, seed: int) -> dict[str, Record]:
    """Return a record as fewer or noisier sensors see it, and parts of it."""
    n, rms = record.data.shape[1], np.nanstd(record.data, axis=1, keepdims=True)
    noise = 0.02 * rms * np.random.default_rng((83, seed)).standard_normal(record.data.shape)
    part = int(n * 2 / 3)
    lost = np.abs(np.arange(n) - 0.5 * n) < 0.1 * n

    def of(*rows: int) -> Record:
        return replace(record, data=record.data[list(rows)], channels=tuple(record.channels[k] for k in rows))

    return {
        "two sensors at the top": of(0, 1),
        "two at 77 m": of(2, 3),
        "four at 77 and 41 m": of(2, 3, 4, 5),
        "noise of 2 % of every channel": replace(record, data=record.data + noise),
        "the first 400 s": replace(record, data=record.data[:, :part]),
        "the last 400 s": replace(record, data=record.data[:, part // 2 :]),
        "all but 240 to 360 s": replace(record, data=np.where(lost, np.nan, record.data)),
    }


def doubts(documents: dict[str, dict], results: dict[str, Identification], folder: Path) -> list[str]:
    """Return the table of first and second bending modes that are doubtful or of unknown damping."""
    seen = {"as recorded": list(results.items())}
    for k, name in enumerate(documents):
        for view, record in views(read_record(str(folder / f"{name}.parquet")), k).items():
            seen.setdefault(view, []).append((name, identify(record)))
    rows = [
        "| seen by | of | found | ok | doubtful | damping unknown | doubts |",
        "|---|---|---|---|---|---|---|",
    ]
    for view, each in seen.items():
        near = [m for name, result in each for m in _bending(documents[name], result)]
        status = [str(m.status.value) for m in near]
        why = sorted({f.code for m in near for f in m.reasons if m.status.value == "doubtful"})
        rows.append(
            f"| {view} | {4 * len(each)} | {len(near)} | {status.count('ok')} | {status.count('doubtful')} | "
            f"{status.count('damping unknown')} | {', '.join(why) or '–'} |"
        )
    return rows


def peaks(documents: dict[str, dict[str, Any]], folder: Path) -> str:
    """Return how far the second pair's peak stands out of the spectra beside it, by where it is seen."""
    seen: dict[str, list[float]] = {}
    for name, document in documents.items():
        record = read_record(str(folder / f"{name}.parquet"))
        middle = np.mean([_true(document, f"{direction}_2")["frequency_hz"] for direction in DIRECTIONS])
        f, power = welch(record.data[:4], fs=record.sample_rate_hz, nperseg=4096)
        at = np.abs(f / middle - 1.0) < 0.05
        beside = (np.abs(f / middle - 1.0) > 0.15) & (np.abs(f / middle - 1.0) < 0.35)
        own = power[:, at].max(axis=1) / power[:, beside].max(axis=1)
        seen.setdefault("the top", []).append(float(own[:2].max()))
        seen.setdefault("77 m", []).append(float(own[2:].max()))
    said = ", ".join(f"at {place} {min(own):.2g} to {max(own):.2g}" for place, own in seen.items())
    return (
        "The largest value of a spectrum within 5 % of the second pair, over the largest 15 to 35 %\n"
        f"beside it: {said}. The turbine's mass holds the top still in these modes,\n"
        "and two sensors there do not see them."
    )


def _bending(document: dict[str, Any], result: Identification) -> list[ModalEstimate]:
    """Return what is found near the first and second pairs."""
    middle = [
        np.mean([_true(document, f"{direction}_{pair}")["frequency_hz"] for direction in DIRECTIONS])
        for pair in (1, 2)
    ]
    return [m for m in result.modes if np.min(np.abs(m.frequency_hz / np.array(middle) - 1.0)) < 0.07]


def main() -> None:
    page = Path("docs/verification/identification_openfast.md")
    given = arguments(__doc__, folder=SHIPPED, out=page)
    folder, out = given.folder, given.out
    documents = truths(folder)
    results = {n: along_axes(identify(read_record(str(folder / f"{n}.parquet")))) for n in documents}
    said = [f"- {name}: {text}" for name, result in results.items() for text in result.warnings]
    lines = [
        "# Records of an independent program",
        "",
        EXPLANATION,
        *table(cases(documents, results)),
        "",
        *fused_table(documents, results),
        "",
        "Ten minutes seen by fewer or noisier sensors, and parts of them: what is found within 7 % of both",
        "pairs, four modes a record.",
        "",
        *doubts(documents, results, folder),
        "",
        peaks(documents, folder),
        "",
        *(["Warnings:", "", *said, ""] if said else ["No warnings.", ""]),
    ]
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(lines), encoding="utf-8")
    sys.stdout.write("\n".join(lines))


if __name__ == "__main__":
    main()
