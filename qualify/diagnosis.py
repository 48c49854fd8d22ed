"""What a change was: causes planted in four jackets, told apart by the modes' changes.

Usage: python qualify/diagnosis.py [draws a cause and size]

The truth is another jacket than the model's: the stiffness of every foot, the ground's loss and what the
model misses are drawn, and a cause is solved anew at its size. What the watch knows of the change is drawn
with the uncertainty that a month of the seasons of ``qualify/watching.py`` leaves, and that of the first day
that suffices for an alarm; ``diagnosis_chain.py`` simulates and identifies records instead.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
from common.command import arguments
from common.page import write_page

from jackettwin.change.causes import _ONE_SIZE, model_causes, seen_causes
from jackettwin.change.changed_structures import Happening, Standing, happenings
from jackettwin.change.event_effects import effect, repeated
from jackettwin.change.standing_modes import MODES, Modes
from jackettwin.decks import read_structure
from jackettwin.response.modes.labels import LOCAL
from jackettwin.structure import Structure, assemble
from jackettwin.watching import Cause, Change, Diagnosis, diagnose
from jackettwin.watching.scatter import STRONGER

WATCHED = 5
STD = {"frequency": 3e-4, "damping": 0.02}
"""Of a change of ln f and ln ζ: 0.1 % of two days' memory over a month before and after it."""
TIMES = (1, 2, 4)
"""Sizes: so many times what the event is made of: a metre of scour, 5 cm of growth, 1 % of the mass."""
EVENTS = (
    "scour at all feet", "scour at one foot", "soil", "brace lost", "brace weakened", "flooded", "growth",
    "mass", "corrosion", "connection",
)  # fmt: skip
SENSORS = {"sensor: clock": 1e-3, "sensor: yaw misread": 0.05}
LEAST = 25.0
"""Squared distance from no change, in variances, below which no alarm would have asked: ln of ten years
in days and of the stakes, twice over."""
DAYS = 30
"""Within which an alarm is waited for: of the month."""
CONFIDENT = 0.9


def jackets(where: Path) -> dict[str, tuple[Structure, str]]:
    """Return the reference jacket, one of three legs, smaller, for another turbine, and the OC4 jacket.

    With each its name or file. Nothing of the watch was made with the OC4 jacket at hand.
    """
    text = (files("jackettwin") / "data" / "structures" / "jacket15.yaml").read_text()
    changes = {
        "name: jacket15": "name: three_legs", "legs: 4": "legs: 3", "bays: 4": "bays: 3",
        "height_m: 93.99999625623431": "height_m: 70.0",
        "base_width_m: 39.394306599491266": "base_width_m: 28.0",
        "sea_level_z_m: 72.0": "sea_level_z_m: 50.0", "top_z_m: 100.0": "top_z_m: 76.0",
        "height_m: 116.0": "height_m: 88.0", "mass_kg: 809000.0": "mass_kg: 420000.0",
    }  # fmt: skip
    for old, new in changes.items():
        if old not in text:
            raise ValueError(f"jacket15 has changed: {old}")
        text = text.replace(old, new)
    path = where / "three_legs.yaml"
    path.write_text(text)
    sources = {
        "four legs, 15 MW": "jacket15", "three legs, smaller": str(path),
        "OC4": str(Path(__file__).parent / "decks/oc4_jacket.dat"),
    }  # fmt: skip
    return {jacket: (read_structure(source), source) for jacket, source in sources.items()}


def truth(structure: Structure, rng: np.random.Generator) -> Standing:
    """Return the jacket as it stands: every foot has a stiffness of its own."""
    feet = len(structure.reaction_nodes)
    common = np.exp(0.4 * rng.standard_normal(2))
    return Standing(structure, *(2.5e9 * c * np.exp(0.1 * rng.standard_normal(feet)) for c in common))


def planted(structure: Structure) -> list[Happening]:
    """Return the events to plant: the first of each family."""
    standing = Standing(structure, *(np.full(len(structure.reaction_nodes), 2.5e9) for _ in "hv"))
    happened = happenings(standing)
    return [next(e for e in happened if wanted in (e.name, e.family)) for wanted in EVENTS]


def name_of(event: str, causes: Sequence[Cause]) -> str:
    """Return what a model calls an event; it may have joined it with others alike, or see no trace of it."""
    return next((c.name for c in causes if c.name.split(" (or ")[0] == event), event)


def moved(event: Happening, standing: Standing, times: int, base: Modes, zeta: np.ndarray) -> np.ndarray:
    """Return the change of all ln f and ln ζ by an event, so many times over."""
    often = repeated(event, times if event.spread > _ONE_SIZE else 1)  # what is gone is gone
    stands = often.apply(standing)
    after = Modes.of(stands, assemble(stands.structure, gravity=True), like=base)
    return effect(replace(often, per=1.0), base, after, 0.1, zeta)


def seen_change(delta: np.ndarray, kinds: list[str], rng: np.random.Generator, louder: bool) -> Change:
    """Return what the watch knows of a change."""
    std = np.array([STD[kind] for kind in kinds])
    info = np.diag(std**-2.0)
    score = info @ (delta + std * rng.standard_normal(len(kinds)))
    scatter = np.zeros((1, len(kinds), len(STRONGER)))
    scatter[0] = [-10.0, -30.0, -60.0]
    if louder:  # the frequencies of two modes scatter more; their damping does not, which makes it hard
        scatter[0, rng.permutation(WATCHED)[:2]] = [20.0, 40.0, 25.0]
    size = score * std**2
    return Change(
        0.0, "frequency", "any", 0.0, (0.0, 0.0), np.ones(len(kinds), dtype=bool), size, std, info[None],
        score[None], np.zeros(1), scatter, 9.0, (size / std) ** 2,
    )  # fmt: skip


def on_the_day(change: Change, rng: np.random.Generator) -> tuple[Change, ...]:
    """Return what the watch knew of a change on the day of the alarm, if there was one within the month.

    The month's information comes in equal parts a day, and the alarm on the first day on which the squared
    distance from no change exceeds ``LEAST``. The score until a day is drawn given that of the month, a
    Brownian bridge: what is known on the day is from the records until then. Louder noise is no matter of
    that.
    """
    if np.any(change.log_scatter > 0.0):
        return ()
    share = np.arange(1, DAYS + 1)[:, None] / DAYS
    steps = rng.standard_normal((DAYS, change.size.size)) / np.sqrt(DAYS) / change.size_std
    walk = np.cumsum(steps, axis=0)
    score = share * change.score[0] + walk - share * walk[-1]
    size, std = score * change.size_std**2 / share, change.size_std / np.sqrt(share)
    square = (size / std) ** 2
    alarms = np.flatnonzero(square.sum(axis=1) > LEAST)
    if not alarms.size:
        return ()
    day = alarms[0]
    known = replace(
        change, size=size[day], size_std=std[day], info=share[day] * change.info,
        score=score[day : day + 1], by_mode=square[day],
    )  # fmt: skip
    return (known,)


Case = tuple[str, str, str, int, float, bool, bool, bool]


def case(jacket: str, name: str, times: int, found: Diagnosis) -> Case:
    """Return jacket, truth, first place, size, its probability, right, grouped, and group right."""
    first = found.verdicts[0]
    group = next((g for g in found.inseparable if first.cause in g), ())
    return (
        jacket,
        name,
        first.cause,
        times,
        first.probability,
        first.cause == name,
        bool(group),
        name in group,
    )


def cases(jacket: str, structure: Structure, draws: int) -> tuple[list[Case], list[Case]]:
    """Return what became of all causes in one jacket: on the day of the alarm, and a month later."""
    rng, later = (np.random.default_rng((k, len(jacket))) for k in (31, 33))
    early, out = [], []
    for draw in range(draws):
        standing = truth(structure, rng)
        base = Modes.of(standing, assemble(structure, gravity=True))
        chosen = [i for i, label in enumerate(base.labels) if not label.startswith(LOCAL)][:WATCHED]
        labels = tuple(base.labels[i] for i in chosen)
        quantities = [(kind, i) for kind in STD for i in range(len(chosen))]
        columns = chosen + [MODES + i for i in chosen]
        kinds = [kind for kind, _ in quantities]
        zeta = np.full(MODES, 0.006) + 0.05 * base.soil_share
        missed = np.exp(0.005 * rng.standard_normal(len(chosen)))
        frequency = base.modes.frequency_hz[chosen] * missed
        model = model_causes(structure, labels, frequency, zeta[chosen], seed=draw)
        seen = seen_causes(model, quantities, labels)
        own = [kind for kind, known in zip(kinds, seen.known, strict=True) if known]

        def judged(name: str, times: int, delta: np.ndarray, louder: bool = False) -> None:
            change = seen_change(delta, kinds, rng, louder)  # noqa: B023
            late = (change,) if louder or change.by_mode.sum() > LEAST else ()
            for of, known in (out, late), (early, on_the_day(change, later)):
                for one in known:
                    found = diagnose(one.restricted(seen.known), seen.causes, own)  # noqa: B023
                    of.append(case(jacket, name, times, found))

        for event in planted(structure):
            name = name_of(event.name, seen.causes)
            for times in TIMES if name in {c.name for c in seen.causes} else ():
                judged(name, times, moved(event, standing, times, base, zeta)[columns])
        by_name = {cause.name: cause for cause in model.causes}
        for name in sorted(SENSORS.keys() & by_name):
            for times in TIMES:
                judged(name, times, times * SENSORS[name] * by_name[name].draws[0, columns])
        for times in TIMES:
            any_way = np.array([0.002 if kind == "frequency" else 0.1 for kind in kinds])
            judged("something else", times, times * any_way * rng.standard_normal(len(kinds)))
            small = np.array([0.001 if kind == "frequency" else 0.05 for kind in kinds])
            judged("sensor: more scatter", times, small * rng.standard_normal(len(kinds)), louder=True)
        sys.stderr.write(f"{jacket} {draw}: {len(out)}\n")
    return early, out


def calibration(found: list[Case], *, shared: bool = False) -> tuple[float, float, float]:
    """Return the expected calibration error of the first place, in ten bins, and what chance makes of it.

    So few cases in a bin are never right as often as exact probabilities say: the others are mean and 95 %
    quantile of the error of cases that are right with these probabilities. ``shared``: cases of one change
    have their records in common, hence are right together.
    """
    p, right = np.array([c[4] for c in found]), np.array([c[5] for c in found])
    bins = np.minimum((10 * p).astype(int), 9)
    group = np.unique([f"{c[0]}/{c[1]}/{c[3]}" for c in found], return_inverse=True)[1]
    luck = np.random.default_rng(1).random((2000, p.size))
    drawn = (luck[:, group] if shared else luck) < p
    off = np.stack([p, right, *drawn])[:, None] * (bins == np.arange(10)[:, None])
    total = off.sum(axis=2)
    error = np.abs(total[1:] - total[0]).sum(axis=1) / p.size
    return float(error[0]), float(error[1:].mean()), float(np.quantile(error[1:], 0.95))


def confident(found: list[Case]) -> str:
    """Return how many were wrong and in no group with the truth though sure, and how many were expected."""
    sure = [c for c in found if c[4] > CONFIDENT]
    wrong = sum(not c[5] and not c[7] for c in sure)
    return f"{wrong} of {len(found)}; {sum(1.0 - c[4] for c in sure):.1f}"


DRAWN = (
    "# Diagnosis",
    "",
    "`python qualify/diagnosis.py {number}`: causes simulated in four jackets with uncertain feet at three",
    "sizes, {number} times each; five modes' frequencies and damping ratios (drawn, not identified), whose",
    "changes are known to 0.03 % and 2 %, as from a month before and after in the seasons of",
    "[watching](watching.md). Through the whole chain: [here](diagnosis_chain.md).",
    "The model's feet are fitted to the frequencies before; their error is then 0.5 %. Members and feet",
    "have the names of their models: brace_… and foot_… in the first two jackets, numbers in the decks",
    "of OC4 and of OC3's tripod.",
    "",
    "## A month after the change",
    "",
)
EARLY = (
    "## On the day of the alarm",
    "",
    "The same changes on the first day of the month whose data suffice for an alarm, if there is one.",
    "",
)


def page(found: list[Case], head: Sequence[str], *, shared: bool = False, **numbers: int) -> list[str]:
    """Return the page."""
    alone = [c for c in found if not c[6]]
    grouped = [c for c in found if c[6]]
    error, chance, most = calibration(found, shared=shared)
    said, right = np.mean([c[4] for c in found]), np.mean([c[5] for c in found])
    lines = [
        *(line.format(**numbers) for line in head),
        "| | share |",
        "|---|---|",
        f"| first place right, where the causes are declared separable | {_share([c[5] for c in alone])} |",
        f"| planted cause in the group that is declared inseparable | {_share([c[7] for c in grouped])} |",
        f"| expected calibration error of the first place | {100 * error:.1f} % |",
        f"| the same of as many cases with exact probabilities, by chance: mean; 95 of 100 below | "
        f"{100 * chance:.1f} %; {100 * most:.1f} % |",
        f"| probability of the first place, mean; right | {100 * said:.0f} %; {100 * right:.0f} % |",
        f"| wrong with more than {100 * CONFIDENT:.0f} %; expected of these probabilities | "
        f"{confident(found)} |",
        "",
        "| planted | right | in its inseparable group | most often taken for |",
        "|---|---|---|---|",
    ]
    for name in dict.fromkeys(c[1].split(" (or ")[0] for c in found):
        own = [c for c in found if c[1].split(" (or ")[0] == name]
        wrong = [c[2] for c in own if not c[5]]
        other = max(set(wrong), key=wrong.count) if wrong else "–"
        inside = sum(c[7] and not c[5] for c in own)
        lines.append(f"| {name} | {sum(c[5] for c in own)} of {len(own)} | {inside} | {other} |")
    return [*lines, ""]


def _share(right: list[bool]) -> str:
    return f"{sum(right)} of {len(right)} ({100 * np.mean(right):.0f} %)" if right else "–"


def main() -> None:
    draws = arguments(__doc__, draws=6).draws
    with tempfile.TemporaryDirectory() as name:
        stand = {jacket: structure for jacket, (structure, _) in jackets(Path(name)).items()}
        stand["OC3 tripod"] = read_structure(str(Path(__file__).parent / "decks/oc3_tripod.dat"))
        both = [cases(jacket, structure, draws) for jacket, structure in stand.items()]
    early, late = ([c for found in both for c in found[k]] for k in (0, 1))
    write_page("diagnosis", [*page(late, DRAWN, number=draws), *page(early, EARLY)])


if __name__ == "__main__":
    main()
