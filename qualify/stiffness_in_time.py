"""The stiffness through time on years whose seasons are made by other means: coverage, steps, cost.

Usage: python qualify/stiffness_in_time.py [n_histories | days] [--jobs N]

``days`` prints what days alone cost in the first history, and how fast the machine is. A history that was
computed by the same code is not computed again.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from common.cases import Result, cases
from common.pace import eigenvalue_seconds
from common.page import write_page
from common.stiffness_histories import KINDS, MODES, History, history, modes_table

from jackettwin.change import Days
from jackettwin.files import StoredSchema
from jackettwin.soil import family
from jackettwin.study.in_time.stiffness import Reference, Sensitivity, sensitivity
from jackettwin.study.in_time.track import LEARNT_DAYS, STEP_DAYS, StiffnessTrack, Tracked, resumed
from jackettwin.twin import TwinModel, TwinState, advance, empty_state, read_twin, twin_model
from jackettwin.updating import Residuals, SupportModel, Target, single, support_model

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.support.observations import estimate, observation

FIRST_SEED, LOSS, GROWN = 5000, 0.1, 1.3
"""Seeds below were used while it was written."""
ALONE = tuple(sorted({14, *LEARNT_DAYS[-3:], *range(30, 961, 70), *range(3 * STEP_DAYS, 961, 5 * STEP_DAYS)}))
"""Days of the first history whose cost alone is measured."""
KNOWN = 0.15
"""Standard deviation of ln k by all records together, as with a model error of a third of a per cent."""


@dataclass(frozen=True)
class Scored:
    """What came of one history."""

    kind: str
    told: bool
    then: float
    by_now: float
    changed: float | None
    itself: float
    pooled: float
    width: float
    records: int | None
    seconds: tuple[float, float, float]
    alone: tuple[float, ...] = ()


def state_of(h: History, model: TwinModel) -> TwinState:
    state = empty_state(model)
    for i, (start, modes, beside) in enumerate(h.records()):
        shown = {m: estimate(f, zeta, s, t) for m, (f, s, zeta, t) in modes.items()}
        seen = observation(shown, start, name=str(i), model_hash=model.model_hash, conditions=beside)
        state, _ = advance(state, seen)
    return state


def scored(h: History, told: bool, model: TwinModel, supports: SupportModel, seed: int) -> Scored:
    state, rng = state_of(h, model), np.random.default_rng((91, seed))
    targets = tuple(Target(mode, 1.0, 0.1, None, None) for mode in MODES)
    # what all records say together is off by its own standard deviation, as it should be
    off = KNOWN * rng.standard_normal()
    centre = np.log([h.k * np.exp(off), LOSS])
    about = sensitivity(single(supports, Residuals(targets, False)), centre, [0], MODES)
    assert about is not None
    draws = KNOWN * rng.standard_normal((60, 1))
    reference = Reference(centre[0] + draws)
    every, dates = Days.of(state), list(state.days)
    track, levels, spent, asked, alone = StiffnessTrack(model, every), [], [], 0.0, []
    for n, date in enumerate(dates, start=1):
        if seed == 0 and n in ALONE:
            alone.append(going_on(track, dates[:n], about, reference))
        begun = time.process_time()
        copied = n >= GROWN * asked
        asked = n if copied else asked
        if copied:  # of all records so far, at their mean stiffness
            reference = Reference(centre[0] + np.mean(np.log(h.stiffness[:n])) + draws)
        track = track.with_day(date, about, copied=copied).with_changes(reference).moved(reference)
        levels.append(track.level(reference))
        spent.append(time.process_time() - begun)
    then = np.array([level.relative for level in levels if level is not None])
    now = track.levels(reference)
    by_now = np.array([now[date].relative for date in state.days])
    itself = np.array([now[date].absolute[0] for date in state.days])
    moved = h.stiffness != 1.0
    third = len(spent) // 3
    return Scored(
        h.kind, told, held(then, h.stiffness), held(by_now, h.stiffness),
        held(by_now[moved], h.stiffness[moved]) if moved.any() else None,
        held(itself, h.k * h.stiffness), pooled(h, about.slopes),
        float(np.median(np.log(then[:, 2] / then[:, 0]))), records_to_follow(h, then),
        tuple(float(np.mean(spent[i * third : (i + 1) * third])) for i in range(3)), tuple(alone),
    )  # fmt: skip


def going_on(track: StiffnessTrack, dates: list[str], about: Sensitivity, reference: Reference) -> float:
    """Return the processor time [s] of one more day for a run that goes on from a file, all told."""
    kept = track.stored()
    assert kept is not None
    schema = StoredSchema("tracked", Tracked)
    stored = schema.dump(kept)
    begun = time.process_time()
    again = resumed(track.model, track.every, schema.load(stored), dates[:-1])
    again = again.with_day(dates[-1], about, copied=False).with_changes(reference).moved(reference)
    again.levels(reference)
    again.ahead(reference)
    schema.dump(again.stored())
    return time.process_time() - begun


def held(spans: np.ndarray, truth: np.ndarray) -> float:
    """Return the share of days on which the interval holds the truth."""
    return float(np.mean((spans[:, 0] <= truth) & (truth <= spans[:, 2])))


def pooled(h: History, slopes: np.ndarray) -> float:
    """Return what share of days the mean of all records so far holds, as ``follow`` had it."""
    weight = slopes**2 / h.std**2
    y = (h.ln_f - h.ln_f[:1]) / slopes
    mean = np.cumsum((weight * y).sum(axis=1)) / np.cumsum(weight.sum(axis=1))
    std = 1.0 / np.sqrt(np.cumsum(weight.sum(axis=1)))
    truth = np.log(h.stiffness)
    centre = mean - mean[-1] + np.mean(truth)
    return float(np.mean(np.abs(centre - truth) <= 1.645 * std))


def records_to_follow(h: History, then: np.ndarray) -> int | None:
    """Return after how many records of a step the interval holds what is, and not what was."""
    if h.kind not in ("step", "two steps"):
        return None
    before = h.stiffness[h.begun - 1]
    after = then[h.begun :]
    ok = (
        (after[:, 0] <= h.stiffness[h.begun :])
        & (h.stiffness[h.begun :] <= after[:, 2])
        & (after[:, 2] < before)
    )
    return int(np.argmax(ok)) + 1 if ok.any() else len(ok)


@cache
def world() -> tuple[TwinModel, SupportModel, tuple[np.ndarray, ...]]:
    """Return the twin, its model of supports and the frequencies of its modes by stiffness."""
    twin = replace(read_twin("thesis_table_6_1"), targets=())
    model = twin_model(twin)
    supports = support_model(
        model.structure, family=family("maxwell-3"), rayleigh=twin.rayleigh, highest_mode=6
    )
    near = supports.predict(np.array([4e8, LOSS]), MODES)
    table = modes_table(lambda x: supports.predict(np.array([np.exp(x), LOSS]), MODES, near=near).poles)
    return model, supports, table


def case(number: int) -> Result:
    """Return what came of one history."""
    begun = time.process_time()
    model, supports, table = world()
    told = (number // len(KINDS)) % 3 != 2
    h = history(FIRST_SEED + number, table, kind=KINDS[number % len(KINDS)], told=told)
    return asdict(scored(h, told, model, supports, number)) | {"cpu_s": time.process_time() - begun}


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("what", nargs="?", default="20")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    if given.what == "days":
        sys.stdout.write("\n".join(days_alone(case(0)["alone"])) + "\n")
        return
    found = cases("stiffness_in_time", int(given.what), case, whole=True, jobs=given.jobs)
    each = [{key: value for key, value in one.items() if key not in ("case", "cpu_s")} for one in found]
    write_page("stiffness_in_time", page([Scored(**one) for one in each]))


ABOUT = """\
histories of three years, a record of ten minutes on nine days of ten, ground of 1 to 5 GN/m that is known
to ± 25 %. Temperature with a delayed effect on the steel, tide, wind and unexplained variation are
harmonics, moving means and Weibull draws, none of them a process of the product; the noise is Student's t,
one value in 250 is an outlier, and stated standard deviations are 15 % wrong. In a third of the histories
no condition is given. The table has the coverage of 90 % intervals of k(t)/k(first day): estimated on the
day (column *covered on the day*), and at the end (*covered at the end*); then on those days alone on which
the stiffness differs from the first day's. While it is the same the ratio is one, which an interval that
allows no change always contains: for such days a coverage of 90 % is not possible. Then follow k(t) itself
at the end, with the uncertainty that all records together leave, and the mean of all records so far, the
earlier method of `follow`, which is given the true level.

| history | conditions | covered on the day | covered at the end | changed days | k(t) itself | \
mean of all | width | records to follow −15 % |
|---|---|---|---|---|---|---|---|---|
"""


def days_alone(seconds: Sequence[float]) -> list[str]:
    """Return what one day alone costs, from the CPU seconds of days ``ALONE``, and the machine's pace."""
    alone = dict(zip(ALONE, seconds, strict=True))
    anew = {n: spent for n, spent in alone.items() if n in LEARNT_DAYS}
    moving = [spent for n, spent in alone.items() if n >= 2 * STEP_DAYS and n % STEP_DAYS == 0]
    # the first one compiles
    rest = {n for n in alone if n not in anew and (n < 2 * STEP_DAYS or n % STEP_DAYS)} - {ALONE[0]}
    usual = [alone[n] for n in sorted(rest)]
    return [
        f"One day alone, with the state read from a file and written back: {1e3 * np.median(usual):.0f} ms "
        f"(at most {1e3 * max(usual):.0f} ms) on {len(usual)}",
        f"days between the {min(rest)}th and the {max(rest)}th; {1e3 * np.median(moving):.0f} ms (at most",
        f"{1e3 * max(moving):.0f} ms) on {len(moving)} days on which the window moves, every {STEP_DAYS}th; "
        "where effects of conditions are learnt again, "
        + ", ".join(f"{1e3 * spent:.0f} ms on day {n}" for n, spent in anew.items())
        + ".",
        f"The eigenvalues of a matrix of 800 rows take {eigenvalue_seconds():.2f} CPU-s here.",
    ]


def page(found: list[Scored]) -> list[str]:
    steps = [s.records for s in found if s.records is not None]
    first, second, third = (1e3 * np.mean([s.seconds[i] for s in found]) for i in range(3))
    number = len(found)
    head = f"`python qualify/stiffness_in_time.py {number}`: {number} {ABOUT}"
    lines = ["# Stiffness in time", "", *head.splitlines()]
    for s in found:
        cells = (
            s.kind, "given" if s.told else "not given", f"{100 * s.then:.0f} %", f"{100 * s.by_now:.0f} %",
            "" if s.changed is None else f"{100 * s.changed:.0f} %", f"{100 * s.itself:.0f} %",
            f"{100 * s.pooled:.0f} %", f"{100 * s.width:.1f} %", "" if s.records is None else str(s.records),
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    names = ("then", "by_now", "changed", "itself", "pooled")
    values = [[value for s in found if (value := getattr(s, name)) is not None] for name in names]
    mean = [f"**{100.0 * np.mean(one):.1f} %**" for one in values]
    last = f"| **all** | | {' | '.join(mean)} | | at most **{max(steps, default=0)}** |"
    cost = (
        f"A day in a run of many takes {first:.0f}, {second:.0f} and {third:.0f} ms of one core",
        "in the three years.",
        *days_alone(found[0].alone),
    )
    return [*lines, last, "", *cost]


if __name__ == "__main__":
    main()
