"""Cases of a long run, kept one a line, so that an interrupted run goes on where it stopped."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "out" / "qualify"

Result = dict[str, Any]


def cases(
    name: str,
    number: int,
    run: Callable[[int], Result],
    *,
    part: str = "",
    whole: bool = False,
    jobs: int = 1,
) -> list[Result]:
    """Return the results of cases 0 to number − 1; those of this very code are not computed again.

    Each result carries ``cpu_s``, the processor time that it took.

    Parameters
    ----------
    name : of the script
    part : of what the script runs, if it runs several kinds of cases
    whole : whether it runs all of the package, identification included
    jobs : processes that share the cases; a case has the same result in any of them
    """
    path = KEPT / f"{name}{part}-{digest(name, whole=whole)}.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    known = {line["case"]: line for line in map(json.loads, lines)}
    missing = [case for case in range(number) if case not in known]
    with path.open("a", encoding="utf-8") as kept, ProcessPoolExecutor(jobs) as pool:
        # one process is this one, so that an error is where it happened
        results = pool.map(run, missing) if jobs > 1 else map(run, missing)
        for case, result in zip(missing, results, strict=True):
            known[case] = {"case": case} | result
            kept.write(json.dumps(known[case]) + "\n")
            kept.flush()
            if sys.stderr.isatty():
                sys.stderr.write(f"\r{name} {len(known)}/{number}")
    return [known[case] for case in range(number)]


def digest(name: str, *, whole: bool = False) -> str:
    """Return a short hash of a script and of all code that it may call."""
    files = [ROOT / "qualify" / f"{name}.py", *sorted((ROOT / "src" / "jackettwin").rglob("*.py"))]
    layers = {"updating", "response", "soil", "structure", name}
    text = b"".join(f.read_bytes() for f in files if whole or layers & {*f.parts, f.stem})
    return hashlib.sha256(text).hexdigest()[:10]
