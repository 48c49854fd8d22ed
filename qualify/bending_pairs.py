"""What is said of the first and second bending pair of clean OpenFAST records and parts of them.

Usage: ``python qualify/bending_pairs.py [FOLDER] [--out FILE.md]``. Every ``NAME.parquet`` of the folder
(default: the shipped records) with a ``NAME.json`` beside it that holds its ``true_modes``. Of each pair
there are two members: a third is an error, a missing one is a loss, a member that is not ok is a doubt.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
from identification_openfast import SHIPPED, fore_aft_share, truths

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.records import Record, read_record

REACH = 0.07
"""Relative distance from the mean of a pair's frequencies within which a mode belongs to it."""
OUT = Path("docs/verification/bending_pairs.md")
PARTS = {
    "whole": (0.0, 1.0, 0.0),
    "first three quarters": (0.0, 0.75, 0.0),
    "last three quarters": (0.25, 1.0, 0.0),
    "first half": (0.0, 0.5, 0.0),
    "last half": (0.5, 1.0, 0.0),
    "whole, 2 % noise": (0.0, 1.0, 0.02),
}
EXPLANATION = """\
Clean records of an independent program, whole and in parts, in the rotor's axes as `identify` reads them.
*Doubts*: members of the first and second bending pair that are not ok, and why; *third*: modes reported
beyond the two members of a pair; *lost*: members not reported.
"""


def part(record: Record, first: float, last: float, noise: float, seed: int) -> Record:
    """Return a part of a record, with white noise of a share of each channel's deviation."""
    n = record.data.shape[1]
    cut = record.data[:, round(first * n) : round(last * n)]
    rng = np.random.default_rng(seed)
    drawn = noise * cut.std(axis=1, keepdims=True) * rng.standard_normal(cut.shape)
    return replace(record, data=cut + drawn)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path, nargs="?", default=SHIPPED)
    parser.add_argument("--out", type=Path, default=OUT)
    given = parser.parse_args()
    documents = truths(given.folder)
    lines = [
        *("# Bending pairs of clean records", "", EXPLANATION),
        *("`python qualify/bending_pairs.py`", ""),
        "| part | members | ok | doubts | third | lost | CPU-s a record, median / worst |",
        "|---|---|---|---|---|---|---|",
    ]
    reasons: Counter[str] = Counter()
    notes, total, doubted = [], 0, 0
    for name, (first, last, noise) in PARTS.items():
        members = ok = third = lost = 0
        seconds = []
        for k, stem in enumerate(documents):
            record = part(read_record(str(given.folder / f"{stem}.parquet")), first, last, noise, k)
            started = process_time()
            found = examine(record, IdentificationSettings()).identification
            seconds.append(process_time() - started)
            true = {m["label"]: m["frequency_hz"] for m in documents[stem]["true_modes"]}
            for pair in (1, 2):
                labels = [f"{way}_{pair}" for way in ("side_side", "fore_aft")]
                if not all(label in true for label in labels):
                    continue
                middle = np.mean([true[label] for label in labels])
                near = [m for m in found.modes if abs(m.frequency_hz / middle - 1.0) < REACH]
                near.sort(key=lambda m: fore_aft_share(found, m))
                chosen = near if len(near) < 2 else [near[0], near[-1]]
                members, lost, third = members + 2, lost + 2 - len(chosen), third + len(near) - len(chosen)
                ok += sum(m.status == "ok" for m in chosen)
                reasons.update(r.code for m in chosen for r in m.reasons)
                if len(near) != 2 or any(m.status != "ok" for m in near):
                    said = "; ".join(
                        f"{m.frequency_hz:.4f} Hz {100 * m.damping_ratio:.2f} % "
                        f"({fore_aft_share(found, m):.2f} fore-aft, {m.method}) {m.status.value}"
                        f"{''.join(' ' + r.code for r in m.reasons)}"
                        for m in near
                    )
                    notes.append(f"- {name}, {stem}, pair {pair}: {said}")
        total, doubted = total + members - lost, doubted + members - lost - ok
        lines.append(
            f"| {name} | {members} | {ok} | {members - lost - ok} | {third} | {lost} "
            f"| {np.median(seconds):.2f} / {max(seconds):.2f} |"
        )
        sys.stderr.write(lines[-1] + "\n")
    said = ", ".join(f"{code} {count}" for code, count in reasons.most_common()) or "none"
    lines += [
        "",
        f"Doubted: {doubted} of {total}, {100 * doubted / total:.1f} %. Reasons: {said}.",
        "",
        *notes,
    ]
    given.out.write_text("\n".join([*lines, ""]), encoding="utf-8")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
