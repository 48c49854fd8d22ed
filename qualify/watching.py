"""Watching on seasons made by other code: false alarms, delays, names, beside what people run today.

Usage: python qualify/watching.py [page] [quiet turbines a kind of seasons] [turbines a change]
       [of a kind without conditions] [folder of pieces]
       python qualify/watching.py speed
       python qualify/watching.py kinds [turbines a kind of seasons] [folder of pieces]
       python qualify/watching.py scours [turbines a kind of seasons] [folder of pieces]
       python qualify/watching.py short [turbines a kind of seasons] [with scour] [folder of pieces]
       python qualify/watching.py faults [turbines a fault] [folder of pieces]
       python qualify/watching.py right [turbines]
       python qualify/watching.py smallest [turbines a kind of seasons] [folder of pieces] [--model]

Each turbine is a piece that is kept in a file; a run that was stopped goes on where it was. Pieces of other
source code are not used.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from common.charts import daily, ewma, hotelling, pca_novelty, regressed
from common.page import write_page
from common.seasons import FREQUENCY_HZ, Kind, Seasons, ramp, seasons, step
from diagnosis_by_hand import LOSS, Site, paired, pile_head, solved
from scipy.stats import beta, binomtest, chi2, poisson

from jackettwin import watching
from jackettwin.change.causes import model_causes
from jackettwin.change.smallest_changes import HORIZONS_DAYS, smallest_changes
from jackettwin.decks import read_structure
from jackettwin.response.modes.labels import LOCAL
from jackettwin.watching import CHANCE, History, Look, Pattern, Watch, diagnose, general_causes, sight
from jackettwin.watching.block import Block, begin, no_begins, watched as columns_watched
from jackettwin.watching.design import Design, design_of, fresh, regressors, with_slow_processes
from jackettwin.watching.directions import SHARES, Directions, directions_of
from jackettwin.watching.hours import Hours
from jackettwin.watching.learning import OCTAVES, learn
from jackettwin.watching.memory import empty_bank, filtered
from jackettwin.watching.overshoot import calibrated
from jackettwin.watching.state import PossibleOnsets
from jackettwin.watching.watch import KINDS as KINDS_OF_QUANTITIES, STEADY_DAYS, learnt

LABELS = ("bending_1", "bending_2", "bending_3", "bending_4")
BASELINE, YEARS = 365.0, 3
ARLS = (1.0, 3.0, 10.0, 30.0)
KINDS = {
    "as described above": Kind(),
    "memory of six hours": Kind(memory="six hours"),
    "memory of a week, stds 30 % wrong": Kind(memory="week", wrong=0.3),
    "1/f from hours to a season": Kind(memory="flicker"),
    "two levels, telegraph": Kind(memory="telegraph"),
    "heavy noise, twice in storms; squares": Kind(heavy=True, curved=True, wrong=0.3),
    "common to all modes": Kind(shared=0.2, common=0.6),
    "memory of a month": Kind(memory="month"),
    "growth that goes on": Kind(growth=1e-3),
    "storms that heal": Kind(storms=2e-3),
    "ground that warms": Kind(ground=1e-3),
}
BASELINES = 75.0, 365.0
"""After which the smallest changes are told [days]: what lies beyond the shorter one is projected. A third as
many turbines have the longer one."""
SMALLEST_PLANTS = {30.0: 4, 90.0: 3, 365.0: 1}
"""Changes of each size that are planted on a turbine, by horizon [days]."""
SMALLEST_SHARES = 1.0, 0.5
"""Of the smallest size that is told, what is planted."""
SLOW = tuple(KINDS)[-4:]
"""What moves modes over weeks and years and harms nobody."""
TOLD = (
    *(((days,), (1.0,)) for days in (0.25, 2.0, 7.0)),
    (OCTAVES, (1.0 / len(OCTAVES),) * len(OCTAVES)),
)
"""Covariances of the kinds above: telegraph's is that of two days."""
SHORT_DAYS, SHORT_RECORDS = 200.0, 6.0
"""A baseline of a part of a year, and records a cluster beside it."""
QUIET_SEEDS, CHANGE_SEEDS, UNTOLD_SEEDS, SCOUR_SEEDS, SMALLEST_SEEDS = 20_000, 30_000, 40_000, 60_000, 80_000
SHORT_SEEDS, FAULT_SEEDS = 200_000, 220_000
"""Where the seeds of turbines begin; those below were used for development."""
NAMING = "causes.py", "diagnosis.py", "next_look.py"
"""Of ``watching``: what only says which cause it was."""
TWIN_HZ = (0.1757, 0.1783)
"""First pair of the reference jacket on feet of 2.5e9 N/m, to which the twin is fitted."""
PAIRS_OF_MODEL = ("side_side_1", "fore_aft_1", "side_side_2", "fore_aft_2")
"""Modes of the reference jacket that take the place of the seasons' two pairs."""
SIZES = (0.0007, 0.0014, 0.0028, 0.0056, 0.0112, 0.0225, 0.045)


def history(s: Seasons) -> History:
    beside = np.stack(list(s.conditions.values()), axis=1)
    return History(
        s.days, LABELS, s.frequency, s.frequency_std, s.damping, s.damping_std, beside, tuple(s.conditions),
        np.zeros(s.days.size, dtype=np.intp), ("all",), s.angle, s.angle_std,
    )  # fmt: skip


@cache
def patterns() -> tuple[Pattern, ...]:
    """Return what the causes of a twin, the reference jacket's, do to its two bending pairs."""
    structure, pair = read_structure("jacket15"), ("side_side_1", "fore_aft_1")
    found = model_causes(structure, pair, np.array(TWIN_HZ), np.full(2, 0.01))
    bending = [n for n in found.labels if not n.startswith((LOCAL, "torsion"))]
    return replace(found, mixed=()).patterns(bending)


def watched(
    h: History, watch: Watch, until: float = 1e9, baseline: float = BASELINE
) -> tuple[Watch, list[Look]]:
    """Return the watch and its looks up to the first alarm after the baseline, or a day."""
    looks: list[Look] = []
    for day in h.between(baseline, until).by_day():
        watch, look = watching.step(watch, day)
        looks.append(look)
        if look.change is not None:
            break
    return watch, looks


def begun_watch(h: History, arl: float) -> Watch:
    """Return the watch at the end of the baseline."""
    return watching.start(h.between(0.0, BASELINE), arl_years=arl, patterns=patterns())


# false alarms


def quiet(kind: str, seed: int, first_seed: int = QUIET_SEEDS) -> dict[str, Any]:
    """Return whether and after how many years a watch on a quiet turbine gives an alarm, by its ARL."""
    place = list(KINDS).index(kind)
    h = history(seasons(first_seed + 100 * place + seed, YEARS * 365.0, KINDS[kind]))
    h = untold(h) if first_seed == UNTOLD_SEEDS else h
    return _alarms_by_arl(h)


def _alarms_by_arl(h: History) -> dict[str, Any]:
    """Return whether and after how many years a watch gives an alarm, by its ARL."""
    baseline, out = h.between(0.0, BASELINE), {}
    before = learnt(baseline, ARLS[0], patterns())
    for arl in ARLS:
        _, looks = watched(h, calibrated(replace(before, arl_years=arl), baseline))
        out[f"{arl:g}"] = [looks[-1].change is not None, (looks[-1].day - BASELINE) / 365.25]
    return out


def of_part_of_a_year(kind: str, seed: int, *, scour_after: float | None = None) -> History:
    """Return a turbine whose records begin on any day of the year, with scour some days after a baseline."""
    place = list(KINDS).index(kind)
    begins = np.floor(np.random.default_rng((12, place, seed)).uniform(0.0, 365.0))
    some = replace(KINDS[kind], records_a_cluster=SHORT_RECORDS)
    s = seasons(SHORT_SEEDS + 100 * place + seed, begins + SHORT_DAYS + (YEARS - 1) * 365.25, some)
    if scour_after is not None:
        s = PLANTED[0].apply(s, begins + SHORT_DAYS + scour_after, np.random.default_rng(seed))
    h = history(s).between(begins, 1e9)
    return replace(h, days=h.days - begins)


def quiet_after_part_of_a_year(kind: str, seed: int) -> dict[str, Any]:
    """Return whether and after how many years a watch with a short baseline gives an alarm, by its ARL."""
    h = of_part_of_a_year(kind, seed)
    baseline, out = h.between(0.0, SHORT_DAYS), {}
    before = learnt(baseline, ARLS[0], patterns())
    for arl in ARLS:
        begun = calibrated(replace(before, arl_years=arl), baseline)
        _, looks = watched(h, begun, baseline=SHORT_DAYS)
        out[f"{arl:g}"] = [looks[-1].change is not None, (looks[-1].day - SHORT_DAYS) / 365.25]
    return out


def scour_after_part_of_a_year(kind: str, seed: int) -> float | None:
    """Return after how many days scour is found after a short baseline; negative if before it came."""
    after = np.random.default_rng((13, list(KINDS).index(kind), seed)).uniform(20.0, 200.0)
    h = of_part_of_a_year(kind, seed, scour_after=after)
    begun = watching.start(h.between(0.0, SHORT_DAYS), patterns=patterns())
    _, looks = watched(h, begun, SHORT_DAYS + after + 365.0, SHORT_DAYS)
    return None if looks[-1].change is None else looks[-1].day - SHORT_DAYS - after


def short(pieces: dict[str, Any]) -> list[str]:
    """Return the section on baselines of a part of a year."""
    lines = [
        "## Baselines of 200 days",
        "",
        "They begin on any day of the year; about 1,200 records a year; otherwise as above.",
        "",
        "| seasons | ARL [years] | alarms | years watched | promised | ratio | chance |",
        "|---|---|---|---|---|---|---|",
    ]
    slow = [one for kind in SLOW for one in _of(pieces, f"short/quiet/{kind}/")]
    lines += _counted("**slow and benign**", slow)
    lines += _counted("**all**", _of(pieces, "short/quiet/"))
    table = scours({name.removeprefix("short/"): value for name, value in pieces.items()})
    return [*lines, "", *table[2:]]


# conditions at fault


def _with_gaps(h: History, rng: np.random.Generator) -> tuple[History, float]:
    """Return 40 to 70 % of the days, in blocks, and any day after the baseline."""
    share, off = rng.uniform(0.3, 0.6), rng.uniform(4.0, 15.0)
    there, day = np.ones(int(h.days[-1]) + 2, dtype=bool), 0
    while day < there.size:
        day += 1 + int(rng.geometric(min(share / (off * (1.0 - share)), 1.0)))
        gap = int(rng.geometric(1.0 / off))
        there[day : day + gap] = False
        day += gap
    return h.rows(there[np.floor(h.days).astype(int)]), BASELINE + rng.uniform(20.0, 200.0)


def _with_still_wind(h: History, rng: np.random.Generator) -> tuple[History, float]:
    """Return the records with a wind that stays as it is for 60 to 150 days, and a day in its first month."""
    begins = BASELINE + rng.uniform(10.0, 300.0)
    place, conditions = h.condition_names.index("wind_speed_m_s"), h.conditions.copy()
    still = (h.days >= begins) & (h.days < begins + rng.uniform(60.0, 150.0))
    conditions[still, place] = conditions[np.argmax(still), place]
    return replace(h, conditions=conditions), begins + rng.uniform(5.0, 30.0)


def _without_waves(h: History, rng: np.random.Generator) -> tuple[History, float]:
    kept = [name != "hs_m" for name in h.condition_names]
    names = tuple(name for name, k in zip(h.condition_names, kept, strict=True) if k)
    return _with_still_wind(replace(h, conditions=h.conditions[:, kept], condition_names=names), rng)


FAULTS: dict[str, Callable[[History, np.random.Generator], tuple[History, float]]] = {
    "gaps of 30 to 60 % of the days": _with_gaps,
    "wind stands still for months": _with_still_wind,
    "the same, waves not measured": _without_waves,
}
"""What is wrong with the records, and when scour comes."""
FAULT_KINDS = "as described above", "heavy noise, twice in storms; squares", "storms that heal"


def _at_fault(fault: str, seed: int, *, scoured: bool) -> tuple[History, float]:
    place, kind = list(FAULTS).index(fault), FAULT_KINDS[seed % len(FAULT_KINDS)]
    some = replace(KINDS[kind], records_a_cluster=SHORT_RECORDS)
    s = seasons(FAULT_SEEDS + 100 * place + seed, YEARS * 365.0, some)
    _, begun = FAULTS[fault](history(s), np.random.default_rng((14, place, seed)))
    rng = np.random.default_rng((14, place, seed))
    return FAULTS[fault](history(PLANTED[0].apply(s, begun, rng) if scoured else s), rng)[0], begun


def quiet_at_fault(fault: str, seed: int) -> dict[str, Any]:
    """Return whether and after how many years a watch on a quiet turbine gives an alarm, by its ARL."""
    h, _ = _at_fault(fault, seed, scoured=False)
    return _alarms_by_arl(h)


def scour_at_fault(fault: str, seed: int) -> float | None:
    """Return after how many days scour is found; negative if before it came."""
    h, begun = _at_fault(fault, seed, scoured=True)
    _, looks = watched(h, begun_watch(h, 10.0), begun + 365.0)
    return None if looks[-1].change is None else looks[-1].day - begun


def faults(pieces: dict[str, Any]) -> list[str]:
    """Return the section on gaps and a wind that stands still."""
    lines = [
        "## Gaps, and a wind sensor that stands still",
        "",
        f"A year of baseline, two years watched; in turn seasons {', '.join(FAULT_KINDS)}.",
        "",
        "| records | ARL [years] | alarms | years watched | promised | ratio | chance |",
        "|---|---|---|---|---|---|---|",
    ]
    for fault in FAULTS:
        lines += _counted(fault, _of(pieces, f"quiet/{fault}/"))
    lines += ["", "| records | scour found | median delay [d] | alarms before |", "|---|---|---|---|"]
    for fault in FAULTS:
        lines.append(_found_in(fault, _of(pieces, f"scour/{fault}/")))
    return [*lines, ""]


def untold(h: History) -> History:
    """Return the same modes without any condition beside them."""
    return replace(h, conditions=np.zeros((h.days.size, 0)), condition_names=())


def one_mode(days: np.ndarray, ln_f: np.ndarray) -> History:
    """Return one mode at noon of each day, known to a thousandth, with a temperature that does not act."""
    f, none = 0.3 * np.exp(ln_f)[:, None], np.full((days.size, 1), np.nan)
    swing = 10.0 + 8.0 * np.sin(2.0 * np.pi * days / 60.0)
    return History(
        days, ("one",), f, 1e-3 * f, none, none, swing[:, None], ("temperature_c",),
        np.zeros(days.size, dtype=np.intp),
    )  # fmt: skip


def right(seed: int, watch: Watch) -> list[Any]:
    """Return whether and after how many years a watch alarms whose days are drawn from what it predicts.

    Its models, their weights and the uncertainty of its baseline are then right, so that E[R_t] is the prior
    weight of t days.
    """
    rng = np.random.default_rng((78, seed))
    days = BASELINE + 0.5 + np.arange(int((YEARS - 1) * 365.25))
    weights, considered = watch.blocks[0].log_weights, watch.considered
    model = rng.choice(weights.size, p=np.exp(weights) / np.exp(weights).sum())
    for day in days:
        block = watch.blocks[0]
        rows, _ = regressors(watch.design, one_mode(np.array([day]), np.zeros(1)), watch.lagged)
        none = np.zeros((1, 1))
        hour = Hours(np.array([day]), rows, none, none + 1e-6, none, none)
        belief = block.beliefs[model]
        ahead = filtered(block.memories[model], belief, empty_bank(1, belief.mean.size), hour, watch.last_day)
        ln_f = rng.normal(-ahead.innovation[0, 0], np.sqrt(ahead.spread[0, 0]))
        watch, look = watching.step(watch, one_mode(np.array([day]), ln_f + np.log(block.typical / 0.3)))
        if look.change is not None:
            break
        # a share of the weights returns to those of the baseline, now and then
        back = -np.expm1(-(watch.considered - considered) / STEADY_DAYS)
        considered, weights = watch.considered, watch.blocks[0].log_prior
        if rng.random() < back:
            model = rng.choice(weights.size, p=np.exp(weights) / np.exp(weights).sum())
    return [look.change is not None, float(day - BASELINE) / 365.25]


def right_models(turbines: int) -> list[str]:
    """Return the table of false alarms where the model is right; a baseline serves for eight turbines."""
    found = []
    for seed in range(turbines):
        if seed % 8 == 0:
            rng, days = np.random.default_rng((79, seed)), np.arange(int(BASELINE)) + 0.5
            keep, slow = np.exp(-1.0 / 7.0), [rng.standard_normal()]
            for _ in days[1:]:
                slow.append(keep * slow[-1] + np.sqrt(1.0 - keep**2) * rng.standard_normal())
            baseline = one_mode(days, 1e-3 * (np.array(slow) + rng.standard_normal(days.size)))
            begun = {f"{arl:g}": watching.start(baseline, arl_years=arl) for arl in ARLS}
        found.append({arl: right(seed, watch) for arl, watch in begun.items()})
        sys.stderr.write(f"right {seed}\n")
    return [
        "| model | ARL [years] | alarms | years watched | promised | ratio | chance |",
        "|---|---|---|---|---|---|---|",
        *_counted("right, one mode", found),
    ]


def false_alarms(pieces: dict[str, Any]) -> list[str]:
    """Return the section on turbines of which nothing changes; the last rows are of all kinds."""
    number = len(_of(pieces, f"quiet/{next(iter(KINDS))}/"))
    lines = [
        "## False alarms",
        "",
        f"{number} turbines of each kind, one year of baseline and {YEARS - 1} of watching; nothing changes.",
        "Turbines with an alarm, years watched until then, the alarms that are promised in that time;",
        "their ratio with its 95 % interval (Garwood), and the chance of as many or more if the promise is",
        "just kept.",
        "",
        "| seasons | ARL [years] | alarms | years watched | promised | ratio | chance |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in KINDS:
        lines += _counted(kind, _of(pieces, f"quiet/{kind}/"))
    slow = [one for kind in SLOW for one in _of(pieces, f"quiet/{kind}/")]
    lines += _counted(f"**slow and benign** ({', '.join(SLOW)})", slow)
    lines += _counted("**all**", _of(pieces, "quiet/"))
    without = _of(pieces, "untold/quiet/")
    if not without:
        return [*lines, ""]
    lines += _counted(f"**conditions not given** ({len(without)} turbines of all kinds)", without)
    found = [d for d in _of(pieces, "untold/scour/") if d is not None and d >= 0.0]
    number = len(_of(pieces, "untold/scour/"))
    return [
        *lines,
        "",
        f"Without conditions, scour of −0.2 % is found in {len(found)} of {number} within a year, median",
        f"{np.median(found):.0f} days.",
        "",
    ]


def _counted(name: str, found: list[Any]) -> list[str]:
    lines = []
    for arl in ARLS:
        n, years = np.sum([one[f"{arl:g}"] for one in found], axis=0)
        chance = poisson.sf(n - 1, years / arl)
        low, high = (chi2.ppf(0.025, 2 * n) / 2 if n else 0.0), chi2.ppf(0.975, 2 * n + 2) / 2
        share = arl / years
        lines.append(
            f"| {name} | {arl:g} | {n:.0f} | {years:.1f} | {years / arl:.1f} | "
            f"{n * share:.2f} ({low * share:.2f} to {high * share:.2f}) | {chance:.2f} |"
        )
    return lines


def untold_scour(seed: int) -> float | None:
    """Return after how many days scour is found if nobody tells the conditions, or None."""
    s, begun = planted_turbine(PLANTED[0], seed)
    h = untold(history(s))
    _, looks = watched(h, begun_watch(h, 10.0), begun + 365.0)
    return None if looks[-1].change is None else looks[-1].day - begun


def scour(kind: str, seed: int) -> float | None:
    """Return after how many days scour is found in seasons of a kind, or None; negative if before it came."""
    place = list(KINDS).index(kind)
    rng = np.random.default_rng((9, place, seed))
    begun = BASELINE + rng.uniform(20.0, 200.0)
    s = seasons(SCOUR_SEEDS + 100 * place + seed, BASELINE + 600.0, KINDS[kind])
    h = history(PLANTED[0].apply(s, begun, rng))
    _, looks = watched(h, begun_watch(h, 10.0), begun + 365.0)
    return None if looks[-1].change is None else looks[-1].day - begun


def scours(pieces: dict[str, Any]) -> list[str]:
    every = {kind: _of(pieces, f"scour/{kind}/") for kind in KINDS}
    lines = [
        "## Scour in seasons of every kind",
        "",
        "−0.2 % on the first pair, ARL 10 years; delays are medians over those found within a year.",
        "",
        "| seasons | found | median delay [d] | alarms before |",
        "|---|---|---|---|",
    ]
    for kind, delays in [*every.items(), ("**all**", [d for each in every.values() for d in each])]:
        lines.append(_found_in(kind, delays))
    return [*lines, ""]


def _found_in(name: str, delays: list[float | None]) -> str:
    early = sum(d is not None and d < 0.0 for d in delays)
    found = [d for d in delays if d is not None and d >= 0.0]
    median = f"{np.median(found):.0f}" if found else "–"
    return f"| {name} | {len(found)} of {len(delays) - early} | {median} | {early} |"


def _of(pieces: dict[str, Any], start: str) -> list[Any]:
    return [value for name, value in pieces.items() if name.startswith(start)]


# changes


@dataclass(frozen=True)
class Planted:
    """A change and what it must be named."""

    name: str
    apply: Callable[[Seasons, float, np.random.Generator], Seasons]
    right: Callable[[str], bool]


def _sensor(s: Seasons, day: float, rng: np.random.Generator) -> Seasons:
    chosen = rng.permutation(4)[:2]
    on = ((s.days >= day) & (s.days < day + 10.0))[:, None] & np.isin(np.arange(4), chosen)
    noisier = np.sqrt(8.0) * s.noise_std * rng.standard_normal(on.shape)  # threefold scatter in all
    louder = np.sqrt(8.0) * (s.damping_std / s.damping) * rng.standard_normal(on.shape)
    turning = np.sqrt(8.0) * s.angle_std * rng.standard_normal(on.shape)
    after = s.changed(np.where(on, 0.001 + noisier, 0.0), np.where(on, louder, 0.0))
    return replace(after, angle=s.angle + np.where(on, turning, 0.0))


PLANTED = (
    Planted(
        "scour, −0.2 % on the first pair",
        lambda s, d, _: s.changed(step(s.days, d, np.array([-0.002, -0.002, 0, 0]))),
        lambda cause: cause.startswith("bending_1"),
    ),
    Planted(
        "mass, −0.25 % on all modes",
        lambda s, d, _: s.changed(step(s.days, d, np.full(4, -0.0025))),
        lambda cause: cause == "all modes alike",
    ),
    Planted(
        "ramp, −0.5 % in 150 days on the second pair",
        lambda s, d, _: s.changed(ramp(s.days, d, 150.0, np.array([0, 0, -0.005, -0.005]))),
        lambda cause: cause.startswith("bending_3"),
    ),
    Planted(
        "damping, +25 % on the first pair",
        lambda s, d, _: s.changed(0.0 * s.frequency, step(s.days, d, np.log([1.25, 1.25, 1, 1]))),
        lambda cause: cause.startswith("damping of"),
    ),
    Planted("sensor, ten days", _sensor, lambda cause: cause.startswith("sensor")),
)


def planted_turbine(planted: Planted, seed: int) -> tuple[Seasons, float]:
    """Return seasons with a change, and when it begins."""
    rng = np.random.default_rng((9, seed))
    begun = BASELINE + rng.uniform(20.0, 200.0)
    return planted.apply(seasons(CHANGE_SEEDS + seed, BASELINE + 600.0), begun, rng), begun


def changed(place: int, seed: int) -> dict[str, Any]:
    """Return what became of one change: days until the alarm, and whether it was named and dated."""
    planted = PLANTED[place]
    s, begun = planted_turbine(planted, seed)
    h, days = history(s), 14.0 if planted.name.startswith("sensor") else 365.0
    watch, looks = watched(h, begun_watch(h, 10.0), begun + days)
    change = looks[-1].change
    if change is None:
        return {"delay": None}
    causes = general_causes(watch.quantities, LABELS, FREQUENCY_HZ)
    best = diagnose(change, causes, [k for k, _ in watch.quantities]).verdicts[0].cause
    low, high = change.began_interval_90
    return {
        "delay": change.day - begun, "best": best, "named": planted.right(best), "dated": low <= begun <= high
    }  # fmt: skip


def changes(pieces: dict[str, Any]) -> list[str]:
    number = len(_of(pieces, "changed/0/"))
    lines = [
        "## Changes",
        "",
        f"{number} turbines each, ARL 10 years, one year of baseline; the change comes 20 to 200 days later.",
        "Named: the most probable cause without a model is the right pattern. Interval: number of 90 %",
        "intervals that contain the onset. Alarms before the onset (early) are not counted as found.",
        "",
        "| change | found | median delay [d] | 90 % | longest | named | began in interval | early |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for place, planted in enumerate(PLANTED):
        all_of = _of(pieces, f"changed/{place}/")
        early = sum(one["delay"] is not None and one["delay"] < 0.0 for one in all_of)
        found = [one for one in all_of if one["delay"] is not None and one["delay"] >= 0.0]
        d = np.array([one["delay"] for one in found])
        named, dated = (f"{sum(one[key] for one in found)} of {d.size}" for key in ("named", "dated"))
        lines.append(
            f"| {planted.name} | {d.size} of {len(all_of) - early} | {np.median(d):.0f} | "
            f"{np.quantile(d, 0.9):.0f} | {d.max():.0f} | {named} | {dated} | {early} |"
        )
    return [*lines, ""]


# the smallest changes that an owner is told


def smallest(kind: str, baseline: float, seed: int) -> list[Any]:
    """Return what became of changes of the smallest sizes that are told, and of half of them.

    Of each: horizon, size, whether projected, whether found, name, share of the size, and the probability
    that is told of it. Changes of one horizon begin 40 days apart, each on a watch that has seen none; those
    after a false alarm are left out.
    """
    place = list(KINDS).index(kind)
    rng = np.random.default_rng((10, place, seed))
    onsets = np.floor(baseline + rng.uniform(5.0, 25.0)) + 40.0 * np.arange(max(SMALLEST_PLANTS.values()))
    some = replace(KINDS[kind], records_a_cluster=SHORT_RECORDS)
    s = seasons(SMALLEST_SEEDS + 100 * place + seed, onsets[-1] + HORIZONS_DAYS[-1] + 1.0, some)
    learning = history(s).between(0.0, baseline)
    watch = watching.start(learning)
    told = {one.days: one for one in smallest_changes(watch, learning, None) if one.size is not None}
    seen = {days: sight(watch, learning, days) for days in told}
    before, day = [], baseline
    for onset in onsets:
        for records in history(s).between(day, onset).by_day():
            watch, look = watching.step(watch, records)
            if look.change is not None:
                break
        else:
            before.append(watch)
            day = onset
            continue
        break
    out = []
    for days, one in told.items():
        for share in SMALLEST_SHARES:
            planted = np.full(4, -share * one.size)
            claimed = seen[days].chance(_alike(watch.quantities, planted[0]))
            for watch, onset in list(zip(before, onsets, strict=False))[: SMALLEST_PLANTS[days]]:
                h, now, found = history(s.changed(step(s.days, onset, planted))), watch, False
                for records in h.between(onset, onset + days).by_day():
                    now, look = watching.step(now, records)
                    found = look.change is not None
                    if found:
                        break
                out.append([days, one.size, one.projected, found, "all modes alike", share, claimed])
    return out


def _alike(quantities: Sequence[tuple[str, int]], size: float) -> np.ndarray:
    """Return the change of all frequencies by as much, and of nothing else, (1, m_all)."""
    return np.array([[size if kind == "frequency" else 0.0 for kind, _ in quantities]])


def smallest_of_model(kind: str, baseline: float, seed: int) -> list[Any] | None:
    """Return the same of a structure's changes: scour at all feet and softening, as changes to the drawing.

    The feet differ from the model's, whose causes are computed from the baseline's frequencies.
    """
    place, structure = list(KINDS).index(kind), read_structure("jacket15")
    rng = np.random.default_rng((11, place, seed))
    apart = np.exp(0.4 * rng.standard_normal(3))[[0, 0, 2]]
    feet = pile_head(0.0) * apart * np.exp(0.1 * rng.standard_normal((len(structure.reaction_nodes), 3)))
    site = Site(structure, feet)
    before = solved(site)
    chosen = [before.labels.index(label) for label in PAIRS_OF_MODEL]
    begun = baseline + rng.uniform(5.0, 25.0)
    s = seasons(SMALLEST_SEEDS + 100 * place + seed, begun + HORIZONS_DAYS[-1] + 1.0, KINDS[kind])

    def of_site(s: Seasons) -> History:
        """Return the seasons' modes as those of the structure."""
        own = history(s)
        scale = before.frequency_hz[chosen] / FREQUENCY_HZ
        return replace(
            own, labels=PAIRS_OF_MODEL, frequency=own.frequency * scale,
            frequency_std=own.frequency_std * scale, angle=np.full_like(own.angle, np.nan),
        )  # fmt: skip

    learning = of_site(s).between(0.0, baseline)
    f, zeta = np.nanmedian(learning.frequency, axis=0), np.nanmedian(learning.damping, axis=0)
    causes = model_causes(structure, PAIRS_OF_MODEL, f, zeta, seed=seed)
    watch = watching.start(learning, patterns=causes.patterns(PAIRS_OF_MODEL))
    told = [one for one in smallest_changes(watch, learning, causes) if one.size is not None]
    for day in of_site(s).between(baseline, np.floor(begun)).by_day():
        watch, look = watching.step(watch, day)
        if look.change is not None:
            return None
    out = []
    for one in told:
        softer = 1.0 - one.size if one.change == "soil softening" else pile_head(one.size) / pile_head(0.0)
        after = solved(replace(site, feet=feet * softer))
        at = paired(before, after, chosen)
        ln_f = np.log(after.frequency_hz[at] / before.frequency_hz[chosen])
        more = 0.5 * LOSS * (after.soil_share[at] - before.soil_share[chosen])
        ln_zeta = np.log1p(more / zeta)
        h = of_site(s.changed(step(s.days, begun, ln_f), step(s.days, begun, ln_zeta)))
        now = watch
        for day in h.between(np.floor(begun), begun + one.days).by_day():
            now, look = watching.step(now, day)
            if look.change is not None:
                break
        found = look.change is not None
        out.append([one.days, one.size, one.projected, found, one.change, 1.0, CHANCE])
    return out


def smallest_found(pieces: dict[str, Any], name: str) -> list[str]:
    """Return the table of the smallest changes that were told and planted.

    The last column is the chance of a share as far from the told one, on either side.
    """
    columns = "change", "baseline [days]", "within [days]", "projected", "size, median", *_FOUND
    lines = [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
    every = []
    for baseline in BASELINES:
        turbines = [one for one in _of(pieces, f"{name}/{baseline:g}/") if one is not None]
        rows = [(*row, (baseline, k)) for k, one in enumerate(turbines) for row in one]
        every += rows
        for change in dict.fromkeys(row[4] for row in rows):
            for days, share in product(HORIZONS_DAYS, SMALLEST_SHARES):
                told = [row for row in rows if row[0] == days and row[4] == change and row[5] == share]
                if told:
                    size = share * np.median([row[1] for row in told])
                    shown = f"{size:.2f} m" if change.startswith("scour") else f"{100.0 * size:.2f} %"
                    lines.append(
                        f"| {change} | {baseline:g} | {days:g} | {'yes' if told[0][2] else 'no'} | {shown} | "
                        f"{_found_of(told)} |"
                    )
    for share in SMALLEST_SHARES:
        told = [row for row in every if row[5] == share]
        if told:
            lines.append(f"| **all**, {share:g} of the size | | | | | {_found_of(told)} |")
    return [*lines, ""]


_FOUND = "told [%]", "found", "95 % interval [%]", "chance"


def _found_of(told: list[Any]) -> str:
    """Return what is told and found, its interval, and the chance of it if what is told is true.

    Changes of one turbine have its baseline in common, so that they count as fewer (Korn & Graubard 1998): as
    many as give the variance of the share between turbines.
    """
    n, found = len(told), sum(row[3] for row in told)
    claimed, share = float(np.mean([row[6] for row in told])), found / n
    turbines = list(dict.fromkeys(row[7] for row in told))
    apart = [sum(row[3] - share for row in told if row[7] == one) for one in turbines]
    variance = sum(x * x for x in apart) / n**2
    worth = min(share * (1.0 - share) / variance, n) if variance > 0.0 else len(turbines)
    hits = share * worth
    low = beta.ppf(0.025, hits, worth - hits + 1.0) if found else 0.0
    high = beta.ppf(0.975, hits + 1.0, worth - hits) if found < n else 1.0
    chance = binomtest(round(hits), round(worth), claimed).pvalue
    return f"{100 * claimed:.0f} | {found} of {n} | {100 * low:.0f} to {100 * high:.0f} | {chance:.3f}"


# what the seasons' information allows


def informed(seed: int) -> dict[str, Any]:
    """Return the delays of the same statistic for scour, told the list of covariances, and what changes."""
    s, begun = planted_turbine(PLANTED[0], seed)
    h = history(s)
    baseline = h.between(0.0, BASELINE)
    design = with_slow_processes(design_of(baseline), baseline)
    rows, lagged = regressors(design, baseline, fresh(design, baseline))
    blocks = tuple(_told(baseline, design, rows, kind) for kind in KINDS_OF_QUANTITIES)
    last = float(baseline.days[-1])

    def delay(told: tuple[Block, ...]) -> float | None:
        empty = np.zeros(0)
        none = np.zeros((0, sum(len(block.kept) for block in told), 3))
        watch = Watch(
            LABELS, design, lagged, told, PossibleOnsets(empty, empty, empty, none),
            last, float(np.floor(last)), last, 10.0,
        )  # fmt: skip
        watch = calibrated(watch, baseline)
        # nothing is staked on what is left out: what the watch adds for its share is taken off
        staked, all_staked = (
            SHARES["scatter"] + sum(SHARES[block.kind] for block in some) for some in (told, blocks)
        )
        lost = np.log(staked / all_staked)
        for day in h.between(BASELINE, begun + 365.0).by_day():
            watch, look = watching.step(watch, day)
            if look.log_r + lost >= watch.log_threshold or look.change is not None:
                return look.day - begun
        return None

    pair = {sizes: (replace(blocks[0], directions=_falling_pair(sizes)),) for sizes in ((0.002,), SIZES)}
    return {"size": delay(pair[0.002,]), "direction": delay(pair[SIZES]), "covariances": delay(blocks)}


def _told(baseline: History, design: Design, rows: np.ndarray, kind: str) -> Block:
    """Return what a baseline teaches of one kind of quantity who is told the list of covariances."""
    columns = columns_watched(baseline, kind)
    labels = tuple(LABELS[q] for q in columns)
    bets = directions_of(kind, labels, FREQUENCY_HZ[columns], patterns() if kind == "frequency" else ())
    block, hours = begin(baseline, design, rows, kind, bets, columns)
    learnt = learn(hours, design.coefficients(block.spread), told=TOLD)
    return replace(
        block, memories=learnt.memories, beliefs=learnt.beliefs,
        banks=no_begins(len(columns), learnt.beliefs),
        log_weights=learnt.log_weights, log_prior=learnt.log_weights,
    )  # fmt: skip


def _falling_pair(sizes: tuple[float, ...]) -> Directions:
    """Return the one bet that the first pair falls by one of some sizes."""
    number = len(sizes)
    weights = np.log(np.concatenate([np.ones(number), np.full(number, 1e-9)]) / number)
    return Directions(
        "frequency", ("pair", "any"), np.ones((2, 4), dtype=bool), np.array([[1.0, 1.0, 0.0, 0.0]]),
        np.array([0.0, -np.inf]), np.array([*(-x for x in sizes), *sizes]), np.full(2 * number, 1e-6),
        weights[None],
    )  # fmt: skip


def information(pieces: dict[str, Any]) -> list[str]:
    seeds = [name.split("/")[1] for name in pieces if name.startswith("informed/")]
    both = [(pieces[f"changed/0/{seed}"], pieces[f"informed/{seed}"]) for seed in seeds]
    told = ("covariances", "direction", "size")
    rows = [(ours["delay"], *(other[key] for key in told)) for ours, other in both]
    kept = np.array([[np.inf if x is None else x for x in row] for row in rows if (row[0] or 0.0) >= 0.0])
    ours, *bounds = np.median(kept, axis=0)
    lines = [
        "## Bound of the detection delay",
        "",
        "The same statistic with the covariances of these seasons (but not which one a turbine has, nor",
        "how large) and the same prior weights. No detector with the same false alarm rate that looks",
        "for the same changes is faster on average over these seasons",
        "([theory](../theory/watching.md#bound-of-the-detection-delay)).",
        "Below it the delay if the change were known in advance: that the first pair falls, and by how much.",
        f"Scour on {len(kept)} turbines, medians in days; this detector {ours:.1f}:",
        "",
        "| known | median delay [d] | ratio of this detector |",
        "|---|---|---|",
    ]
    names = ("the covariances: the bound", "and that the first pair falls", "and by 0.2 %")
    lines += [f"| {n} | {x:.1f} | {ours / x:.2f} |" for n, x in zip(names, bounds, strict=True)]
    return [*lines, ""]


# what people run today

CHARTS = ("regression, EWMA", "regression, T²", "PCA novelty")


def charted(seed: int) -> dict[str, Any]:
    """Return by chart when a quiet turbine alarms, how far over the limit it comes, and the same of scour."""
    out: dict[str, Any] = {}
    s = seasons(QUIET_SEEDS + seed, YEARS * 365.0)
    hurt, begun = planted_turbine(PLANTED[0], seed)
    after = _charted(hurt)
    for name, (days, ratio) in _charted(s).items():
        over = np.flatnonzero(ratio >= 1.0)
        years = ((days[over[0]] if over.size else days[-1]) - BASELINE) / 365.25
        later, how_far = after[name]
        chosen = (later >= begun) & (later < begun + 365.0)
        rising = np.maximum.accumulate(how_far[chosen])
        out[name] = [
            over.size > 0, float(years), float(ratio.max()), (later[chosen] - begun).tolist(), rising.tolist()
        ]  # fmt: skip
    return out


def charts(pieces: dict[str, Any]) -> list[str]:
    found = _of(pieces, "charted/")
    lines = [
        "## Usual control charts",
        "",
        "Daily medians, same conditions and their squares, limits for one alarm in ten years if residuals",
        f"were independent and normal; {len(found)} quiet turbines, and scour after the limits were raised,",
        "in hindsight, to one alarm in ten years on these turbines.",
        "",
        "| chart | turbines with false alarms | limit raised by | scour found in a year | median delay [d] |",
        "|---|---|---|---|---|",
    ]
    for name in CHARTS:
        alarms, years, highest = zip(*(one[name][:3] for one in found), strict=True)
        # one alarm in ten years: after two years a share exp(−0.2) of the turbines is quiet
        limit = float(np.quantile(highest, np.exp(-0.2)))
        d = np.array([
            next((day for day, far in zip(*one[name][3:], strict=True) if far >= limit), np.inf)
            for one in found
        ])  # fmt: skip
        median = "over 365" if np.isinf(np.median(d)) else f"{np.median(d):.0f}"
        lines.append(
            f"| {name} | {sum(alarms)} of {len(found)} in {sum(years):.0f} years | {limit:.2f} | "
            f"{np.isfinite(d).sum()} of {len(found)} | {median} |"
        )
    return [*lines, ""]


def _charted(s: Seasons) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    looks = 10.0 * 120.0  # days with records in ten years
    days, y, x = daily(s.days, np.log(s.frequency), np.stack(list(s.conditions.values()), axis=1))
    learning = days < BASELINE
    rest = regressed(y, x, learning)
    after = days[~learning]
    ratios = ewma(rest, learning, looks), hotelling(rest, learning, looks), pca_novelty(y, learning, looks)
    return {name: (after, ratio) for name, ratio in zip(CHARTS, ratios, strict=True)}


def speed() -> list[str]:
    h = history(seasons(1, YEARS * 365.0))
    watch = watching.start(h.between(0.0, BASELINE), arl_years=1e4, patterns=patterns())
    for day in h.between(BASELINE, BASELINE + 3.0).by_day():
        watching.step(watch, day)  # compiled before the clock runs
    began = time.process_time()
    watch = watching.start(h.between(0.0, BASELINE), arl_years=1e4, patterns=patterns())
    learnt = time.process_time() - began
    each = []
    for day in h.between(BASELINE, 1e9).by_day():
        began = time.process_time()
        watch, _ = watching.step(watch, day)
        each.append(time.process_time() - began)
    matrix = np.random.default_rng(0).standard_normal((800, 800))
    began = time.process_time()
    np.linalg.eig(matrix)
    unit = time.process_time() - began
    year = sum(each) / (YEARS - 1)
    first, last = 1e3 * float(np.mean(each[:100])), 1e3 * float(np.mean(each[-100:]))
    scale = 0.8 / unit
    return [
        "## Speed",
        "",
        "`python qualify/watching.py speed`, with the directions of pairs: CPU time where a dense 800×800",
        f"`numpy.linalg.eig` takes {unit:.2f} s; in brackets, 0.8 s.",
        "",
        "| what | CPU |",
        "|---|---|",
        f"| a baseline of a year learnt | {learnt:.2f} s ({scale * learnt:.2f}) |",
        f"| a turbine-year watched | {year:.2f} s ({scale * year:.2f}) |",
        f"| a day, mean of the first hundred | {first:.1f} ms ({scale * first:.1f}) |",
        f"| a day, mean of the last hundred | {last:.1f} ms ({scale * last:.1f}) |",
        "",
    ]


# pieces


def pieces_of(kinds: int, number: int, without: int) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield every piece by name; what is done first covers all tables but those without conditions."""
    for seed in range(max(kinds, number)):
        if seed < number:
            for place in range(len(PLANTED)):
                yield f"changed/{place}/{seed}", lambda p=place, s=seed: changed(p, s)
            yield f"charted/{seed}", lambda s=seed: charted(s)
            if seed % 2 == 0:
                yield f"informed/{seed}", lambda s=seed: informed(s)
        if seed < kinds:
            for kind in KINDS:
                yield f"quiet/{kind}/{seed}", lambda k=kind, s=seed: quiet(k, s)
                yield f"scour/{kind}/{seed}", lambda k=kind, s=seed: scour(k, s)
    for seed in range(without):
        for kind in KINDS:
            yield f"untold/quiet/{kind}/{seed}", lambda k=kind, s=seed: quiet(k, s, UNTOLD_SEEDS)
        yield f"untold/scour/{seed}", lambda s=seed: untold_scour(s)


def source(*, named: bool) -> str:
    """Return the identity of the code that pieces depend on; of names of causes, too, if they are named."""
    here = Path(__file__).parent
    files = sorted(Path(watching.__file__).parent.glob("*.py"))
    files = [here / "common" / "seasons.py", *(f for f in files if named or f.name not in NAMING)]
    bets = json.dumps([(p.name, p.weight, p.change.round(9).tolist()) for p in patterns()])
    return hashlib.sha256(b"".join([f.read_bytes() for f in files] + [bets.encode()])).hexdigest()[:12]


def computed(pieces: Iterable[tuple[str, Callable[[], Any]]], folder: Path) -> dict[str, Any]:
    """Return the pieces by name; what the folder has of the same source is not computed again."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "watching.jsonl"
    made = dict(map(json.loads, kept.read_text().splitlines())) if kept.exists() else {}
    identity = {named: source(named=named) for named in (False, True)}
    out = {}
    with kept.open("a") as file:
        for name, compute in pieces:
            key = f"{name} {identity[name.startswith('changed')]}"
            if key not in made:
                made[key] = compute()
                file.write(json.dumps([key, made[key]]) + "\n")
                file.flush()
                sys.stderr.write(f"{name}\n")
            out[name] = made[key]
    return out


def given() -> argparse.Namespace:
    """Return what was asked for; without its name it is the page."""
    words = sys.argv[1:]
    shape = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=shape)
    asked = parser.add_subparsers(dest="what", required=True)
    usual = {
        "page": (15, 20, 7),
        "speed": (),
        "kinds": (3,),
        "short": (3, 2),
        "faults": (6,),
        "scours": (4,),
        "right": (24,),
        "smallest": (3,),
    }
    for what, numbers in usual.items():
        of = asked.add_parser(what)
        for k, number in enumerate(numbers):
            of.add_argument(f"turbines_{k}", nargs="?", type=int, default=number, help=f"default: {number}")
        if what not in ("speed", "right"):
            of.add_argument("folder", nargs="?", type=Path, default=Path("out/qualify"))
        if what == "smallest":
            of.add_argument(
                "--model", action="store_true", help="of a structure, with changes to its drawing"
            )
    known = words and (words[0] in usual or words[0] in ("-h", "--help"))
    return parser.parse_args(words if known else ["page", *words])


def main() -> None:
    asked = given()
    if asked.what == "speed":
        sys.stdout.write("\n".join(speed()))
        return
    number = asked.turbines_0
    if asked.what == "right":
        sys.stdout.write("\n".join(right_models(number)) + "\n")
        return
    if asked.what == "smallest":
        one = smallest_of_model if asked.model else smallest
        name = "smallest_of_model" if asked.model else "smallest"
        named = [
            (f"{name}/{days:g}/{kind}/{seed}", lambda k=kind, d=days, s=seed: one(k, d, s))
            for days, turbines in zip(BASELINES, (number, number // 3), strict=True)
            for seed in range(turbines)
            for kind in KINDS
            if kind not in SLOW
        ]
        sys.stdout.write("\n".join(smallest_found(computed(named, asked.folder), name)))
        return
    if asked.what == "short":
        named = [
            (f"short/{what}/{kind}/{seed}", lambda w=of, k=kind, s=seed: w(k, s))
            for what, of, turbines in (
                ("quiet", quiet_after_part_of_a_year, number),
                ("scour", scour_after_part_of_a_year, asked.turbines_1),
            )
            for seed in range(turbines)
            for kind in KINDS
        ]
        sys.stdout.write("\n".join(short(computed(named, asked.folder))))
        return
    if asked.what == "faults":
        named = [
            (f"{what}/{fault}/{seed}", lambda w=of, f=fault, s=seed: w(f, s))
            for seed in range(number)
            for fault in FAULTS
            for what, of in (("quiet", quiet_at_fault), ("scour", scour_at_fault))
        ]
        sys.stdout.write("\n".join(faults(computed(named, asked.folder))))
        return
    if asked.what in ("kinds", "scours"):
        every = asked.what == "kinds"
        named = [p for p in pieces_of(number, 0, 0) if every or p[0].startswith("scour/")]
        pieces = computed(named, asked.folder)
        sys.stdout.write("\n".join([*scours(pieces), *(false_alarms(pieces) if every else ())]))
        return
    kinds, number, without = asked.turbines_0, asked.turbines_1, asked.turbines_2
    pieces = computed(pieces_of(kinds, number, without), asked.folder)
    head = [
        "# Watching",
        "",
        f"`python qualify/watching.py {kinds} {number} {without}`: four modes in two close pairs, their",
        "frequencies, damping and directions, about 3,400 ten-minute records a year in clusters while the",
        "rotor is parked; tide, a temperature that acts hours later, wind and waves, a scatter of 0.1 % that",
        "no condition explains, stated standard deviations wrong by 15 %, 0.4 % outliers",
        "(`qualify/common/seasons.py`, which shares no code with the detector). Directions turn as",
        "couplings of the same size and correlation time mix the modes of a pair, and are given as by a",
        "twin: for the closer pair in a fifth of the records. Like `jackettwin watch`, it tests a twin's",
        "causes in addition to general directions, by their effect on bending pairs of the reference jacket.",
        "",
    ]
    parts = [*changes(pieces), *information(pieces), *charts(pieces), *speed()]
    write_page("watching", [*head, *parts, *scours(pieces), *false_alarms(pieces)])


if __name__ == "__main__":
    main()
