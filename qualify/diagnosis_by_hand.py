"""What a change was, where the truth is changed by hand, without any cause of ``jackettwin.change``.

Usage: python qualify/diagnosis_by_hand.py [models a jacket]

Members are cut out, weakened and flooded, walls thinned, masses added on the drawing; scour is the pile's
head stiffness from the soil's curves with the ground gone; sensors' clocks and the yaw are wrong, and what is
something else changes at random. The stiffness of every foot and member differs from the model's. Modes
are solved before and after and paired by shape here; the change is seen with the noise of a month of seasons,
and on the first day that suffices for an alarm. Changes that would raise no alarm are left out.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from common.command import arguments
from common.page import write_page
from diagnosis import (
    CONFIDENT,
    LEAST,
    STD,
    Case,
    calibration,
    confident,
    jackets,
    on_the_day,
    seen_change,
)  # fmt: skip
from scipy.optimize import linear_sum_assignment

from jackettwin.change.causes import model_causes, seen_causes
from jackettwin.decks import read_structure
from jackettwin.response import build_system, mode_kinds, mode_labels, undamped_modes
from jackettwin.response.modes.labels import LOCAL
from jackettwin.soil import Spring, Support, read_foundation
from jackettwin.structure import Material, Member, PointMass, Section, Structure, assemble
from jackettwin.watching import Diagnosis, diagnose

WATCHED, SOLVED = 5, 14
SETS = 5
"""Changes of every sort, of other sizes and at other places, judged by the causes of one model."""
LOSS = 0.08


@dataclass(frozen=True)
class Sizes:
    """Ranges of sizes, all equally likely in ln.

    Attributes
    ----------
    scour_m, foot_scour_m : depth at all feet and at one
    softer : loss of the ground's stiffness
    growth_m, thinner_m : thickness of growth, loss of a wall
    heavier : of the mass of the RNA
    less : what a weakened brace loses of its stiffness, as −ln of what is left
    clock, misread : error of a clock, and sin² of the yaw's
    strange : changes of ln f and ln ζ by something else
    both_ways : whether a mass may be lost
    """

    scour_m: tuple[float, float]
    foot_scour_m: tuple[float, float]
    softer: tuple[float, float]
    growth_m: tuple[float, float]
    thinner_m: tuple[float, float]
    heavier: tuple[float, float]
    less: tuple[float, float]
    clock: tuple[float, float]
    misread: tuple[float, float]
    strange: tuple[tuple[float, float], ...]
    both_ways: bool = False


WORLDS = {
    "Sizes within a factor of two or four": Sizes(
        (0.7, 2.0),
        (1.5, 3.0),
        (0.1, 0.3),
        (0.02, 0.1),
        (0.002, 0.005),
        (0.01, 0.04),
        (0.5, 1.6),
        (1e-3, 4e-3),
        (0.02, 0.18),
        ((4e-3, 0.2),),
    ),
    "Sizes of every order of magnitude": Sizes(
        (0.2, 5.0),
        (0.3, 7.5),
        (0.02, 0.4),
        (0.002, 0.2),
        (6e-4, 0.015),
        (0.002, 0.05),
        (0.07, 1.8),
        (1e-4, 1.1e-2),
        (7e-3, 0.37),
        tuple(
            (7e-4 * 2.0**k * f, min(0.12 * 2.0**k, 0.96) * z)
            for f, z in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
            for k in range(7)
        ),
        True,
    ),
}
"""Sizes that an inspector would expect, and all that the watch holds possible."""
BRACES = " lost", " weakened", " flooded"


@dataclass(frozen=True)
class Site:
    """A structure, and the head stiffness of the pile under every foot, (n_feet, 3) [N/m]."""

    structure: Structure
    feet: np.ndarray


@dataclass(frozen=True)
class Seen:
    """Modes of the whole structure: labels, frequencies, shapes, and the ground's share of their energy."""

    labels: tuple[str, ...]
    frequency_hz: np.ndarray
    shapes: np.ndarray
    soil_share: np.ndarray


def solved(site: Site) -> Seen:
    assembly = assemble(site.structure, gravity=True)
    nodes = site.structure.reaction_nodes
    springs = tuple(
        Spring(node, np.diag([*k, 0.0, 0.0, 0.0])) for node, k in zip(nodes, site.feet, strict=True)
    )
    modes = undamped_modes(build_system(assembly, Support(springs)), SOLVED)
    labels = mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))
    moved = (assembly.expand @ modes.shapes).reshape(len(assembly.mesh.coordinates), 6, -1)
    names = list(assembly.mesh.node_names)
    at = np.stack([moved[names.index(node), :3] for node in nodes])
    share = np.einsum("fi,fim->m", site.feet, at**2) / modes.omega**2
    places = [names.index(n) for n in names if n in site.structure.nodes]
    return Seen(labels, modes.frequency_hz, moved[places].reshape(6 * len(places), -1), share)


def paired(before: Seen, after: Seen, chosen: list[int]) -> list[int]:
    """Return which mode of the changed structure each chosen one is, by the shapes' likeness."""
    a, b = (x / np.linalg.norm(x, axis=0) for x in (before.shapes[:, chosen], after.shapes))
    return [int(j) for j in linear_sum_assignment(-np.abs(a.T @ b))[1]]


def drawn(rng: np.random.Generator, between: tuple[float, float]) -> float:
    """Return a size, equally likely in ln between two."""
    return float(np.exp(rng.uniform(*np.log(between))))


def pile_head(depth_m: float) -> np.ndarray:
    """Return the stiffness of a pile's head with so much ground gone, horizontal twice and vertical."""
    head = (
        read_foundation("jacket15").scoured(depth_m).head() if depth_m else read_foundation("jacket15").head()
    )
    k = head.steel + head.soil
    return np.array([k[0, 0], k[1, 1], k[2, 2]])


def submerged(structure: Structure, member: Member) -> float:
    z = sorted(structure.nodes[n][2] for n in (member.start, member.end))
    if z[1] <= structure.sea_level_z_m or z[1] == z[0]:
        return float(z[0] <= structure.sea_level_z_m)
    return max(0.0, (structure.sea_level_z_m - z[0]) / (z[1] - z[0]))


def length(structure: Structure, m: Member) -> float:
    return float(np.linalg.norm(np.subtract(structure.nodes[m.end], structure.nodes[m.start])))


def slanted(structure: Structure) -> list[Member]:
    """Return the braces of the drawing: members of the jacket that rise less than a leg does."""
    return [
        m for m in structure.members
        if m.part in ("jacket", "")
        and abs(structure.nodes[m.end][2] - structure.nodes[m.start][2]) < 0.85 * length(structure, m)
    ]  # fmt: skip


def brace_of(structure: Structure, one: Member) -> list[Member]:
    """Return a brace's members: those on one straight line with it, end to end."""
    line, grown = [one], True
    way = np.subtract(structure.nodes[one.end], structure.nodes[one.start]) / length(structure, one)

    def along(m: Member) -> bool:
        own = np.subtract(structure.nodes[m.end], structure.nodes[m.start])
        return bool(abs(own @ way) > 0.999 * length(structure, m))

    while grown:
        ends = {n for m in line for n in (m.start, m.end)}
        more = [
            m for m in slanted(structure) if m not in line and {m.start, m.end} & ends and along(m)
        ]  # fmt: skip
        line, grown = line + more, bool(more)
    return line


def with_members(site: Site, members: list[Member], change: Callable[[Member], Member]) -> Site:
    names = {m.name for m in members}
    new = tuple(change(m) if m.name in names else m for m in site.structure.members)
    return replace(site, structure=replace(site.structure, members=new))


def walls(m: Member, less_m: float) -> Member:
    ends = (
        Section(s.outer_diameter_m, max(s.thickness_m - less_m, 0.3 * s.thickness_m))
        for s in (m.section_start, m.section_end)
    )
    start, end = ends
    return replace(m, section_start=start, section_end=end)


def stiffer(m: Member, by: float) -> Member:
    x = m.material
    return replace(m, material=Material(by * x.youngs_modulus_pa, by * x.shear_modulus_pa, x.density_kg_m3))


def inside(structure: Structure, m: Member) -> float:
    """Return the mass of the water that fills a member up to the level of the sea [kg]."""
    bore = m.section_start.outer_diameter_m - 2.0 * m.section_start.thickness_m
    return 0.25 * np.pi * bore**2 * 1025.0 * length(structure, m) * submerged(structure, m)


def strangers(
    labels: tuple[str, ...],
    frequency_hz: np.ndarray,
    zeta: np.ndarray,
    rng: np.random.Generator,
    sizes: Sizes,
) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Return names and changes of ln f and ln ζ of wrong sensors and of something else, (n_modes,) each."""
    none, mixed, damped = np.zeros(len(labels)), frequency_hz.copy(), zeta.copy()
    part = drawn(rng, sizes.misread)
    for n in (1, 2):
        pair = [labels.index(f"{way}_{n}") for way in ("fore_aft", "side_side") if f"{way}_{n}" in labels]
        if len(pair) == 2:  # what is looked for along an axis is partly the other mode of the pair
            other = pair[::-1]
            mixed[pair] += part * (frequency_hz[other] - frequency_hz[pair])
            damped[pair] += part * (zeta[other] - zeta[pair])
    slow = rng.choice([-1.0, 1.0]) * drawn(rng, sizes.clock)
    strange = sizes.strange[int(rng.integers(len(sizes.strange)))]
    return [
        ("sensor: clock", none + slow, none),
        ("sensor: yaw misread", np.log(mixed / frequency_hz), np.log(damped / zeta)),
        ("something else", *(size * rng.standard_normal(len(labels)) for size in strange)),
    ]


def changes(site: Site, rng: np.random.Generator, sizes: Sizes) -> list[tuple[str, Site]]:
    """Return changed sites, each with the beginning of the name that it ought to be given."""
    s, whole = site.structure, pile_head(0.0)
    out: list[tuple[str, Site]] = []
    gone = pile_head(drawn(rng, sizes.scour_m)) / whole
    out.append(("scour at all feet", replace(site, feet=site.feet * gone)))
    foot = int(rng.integers(len(site.feet)))
    deeper = pile_head(drawn(rng, sizes.foot_scour_m)) / whole
    feet = site.feet.copy()
    feet[foot] *= deeper
    out.append((f"scour at {s.reaction_nodes[foot]}", replace(site, feet=feet)))
    out.append(("soil softening", replace(site, feet=site.feet * (1.0 - drawn(rng, sizes.softer)))))
    braces = slanted(s)
    cut = brace_of(s, braces[int(rng.integers(len(braces)))])
    out.append((f"{'|'.join(m.name for m in cut)} lost", with_members(site, cut, lambda m: stiffer(m, 1e-4))))
    wet = [m for m in braces if submerged(s, m) == 1.0]
    for what, among in zip(BRACES[1:], (braces, wet), strict=True):
        one = brace_of(s, among[int(rng.integers(len(among)))])
        left, water = (
            np.exp(-drawn(rng, sizes.less)),
            [PointMass(n, 0.5 * inside(s, m)) for m in one for n in (m.start, m.end)],
        )
        hurt = with_members(site, one, lambda m, x=left: stiffer(m, x))
        wetter = replace(site, structure=s.with_masses((*s.masses, *water)))
        out.append((f"{'|'.join(m.name for m in one)}{what}", hurt if what == " weakened" else wetter))
    thin = drawn(rng, sizes.growth_m)

    def ring(m: Member) -> float:
        d = m.section_start.outer_diameter_m
        return (
            0.25 * np.pi * ((d + 2 * thin) ** 2 - d**2) * (1325.0 + 1025.0) * length(s, m) * submerged(s, m)
        )

    grown = [PointMass(n, 0.5 * ring(m)) for m in s.members for n in (m.start, m.end) if ring(m) > 0.0]
    out.append(("marine growth", replace(site, structure=s.with_masses((*s.masses, *grown)))))
    if s.masses:
        top = max(s.masses, key=lambda body: body.mass_kg)
        way = rng.choice([-1.0, 1.0]) if sizes.both_ways else 1.0
        heavier = (1.0 + way * drawn(rng, sizes.heavier)) * top.mass_kg
        bodies = tuple(replace(b, mass_kg=heavier) if b is top else b for b in s.masses)
        out.append(("mass of the RNA", replace(site, structure=s.with_masses(bodies))))
    splashed = [
        m for m in s.members
        if m.part in ("jacket", "")
        and min(s.nodes[n][2] for n in (m.start, m.end)) < s.sea_level_z_m + 6.0
        and max(s.nodes[n][2] for n in (m.start, m.end)) > s.sea_level_z_m - 3.0
    ]  # fmt: skip
    less = drawn(rng, sizes.thinner_m)
    out.append(("corrosion of the splash zone", with_members(site, splashed, lambda m: walls(m, less))))
    return out


def right(wanted: str, cause: str, alike: tuple[str, ...]) -> bool:
    """Tell whether a cause, or one that is said to do the same, is the wanted one."""
    names = [cause.split(" (or ")[0], *alike]
    what = next((what for what in BRACES if wanted.endswith(what)), None)
    return wanted in names if what is None else any(
        n + what in names for n in wanted.removesuffix(what).split("|")
    )  # fmt: skip


def judged(jacket: str, wanted: str, number: int, found: Diagnosis) -> Case:
    """Return a case; its fourth entry tells changes of one sort apart."""
    first = found.verdicts[0]
    group = next((g for g in found.inseparable if first.cause in g), ())
    meant = {v.cause: v.alike for v in found.verdicts}
    inside = any(right(wanted, name, meant[name]) for name in group)
    what = next((f"a brace{what}" for what in BRACES if wanted.endswith(what)), wanted)
    if wanted.startswith("scour at ") and wanted != "scour at all feet":
        what = "scour at one foot"
    good = right(wanted, first.cause, first.alike)
    return jacket, what, first.cause, number, first.probability, good, bool(group), inside


def cases(jacket: str, structure: Structure, draws: int, sizes: Sizes) -> tuple[list[Case], list[Case]]:
    """Return what became of all changes to one jacket: on the day of the alarm, and a month later."""
    rng, later = (np.random.default_rng((k, len(jacket))) for k in (47, 53))
    early, out = list[Case](), list[Case]()
    for draw in range(draws):
        feet = len(structure.reaction_nodes)
        common = np.exp(0.4 * rng.standard_normal(3))[[0, 0, 2]]
        ground = pile_head(0.0) * common * np.exp(0.1 * rng.standard_normal((feet, 3)))
        site = Site(structure, ground)
        # no member is as on the drawing
        other = np.exp(0.02 * rng.standard_normal(len(structure.members)))
        factor = {m.name: x for m, x in zip(structure.members, other, strict=True)}
        site = with_members(site, list(structure.members), lambda m: stiffer(m, factor[m.name]))  # noqa: B023
        before = solved(site)
        chosen = [i for i, label in enumerate(before.labels) if not label.startswith(LOCAL)][:WATCHED]
        labels = tuple(before.labels[i] for i in chosen)
        zeta = 0.006 + 0.5 * LOSS * before.soil_share[chosen]
        model = model_causes(structure, labels, before.frequency_hz[chosen], zeta, seed=draw)
        quantities = [(kind, i) for kind in STD for i in range(len(chosen))]
        kinds = [kind for kind, _ in quantities]
        seen = seen_causes(model, quantities, labels)
        own = [kind for kind, known in zip(kinds, seen.known, strict=True) if known]
        every = []
        for k in range(SETS):
            for wanted, changed in changes(site, rng, sizes):
                after = solved(changed)
                at = paired(before, after, chosen)
                ln_f = np.log(after.frequency_hz[at] / before.frequency_hz[chosen])
                ln_z = np.log((0.006 + 0.5 * LOSS * after.soil_share[at]) / zeta)
                every.append((SETS * draw + k, wanted, ln_f, ln_z))
            odd = strangers(labels, before.frequency_hz[chosen], zeta, rng, sizes)
            every += [(SETS * draw + k, *one) for one in odd]
        for number, wanted, ln_f, ln_z in every:
            known = seen_change(np.concatenate([ln_f, ln_z]), kinds, rng, False)
            late = (known,) if known.by_mode.sum() > LEAST else ()
            for of, seen_then in (out, late), (early, on_the_day(known, later)):
                for one in seen_then:
                    found = diagnose(one.restricted(seen.known), seen.causes, own)
                    of.append(judged(jacket, wanted, number, found))
            sys.stderr.write(f"{jacket} {draw}: {len(out)} {wanted} {np.round(100 * ln_f, 2)}\n")
    return early, out


def share(good: int, of: int) -> str:
    return f"{good} of {of} ({100 * good / max(of, 1):.0f} %)"


HEAD = """# Diagnosis of changes to the drawing

`python qualify/diagnosis_by_hand.py {draws}`: jackets whose feet and members all differ from the
model's, {draws} of each drawing, changed on the drawing: braces cut, weakened and flooded, walls
thinned, masses added; scour by soil curves; wrong clocks and yaw, and something else at random;
{sets} of each, with other sizes and places. The truth does not use `jackettwin.change`. Five modes;
the model's feet are fitted to the frequencies before. Changes too small for an alarm are left out.
A month after the change it is known to 0.03 % and 2 % of frequency and damping; the day of the
alarm is the first of the month whose data suffice for it.
"""


def page(found: dict[str, tuple[list[Case], list[Case]]], draws: int) -> list[str]:
    """Return the page, of early and late cases in each world."""
    lines = HEAD.format(draws=draws, sets=SETS).splitlines()
    for world, (early, late) in found.items():
        lines += ["", f"## {world}, a month after", "", *tables(late)]
        lines += [f"## {world}, on the day of the alarm", "", *tables(early)]
    return lines


def tables(found: list[Case]) -> list[str]:
    """Return shares, and what became of each jacket and change."""
    error, chance, most = calibration(found)
    wrong_sure = [c for c in found if c[4] > CONFIDENT and not c[5] and not c[7]]
    said = np.mean([c[4] for c in found])
    lines = [
        "| | |",
        "|---|---|",
        f"| first place, or in its declared group | {share(sum(c[5] or c[7] for c in found), len(found))} |",
        f"| first place | {share(sum(c[5] for c in found), len(found))} |",
        f"| probability of the first place, mean | {100 * said:.0f} % |",
        f"| wrong with more than {100 * CONFIDENT:.0f} %; expected of these probabilities | "
        f"{confident(found)} |",
        f"| expected calibration error; by chance, mean and 95 of 100 below | {100 * error:.1f} %; "
        f"{100 * chance:.1f} %; {100 * most:.1f} % |",
        "",
        "| jacket | first place or group | wrong with more than 90 % |",
        "|---|---|---|",
    ]
    for jacket in dict.fromkeys(c[0] for c in found):
        own = [c for c in found if c[0] == jacket]
        sure = sum(c in wrong_sure for c in own)
        lines.append(f"| {jacket} | {share(sum(c[5] or c[7] for c in own), len(own))} | {sure} |")
    lines += [
        "",
        "| change | first place | or in its group | most often confused with |",
        "|---|---|---|---|",
    ]
    for name in dict.fromkeys(c[1] for c in found):
        own = [c for c in found if c[1] == name]
        wrong = [c[2] for c in own if not c[5]]
        other = max(set(wrong), key=wrong.count) if wrong else "–"
        lines.append(f"| {name} | {sum(c[5] for c in own)} of {len(own)} | "
                     f"{sum(c[5] or c[7] for c in own)} | {other} |")  # fmt: skip
    return [*lines, ""]


def main() -> None:
    draws = arguments(__doc__, draws=4).draws
    with tempfile.TemporaryDirectory() as name:
        every = {jacket: structure for jacket, (structure, _) in jackets(Path(name)).items()}
    every["four legs, deck"] = read_structure(str(Path(__file__).parent / "decks/four_legs.yaml"))
    found = {}
    for world, sizes in WORLDS.items():
        both = [cases(jacket, structure, draws, sizes) for jacket, structure in every.items()]
        found[world] = ([c for early, _ in both for c in early], [c for _, late in both for c in late])
    write_page("diagnosis_by_hand", page(found, draws))


if __name__ == "__main__":
    main()
