"""Diagnosis through the whole chain: records of changed jackets are identified and their modes watched.

Usage: python qualify/diagnosis_chain.py [folder] [records of each state]

Records of two jackets, as they stand and after each of twelve causes at three sizes, are simulated and
identified (``common/chain.py``); each is a piece that is kept in the folder, so that a run that was stopped
goes on where it was. Seasons made of them are watched day by day, and what the watch says of the first alarm
is counted as in ``diagnosis.py``.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from common.chain import (
    Bench,
    Row,
    bench,
    centres,
    identified,
    late,
    louder,
    moved_to,
    own_poles,
    poles_of,
    record,
    season,
    watched_labels,
)
from common.command import arguments
from common.page import write_page
from diagnosis import SENSORS, TIMES, Case, calibration, case, jackets, name_of, page, planted, truth

from jackettwin.change.causes import _ONE_SIZE, ModelCauses, model_causes, seen_causes
from jackettwin.change.changed_structures import Happening, Standing
from jackettwin.change.event_effects import repeated
from jackettwin.change.standing_modes import Modes
from jackettwin.records import Record
from jackettwin.structure import Structure, assemble
from jackettwin.watching import Change, History, Watch, diagnose, start, step

RECORDS, BLOCK, SEASONS = 18, 6, 6
"""Records of each state, made so many of all states at a time, and seasons that each change is watched in."""
BASELINE, BEGUN, LONGEST = 365.0, 395.0, 60.0
"""Days of the baseline, day of the change, and for how long an alarm is waited for."""
NOISE = 1.0
"""Of a failing sensor: standard deviation in those of what it shows, at the least size."""
CHAINED = (
    "# Diagnosis through the whole chain",
    "",
    "`python qualify/diagnosis_chain.py`: three jackets, each with a different stiffness of its feet.",
    "{number} records of ten minutes under waves and wind before and after each of twelve causes at three",
    "sizes, with the same seeds, are simulated, identified and recognised as by a twin. Their modes",
    "with their stated standard deviations, centred on the poles of what was simulated (beside what",
    "identification is off by on average), fill the seasons of [watching](watching.md), two rows each time",
    f"that the rotor is parked: a year of baseline, then day by day until the alarm, {LONGEST:.0f} days at",
    f"most, in {SEASONS} turbines' seasons for each. Changes without an alarm by then are not",
    "counted. The friction of the loose connection is damping in proportion to mass, by what the cause",
    "states for the first mode; modes that may mix with members' own are left out of the causes. Members and",
    "feet have the names of their models: numbers are those of the OC4 jacket.",
    "",
)


@dataclass(frozen=True)
class State:
    """A jacket as it stands before or after a change: ``key`` names its pieces.

    ``friction`` of a loose joint is damping in proportion to mass, which higher modes feel less.
    """

    key: str
    cause: str
    times: int
    standing: Standing
    friction: float = 0.0
    spoil: Callable[[Record], Record] = lambda found: found


def states(jacket: str, structure: Structure) -> Iterator[State]:
    """Yield the jacket before, then after every cause and size."""
    standing = truth(structure, np.random.default_rng((32, len(jacket), 0)))
    yield State(f"{jacket}/before", "", 0, standing)
    for times in TIMES:
        for event in planted(structure):
            if times == 1 or event.spread > _ONE_SIZE:  # what is gone is gone
                after = repeated(event, times).apply(standing)
                yield State(
                    f"{jacket}/{event.name}/{times}",
                    event.name,
                    times,
                    after,
                    friction(event, standing, after),
                )
        clock = times * SENSORS["sensor: clock"]
        yield State(
            f"{jacket}/clock/{times}", "sensor: clock", times, standing, 0.0, lambda r, by=clock: late(r, by)
        )
        noise = times * NOISE
        yield State(
            f"{jacket}/noise/{times}", "sensor: more scatter", times, standing, 0.0,
            lambda r, by=noise: louder(r, by),
        )  # fmt: skip


def friction(event: Happening, before: Standing, after: Standing) -> float:
    """Return Rayleigh's α that damps the first modes as the friction of an event does."""
    if event.damps == 0.0:
        return 0.0
    omega = [Modes.of(s, assemble(s.structure, gravity=True)).modes.omega[0] for s in (before, after)]
    return float(2.0 * omega[1] * event.damps * np.log(omega[0] / omega[1]))


class Pieces:
    """Identified records, kept in a file as soon as they are made."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / "diagnosis_chain.jsonl"
        lines = self.path.read_text().splitlines() if self.path.exists() else []
        self.known: dict[str, Any] = dict(map(json.loads, lines))

    def made(self, at: State, bench: Bench, seeds: range) -> None:
        """Make what is missing of some records of a state."""
        for key, seed in ((f"{at.key}/{seed}", seed) for seed in seeds):
            if key not in self.known:
                found = at.spoil(record(bench.scenario, at.standing, seed, at.friction))
                if f"{at.key}/poles" not in self.known:
                    self._keep(f"{at.key}/poles", poles_of(found))
                self._keep(key, identified(found, bench.model))
        sys.stderr.write(f"{at.key} {seeds}\n")

    def _keep(self, key: str, found: Any) -> None:
        self.known[key] = found
        with self.path.open("a") as file:
            file.write(json.dumps([key, found]) + "\n")

    def of(self, at: State, number: int) -> list[Row]:
        """Return the modes of all records of a state."""
        return [self.known[f"{at.key}/{seed}"] for seed in range(1, number + 1)]


def make(pieces: Pieces, number: int, where: Path, stand: dict[str, tuple[Structure, str]]) -> None:
    """Make the records of all states, so many of each at a time that what is there covers all of them."""
    benches = {jacket: bench(structure, source, where) for jacket, (structure, source) in stand.items()}
    for first in range(1, number + 1, BLOCK):
        for jacket, (structure, _) in stand.items():
            for at in states(jacket, structure):
                pieces.made(at, benches[jacket], range(first, min(first + BLOCK, number + 1)))


def centred(
    pieces: Pieces, every: list[State], labels: tuple[str, ...], number: int
) -> tuple[list[list[Row]], np.ndarray]:
    """Return the records of each state, centred on its poles, and what they had been off, (n, 2).

    What identification errs by on average over all states stays in them. What it errs by beside that, in
    standard errors of each mean, is of chance or of that state.
    """
    found = [centres(pieces.of(at, number), labels) for at in every]
    errs, like = list[dict[str, np.ndarray]](), dict[str, np.ndarray]()
    for at, one in zip(every, found, strict=True):
        poles = own_poles(one, pieces.known[f"{at.key}/poles"], like)
        errs.append({n: one[n][0] - pole for n, pole in poles.items()})
        like = like or errs[0]
    usual = {n: np.median([err[n] for err in errs if n in err], axis=0) for n in labels}
    off = [(err[n] - usual[n]) / one[n][1] for err, one in zip(errs, found, strict=True) for n in err]
    by = [{n: usual[n] - err[n] for n in err} for err in errs]
    rows = [moved_to(pieces.of(at, number), own) for at, own in zip(every, by, strict=True)]
    return rows, np.array(off)


def chained(pieces: Pieces, jacket: str, structure: Structure, number: int) -> tuple[list[Case], np.ndarray]:
    """Return what became of every cause and size in one jacket, and by what its records were off."""
    every = list(states(jacket, structure))
    labels = watched_labels(pieces.of(every[0], number))
    (before, *pools), off = centred(pieces, every, labels, number)
    known = np.array([centre[0] for centre in centres(before, labels).values()])
    model = model_causes(structure, labels, *np.exp(known.T))
    after = list(zip(every[1:], pools, strict=True))
    out = [c for seed in range(SEASONS) for c in in_seasons(jacket, before, after, model, labels, seed)]
    return out, off


def in_seasons(
    jacket: str, before: list[Row], after: list[tuple[State, list[Row]]], model: ModelCauses,
    labels: tuple[str, ...], seed: int,
) -> list[Case]:  # fmt: skip
    """Return what a watch makes of every change in one turbine's seasons."""
    quiet = season(before, before, labels, BEGUN, BEGUN + LONGEST, seed)
    watch = start(quiet.between(0.0, BASELINE), patterns=model.patterns(labels))
    seen = seen_causes(model, watch.quantities, labels)
    kinds = [kind for kind, good in zip((k for k, _ in watch.quantities), seen.known, strict=True) if good]
    for day in quiet.between(BASELINE, BEGUN).by_day():
        watch, look = step(watch, day)
        if look.change is not None:
            sys.stderr.write(f"early alarm in {jacket} {seed}\n")
            return []
    out: list[Case] = []
    for at, pool in after:
        changed = season(before, pool, labels, BEGUN, BEGUN + LONGEST, seed).between(BEGUN, BEGUN + LONGEST)
        change = first_change(watch, changed)
        if change is None:
            sys.stderr.write(f"not found: {jacket} {seed} {at.cause} × {at.times}\n")
            continue
        found = diagnose(change.restricted(seen.known), seen.causes, kinds)
        out.append(case(jacket, name_of(at.cause, seen.causes), at.times, found))
    return out


def first_change(watch: Watch, days: History) -> Change | None:
    """Return the first change that a watch finds in some days."""
    for day in days.by_day():
        watch, look = step(watch, day)
        if look.change is not None:
            return look.change
    return None


def main() -> None:
    given = arguments(__doc__, folder=Path("out/qualify"), records=RECORDS)
    folder, number = given.folder, given.records
    with tempfile.TemporaryDirectory() as name:
        stand = jackets(Path(name))
        pieces = Pieces(folder)
        make(pieces, number, Path(name), stand)
    both = [chained(pieces, jacket, one, number) for jacket, (one, _) in stand.items()]
    found = [c for cases, _ in both for c in cases]
    off = np.concatenate([one for _, one in both])
    rms, far = np.sqrt(np.mean(off**2, axis=0)), 100 * np.mean(np.abs(off) > 2.0, axis=0)
    lines = page(found, CHAINED, number=number)
    lines += [
        "Means of the records beside the poles, in their standard errors, of all modes and states: rms",
        f"{rms[0]:.2f} of ln f and {rms[1]:.2f} of ln ζ; beyond two {far[0]:.0f} and {far[1]:.0f} %.",
        "",
    ]
    lines += ["| jacket | first place right | calibration error | by chance |", "|---|---|---|---|"]
    for jacket in stand:
        own = [c for c in found if c[0] == jacket]
        alone = [c[5] for c in own if not c[6]]
        error, chance, most = (100 * x for x in calibration(own))
        lines.append(
            f"| {jacket} | {sum(alone)} of {len(alone)} | {error:.1f} % | {chance:.1f} %; {most:.1f} % |"
        )
    write_page("diagnosis_chain", [*lines, ""])


if __name__ == "__main__":
    main()
