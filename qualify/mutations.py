"""Faults planted one at a time, and whether the tests of their room catch them.

A fault is a piece of text that stands once in its room, and what it becomes: a sign, a factor, a quantile, an
index off by one, a unit, swapped axes, a lock that is dropped. The room's own tests run on a copy of the
source with that fault, first those that name its module; a fault that no test fails on has survived, and is
listed with its reason.

Bar: 92 % of at least 80 faults are caught. The whole campaign takes over an hour: a verdict is kept in
``out/mutations.json``, and is not sought again while the room's source and tests stay as they are.

Usage: python qualify/mutations.py [ROOM …]
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from common.command import arguments
from common.page import write_page
from common.planted_faults import FAULTS, Fault

ROOT = Path(__file__).parents[1]
PACKAGE = Path("src") / "jackettwin"
BAR = 0.92
VERDICTS = ROOT / "out" / "mutations.json"
MOST_NEAR = 3
"""Files of tests that are tried before the room's others."""
LONGEST_S = 1800
"""After which a run of tests counts as having caught its fault: it hangs."""


def home(fault: Fault, source: Path) -> Path:
    """Return the one module of a fault's room in which its text stands.

    Raises
    ------
    LookupError
        If it stands nowhere, or more than once.
    """
    room = source / fault.room
    files = [room.with_suffix(".py")] if room.with_suffix(".py").exists() else sorted(room.rglob("*.py"))
    counts = {path: path.read_text("utf-8").count(fault.text) for path in files}
    places = [path for path, n in counts.items() if n]
    if sum(counts.values()) != 1:
        raise LookupError(f"{fault.room}: {fault.text!r} stands {sum(counts.values())} times in {places}")
    return places[0]


def code_of(tests: tuple[str, ...], copy: Path) -> int:
    """Return pytest's exit code of some tests on a copy of the source: 0 all passed, 1 some failed."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    environment = {**os.environ, "PYTHONPATH": str(copy / "src")}
    try:
        ended = subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, timeout=LONGEST_S, check=False
        )
    except subprocess.TimeoutExpired:
        return 1
    return ended.returncode


def nearest(fault: Fault, module: Path) -> tuple[str, ...]:
    """Return the test files of a fault's room that name its module, the one called like it first."""
    files = [f for tests in fault.tests for f in _test_files(ROOT / tests)]
    word = re.compile(rf"\b{module.stem}\b")
    naming = [f for f in files if f.stem == f"test_{module.stem}" or word.search(f.read_text("utf-8"))]
    naming.sort(key=lambda f: (f.stem != f"test_{module.stem}", f.stat().st_size))
    return tuple(str(f.relative_to(ROOT)) for f in naming[:MOST_NEAR])


def _test_files(place: Path) -> list[Path]:
    return [place] if place.is_file() else sorted(place.rglob("test_*.py"))


def is_caught(fault: Fault, copy: Path, whole: set[tuple[str, ...]]) -> bool:
    """Tell whether the tests of a fault's room fail on a copy of the source that has it.

    Parameters
    ----------
    whole : tests that are known to pass without a fault; others are run, and join them
    """
    near = nearest(fault, home(fault, copy / PACKAGE))
    for tests in (near, fault.tests):
        if not tests:
            continue
        if tests not in whole and code_of(tests, copy) != 0:
            sys.exit(f"without a fault {' '.join(tests)} must pass")
        whole.add(tests)
        if _fails(fault, tests, copy):
            return True
    return False


def _fails(fault: Fault, tests: tuple[str, ...], copy: Path) -> bool:
    path = home(fault, copy / PACKAGE)
    whole, stat = path.read_text("utf-8"), path.stat()
    path.write_text(whole.replace(fault.text, fault.becomes), "utf-8")
    try:
        return code_of(tests, copy) == 1  # an import that fails or no test at all is no verdict
    finally:
        path.write_text(whole, "utf-8")
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))  # what Numba compiled of it stays valid


def key(fault: Fault) -> str:
    """Return what a verdict rests on: the fault, the source of its room and the tests."""
    digest = hashlib.sha256(f"{fault.text}\0{fault.becomes}".encode())
    for start in (ROOT / PACKAGE / fault.room.split("/")[0], *(ROOT / tests for tests in fault.tests)):
        files = [start] if start.is_file() else sorted(start.rglob("*.py")) or [start.with_suffix(".py")]
        for path in files:
            digest.update(path.read_bytes())
    return digest.hexdigest()


def main() -> None:
    """Plant every fault of the rooms that are named, or of all."""
    wanted = arguments(__doc__, rooms=()).rooms
    faults = [f for f in FAULTS if not wanted or f.room.split("/")[0] in wanted]
    verdicts: dict[str, bool] = json.loads(VERDICTS.read_text("utf-8")) if VERDICTS.exists() else {}
    caught: dict[str, list[Fault]] = defaultdict(list)
    survivors: list[Fault] = []
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        shutil.copytree(ROOT / PACKAGE, copy / PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
        passing: set[tuple[str, ...]] = set()
        for fault in faults:
            if key(fault) not in verdicts:
                verdicts[key(fault)] = is_caught(fault, copy, passing)
                VERDICTS.parent.mkdir(exist_ok=True)
                VERDICTS.write_text(json.dumps(verdicts), "utf-8")
            found = verdicts[key(fault)]
            (caught[fault.room.split("/")[0]] if found else survivors).append(fault)
            print(f"{'caught  ' if found else 'SURVIVED'} {fault.room}: {fault.what}", flush=True)
    share = 1.0 - len(survivors) / len(faults)
    print(f"{len(faults) - len(survivors)} of {len(faults)} caught ({share:.0%}, bar {BAR:.0%})")
    if not wanted:
        write_page("mutations", _page(caught, survivors, len(faults)))
    sys.exit(share < BAR)


def _page(caught: dict[str, list[Fault]], survivors: list[Fault], planted: int) -> list[str]:
    rooms = sorted({*caught, *(f.room.split("/")[0] for f in survivors)})
    rows = [
        f"| {room} | {len(caught[room]) + sum(f.room.split('/')[0] == room for f in survivors)} "
        f"| {len(caught[room])} |"
        for room in rooms
    ]
    lost = [f"- `{f.room}`: {f.what}. {f.survives or 'No reason is known yet.'}" for f in survivors]
    return [
        "# Faults planted in the source",
        "",
        f"Each fault alone, against the tests of its own room: {planted - len(survivors)} of {planted} "
        f"are caught ({1.0 - len(survivors) / planted:.0%}; bar {BAR:.0%}).",
        "",
        "| room | planted | caught |",
        "|---|---|---|",
        *rows,
        "",
        "## Not caught",
        "",
        *(lost or ["None."]),
    ]


if __name__ == "__main__":
    main()
