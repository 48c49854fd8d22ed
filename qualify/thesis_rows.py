"""All 74 rows of the page on the thesis on structures that nothing was made for, from both sides.

Each row's commands are given with the structure in place of the shipped one; the same is then computed from
Python, or in closed form, and compared. Rows that recompute published numbers are ``jackettwin verify``'s.

Usage: python qualify/thesis_rows.py [--rows 3,12] [STRUCTURE …]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import chdir
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
import yaml
from common.page import write_page
from common.thesis_case import DECKS, STEEL, ThesisCase
from common.thesis_walk import Answer, Row, prepared, relative, rows, said, walked, with_girders

from jackettwin import (
    Rayleigh,
    TwinModel,
    assemble,
    build_system,
    damped_modes,
    observe,
    read_record,
    read_structure,
    read_support,
    read_twin,
    run_twin,
    state_model,
)
from jackettwin.checks import frame_use
from jackettwin.response import (
    Sensor,
    compare_modes,
    free_vibration,
    modal_damping,
    nodal_modes,
    observation_matrix,
    poles,
    sdof,
    self_weight,
    static_displacement,
    undamped_modes,
    with_inner_piles,
)
from jackettwin.simulate import read_scenario, simulate
from jackettwin.soil import law_curves, read_foundation, read_law, read_supported
from jackettwin.soil.piles.impedance import head_impedance
from jackettwin.soil.support import ELASTIC
from jackettwin.structure import element_weight
from jackettwin.study import ExploreSettings, explore
from jackettwin.updating import numbered_modes, stages

STRUCTURES = ("k_braced", "uneven_legs", "deck_and_tower", "square")
Check = Callable[[ThesisCase, list[Answer]], str]
CHECKS: dict[int, Check] = {}
PUBLISHED = {16, 18, 27, 41, 42, 64}
"""Rows that are published numbers: no structure of one's own has them."""


def row(number: int) -> Callable[[Check], Check]:
    """Register the check of a row."""

    def take(check: Check) -> Check:
        CHECKS[number] = check
        return check

    return take


def hertz(answer: Answer, key: str = "frequency_hz") -> np.ndarray:
    return np.array([mode[key] for mode in answer.document["modes"]], dtype=float)


def near(found: Any, wanted: Any, bound: float) -> str:
    """Return the largest relative difference in words; assert that it is below the bound."""
    apart = relative(found, wanted)
    assert apart < bound, f"{apart:.1e} apart, bound {bound:g}"
    return f"{apart:.0e} from Python" if apart > 0.0 else "the same from Python"


def from_python(
    case: ThesisCase, support: str | None, steel: Rayleigh | None = None, **model: Any
) -> np.ndarray:
    """Return (frequency, damping ratio) of the ten lowest damped modes by the public functions."""
    structure, held = read_supported(support, case.structure)
    system = build_system(assemble(structure, **model), held, rayleigh=Rayleigh() if steel is None else steel)
    system = with_inner_piles(system)
    found = damped_modes(system, below_hz=1.6 * float(undamped_modes(system, 10).frequency_hz[-1]))
    few = found.damping_ratio <= 0.3
    return np.array([found.frequency_hz[few], found.damping_ratio[few]])[:, :10]


# --- chapters 1 and 2


@row(1)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    (alarm,) = answers[0].document["alarms"]
    assert "2025-03-06" <= alarm["looked_utc"][:10] <= "2025-04-10", alarm["looked_utc"]
    return f"drop of 1.2 % on 2025-03-06 found on {alarm['looked_utc'][:10]}"


@row(2)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    scenario, stress = (a.document for a in answers)
    assert stress["damage"] > 0.0 and scenario["joints"]
    return f"{len(scenario['joints'])} joints; damage of the series {stress['damage']:.1e}"


@row(3)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    omega, least = 2 * np.pi * hertz(answers[0]), 2 * np.pi * 0.1832
    return near(hertz(answers[0], "damping_ratio"), 0.005 * (least / omega + omega / least), 1e-8)


@row(4)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    # ratios are those of the modes on pinned feet: a deck's own feet may be clamped
    assert relative(hertz(answers[0], "damping_ratio")[:2], [0.005, 0.005]) < 1e-3
    steel = Rayleigh.minimum(0.004, 0.2)
    own = modal_damping(case.assembly, {1: 0.005, 2: 0.005}, steel)
    assert own.shape == (case.assembly.n_dof,) * 2
    return "ζ1 = ζ2 = 0.500 %; the matrix from Python"


@row(5)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    loads, moved = (a.document for a in answers)
    assert loads["mudline"]["base_shear_n"] > 0.0
    water = moved["true_modes"][0]["damping_by_source"]["water"]
    assert water > 0.0
    return f"base shear {loads['mudline']['base_shear_n']:.2g} N, drag damps mode 1 by {water:.1e}"


@row(6)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    radiated = [m["damping_ratio"] for m in answers[0].document["radiation"]]
    assert 0.0 < max(radiated[:2]) < 1e-5 and max(radiated) < 1e-3
    return f"first pair {max(radiated[:2]):.0e}, first five modes at most {max(radiated):.0e}"


@row(7)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    document = yaml.safe_load((case.folder / answers[0].argv[1]).read_text("utf-8"))
    del document["waves"]["diffraction"]
    plain = said("loads", str(case.write("slender.yaml", document)), "--json").document
    one, other = (d["parts"]["water"]["force_n"]["x"]["std"] for d in (answers[0].document, plain))
    # 2|m| of a slender cylinder rises to 2.1 before it falls
    assert 0.5 < one / other < 1.06, one / other
    return f"wave force × {one / other:.3f} of that on slender members"


@row(8)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    head = read_foundation(case.folder / "piles.yaml").head()
    found = np.array(answers[0].document["head_stiffness"])
    assert found[0, 0] > 0.0 and answers[0].document["head_loss"][0][0] > 0.0
    assert np.linalg.norm(head.soil) > 0.0
    return f"head {found[0, 0]:.3g} N/m, loss {answers[0].document['head_loss'][0][0]:.2g}"


@row(9)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    names = [p for p in answers[0].document["parameters"]]
    assert {"k_u", "k_theta", "c", "rayleigh_ratio"} <= set(names), names
    return near(hertz(answers[1]), from_python(case, "mudline:k_u=2e9,k_theta=8e11,c=2e7")[0], 1e-7)


# --- chapters 3 and 4


@row(10)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    (law,) = answers[0].document["laws"]
    zeta = 1e5 / (2.0 * np.sqrt(1.48e6 * 1.12e6))
    assert relative([law["free_vibration"]["damping_ratio"]], [zeta]) < 1e-10
    own = free_vibration(1.12e6, read_law("kelvin-voigt:k=1.48e6,c=1e5"))
    return near([own.damping_ratio], [zeta], 1e-10)


@row(11)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    regimes = [law["free_vibration"]["regime"] for law in answers[0].document["laws"]]
    assert regimes == ["underdamped", "critically damped", "overdamped"], regimes
    (locus,) = answers[1].document["loci"]
    at = [branch["frequency_hz"][locus["origin"]] for branch in locus["branches"]]
    return near(at[:2], from_python(case, "kelvin-voigt:k=2.5e9,c=7.6e8")[0][:2], 1e-3)


@row(12)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    with np.load(case.folder / "state.npz") as file:
        found = np.linalg.eigvals(file["A"])
    system = build_system(case.assembly, read_support(None, case.structure))
    own = state_model(system)
    assert answers[0].document["state"]["states"] == len(own.states)
    lowest = np.sort(np.abs(found[found.imag > 0.0]))[:10]
    return near(lowest / (2 * np.pi), hertz(answers[0]), 1e-6)


@row(13)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return near(hertz(answers[0]), from_python(case, "pinned", beam_theory="euler-bernoulli")[0], 1e-8)


@row(14)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    shape = {"girder": {"shape": "i", "width_m": 0.4, "height_m": 0.9, "flange_thickness_m": 0.03,
                        "web_thickness_m": 0.016}}  # fmt: skip
    f = []
    for twist in (0.0, 90.0, 180.0):
        try:
            file = case.write(f"girders_{twist:.0f}.yaml", with_girders(case, shape, twist))
        except LookupError:
            beams = len(case.structure.beams)
            assert beams
            return f"the deck's own {beams} rectangular and arbitrary beams"
        f.append(hertz(said("modes", str(file), "--json")))
    assert relative(f[2], f[0]) < 1e-9 and relative(f[1], f[0]) > 1e-6
    own = numbered_modes(assemble(read_structure(case.folder / "girders_90.yaml")), 10).frequency_hz
    return f"turned by 180° the same, by 90° {relative(f[1], f[0]):.0e}; " + near(f[1], own, 1e-8)


@row(15)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    own = from_python(case, None, beam_theory="timoshenko", rotary_inertia=True)[0]
    assert hertz(answers[0])[0] < from_python(case, None, beam_theory="euler-bernoulli")[0][0]
    return near(hertz(answers[0]), own, 1e-8)


@row(17)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    modes = undamped_modes(build_system(case.assembly, read_support("pinned", case.structure)), 4)
    dofs = case.assembly.mesh.node_dofs(case.top)
    moved = np.asarray((case.assembly.expand @ modes.shapes)[dofs[:3]])
    body = max(case.structure.masses, key=lambda m: m.mass_kg * (m.node == case.top))
    heavier = case.structure.with_masses((*case.structure.masses, type(body)(case.top, 1000.0)))
    found = numbered_modes(assemble(heavier), 4).frequency_hz / modes.frequency_hz - 1.0
    # a mass at the top: Δf/f = −m |φ|²/2
    return near(found[:2], -0.5 * 1000.0 * (moved**2).sum(axis=0)[:2], 0.02) + ", one tonne more on the top"


@row(19)
@row(31)
@row(46)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    page = answers[-1].document
    assert {"density", "Young's modulus"} <= set(page["colours"]), page["colours"]
    assert (case.folder / page["page"]).stat().st_size > 20_000
    return f"{len(page['motions'])} motions, {len(page['colours'])} colours"


@row(20)
@row(21)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    if len(answers) == 1:
        assert "k" in answers[0].document["parameters"]
        return "the twin is updated with it"
    steel = Rayleigh.two_points((0.005, 0.01), (0.18, 0.75))
    own = from_python(case, None, steel)
    return near(hertz(answers[0], "damping_ratio"), own[1], 1e-7)


@row(22)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    push = answers[0].document["pushover"]
    assert len(push["load_n"]) == 5 and (np.diff(push["load_n"]) > 0.0).all()
    return f"{len(answers[0].document['curves']['stations'])} stations of curves"


@row(23)
@row(24)
@row(25)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    text = answers[0].document["laws"][0]["law"]
    curves = law_curves(read_law(text), 0.01, 10.0)
    said_loss = answers[0].document["laws"][0]["loss_factor"]
    extra = ""
    if answers[0].document["mass_kg"]:
        found = poles(sdof(1.12e6, read_law(text)))
        k0, c, k1 = 1.48e6, 5e4, 3.1096e5
        # m s²(1 + s c/k1) + k0 (1 + s c/k1) + s c = 0
        wanted = np.roots([1.12e6 * c / k1, 1.12e6, k0 * c / k1 + c, k0])
        extra = f"; poles of (4.13) {relative(np.sort(np.abs(found)), np.sort(np.abs(wanted))):.0e}"
    return near(said_loss, curves.loss_factor, 1e-9) + extra


# --- chapter 5


@row(26)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return near(hertz(answers[0]), from_python(case, None)[0], 1e-8)


@row(28)
@row(29)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    file = case.folder / answers[0].argv[1]
    own = simulate(read_scenario(file)).record
    written = read_record(case.folder / answers[0].document["record"])
    (surface,) = (k for k, channel in enumerate(own.channels) if channel.name == "wave_elevation")
    height = 4.0 * own.data[surface].std()
    np.testing.assert_allclose(own.data, written.data, rtol=1e-6, atol=1e-9)
    return f"4σ of the surface {height:.2f} m in a minute; the same record from Python" + (
        f"; {one_gravity(case)}" if len(answers[0].argv) == 3 else ""
    )


def one_gravity(case: ThesisCase) -> str:
    """Assert that a drafted twin has the gravity of its record, whatever that is."""
    for gravity in (True, False):
        case.write("fall.yaml", {**case.scenario, "gravity": gravity})
        with chdir(case.folder):
            said("simulate", "fall.yaml", "--out", "fall.parquet")
            said("init", str(case.file), "fall.parquet", "--out", "drafted.yaml", "--force")
        drafted = read_twin(case.folder / "drafted.yaml")
        assert drafted.gravity is gravity, (gravity, drafted.gravity)
    return "a drafted twin has its record's gravity"


@row(30)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    forced, pulled = (a.document for a in answers)
    decrement = pulled["decrement"]
    assert relative([decrement["damping_ratio"]], [decrement["pole_damping_ratio"]]) < 0.3, decrement
    assert (case.folder / forced["record"]).exists()
    return f"decrement ζ {decrement['damping_ratio']:.4f}, pole {decrement['pole_damping_ratio']:.4f}"


@row(32)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    system = build_system(case.assembly, read_support(None, case.structure))
    u = static_displacement(system, self_weight(case.assembly))
    own = frame_use(case.assembly, u, along=element_weight(case.assembly))
    found = {m["member"]: m["utilisation"] for m in answers[0].document["members"]}
    names = [use.member for use in own.members]
    return near([found[n] for n in names], [use.utilisation for use in own.members], 1e-8)


@row(33)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return near(hertz(answers[0]), from_python(case, str(case.folder / "piles.yaml"))[0], 1e-7)


@row(34)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    heads = said("modes", str(case.file), "--support", str(case.folder / "piles.yaml"), "--json")
    both = ((hertz(one, key) for one in (answers[0], heads)) for key in ("frequency_hz", "damping_ratio"))
    apart = max(relative(members, lumped) for members, lumped in both)
    assert apart < 1e-8, apart
    assert any("pile" in m["member"] for m in answers[1].document["members"])
    return f"f and ζ of ten modes {apart:.0e} from those on heads; {exact_heads(case)}"


def exact_heads(case: ThesisCase) -> str:
    """Return how far piles as members are from their heads, at rest and in motion.

    Massless piles in elastic ground have the poles of their lumped heads. Others have those of the structure
    on the exact dynamic stiffness K(s) of a head, which Newton's method reaches.
    """
    ground = read_foundation(case.folder / "piles.yaml")
    elastic = replace(ground, law=ELASTIC)
    piled, support = elastic.piled(case.structure)
    piled = piled.with_material("piles", density=0.0)
    heads = replace(elastic.heads(case.structure), masses=())
    members = undamped_modes(build_system(assemble(piled), support), 12).omega
    at_rest = relative(members, undamped_modes(build_system(case.assembly, heads), 12).omega)
    piled, support = ground.piled(case.structure)
    pole = damped_modes(build_system(assemble(piled), support), below_hz=1.1 * case.pinned_hz[0]).eigenvalues[
        0
    ]
    feet = [case.assembly.dofs(node) for node in case.structure.reaction_nodes]

    def F(s: complex) -> sp.csc_array:
        head = head_impedance(ground.pile, ground.springs, s, law=ground.law, above=case.structure)[0]
        total = sp.lil_array((case.assembly.stiffness + s**2 * case.assembly.mass).astype(np.complex128))
        for dofs in feet:
            total[np.ix_(dofs, dofs)] = total[np.ix_(dofs, dofs)].toarray() + head
        return total.tocsc()

    found, x = pole * (1.0 + 1e-3), np.ones(case.assembly.n_dof, dtype=complex)
    for _ in range(8):
        slope = (F(found + 1e-6) - F(found - 1e-6)) / 2e-6
        x = spla.spsolve(F(found), slope @ x)
        x /= np.linalg.norm(x)
        found -= (x @ (F(found) @ x)) / (x @ (slope @ x))
    in_motion = float(abs(found / pole - 1.0))
    assert at_rest < 1e-8 and in_motion < 1e-8, (at_rest, in_motion)
    return f"from their heads at rest {at_rest:.0e}, in motion {in_motion:.0e}"


@row(35)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    assert answers[0].document["largest_frequency_error"] < 1e-2
    return "{n} coordinates, f within {largest_frequency_error:.0e}".format(**answers[0].document)


@row(36)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    modes = answers[0].document["true_modes"][:2]
    still = [m["damping_by_source"]["structure"] + m["damping_by_source"]["soil"] for m in modes]
    assert max(abs(z - 0.01) for z in still) < 5e-5, still
    return "both first modes at {:.3f} and {:.3f} % in still air".format(*(100 * z for z in still))


@row(37)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    decrement = answers[0].document["decrement"]
    return f"ζ {decrement['damping_ratio']:.4f}, pole {decrement['pole_damping_ratio']:.4f}"


@row(38)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    assert len(answers[0].document["cases"]) == 4
    return "4 records"


@row(39)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    bare = simulate(read_scenario(case.folder / "parked.yaml")).record.metadata["true_modes"]
    grown = answers[0].document["true_modes"]
    lower = grown[3]["frequency_hz"] / bare[3]["frequency_hz"] - 1.0
    assert lower < 0.0
    return f"f4 {100 * lower:.1f} %"


@row(40)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    steel, (density, modulus, *_) = answers[0].document["steel"], case.changed
    found = steel[case.parts[0]]["density"], steel[case.parts[-1]]["youngs_modulus"]
    assert relative(found, (density, modulus)) < 1e-6, found
    return f"density and modulus found; {refined(case)}"


def refined(case: ThesisCase) -> str:
    """Return what a refinement of walls, masses, growth and the rotor's mass finds of a changed structure."""
    part = case.parts[0]
    adjusted = [
        {"part": part, "property": "wall_thickness", "value": 1.04},
        {"body": "rna", "property": "mass", "value": 0.98},
    ]
    changed = {"source": str(case.file), "adjusted": adjusted}
    truth = read_twin(case.write("changed.yaml", {**case.twin, "structure": changed})).structure
    f = numbered_modes(assemble(truth), 5).frequency_hz
    alone = stages(truth, 4)[0].frequency_hz
    document = {
        "structure": str(case.file),
        "gravity": False,
        "stages": [
            {
                "parts": [part],
                "frequency_hz": dict(enumerate(map(float, alone), start=1)),
                "frequency_std": 1e-5,
                "free": [{"part": part, "property": "wall_thickness", "tolerance": 0.05}],
            },
            {
                "frequency_hz": dict(enumerate(map(float, f), start=1)),
                "frequency_std": 1e-5,
                "free": [{"body": "rna", "property": "mass", "tolerance": 0.05}],
            },
        ],
    }
    case.write("walls.yaml", document)
    found = said("refine", str(case.folder / "walls.yaml"), "--json").document["adjusted"]
    values = {one["property"]: one["value"] for one in found}
    assert relative([values["wall_thickness"], values["mass"]], [1.04, 0.98]) < 6e-3, values
    return f"walls × {values['wall_thickness']:.3f} of 1.04, rotor × {values['mass']:.3f} of 0.98"


@row(43)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    own = stages(case.structure, 5)
    for mine, theirs in zip(own, answers[0].document["stages"], strict=True):
        near([m["frequency_hz"] for m in theirs["modes"]], mine.frequency_hz, 1e-9)
    return f"{len(own)} stages, the same from Python"


@row(44)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    pairs = answers[0].document["stages"][-1]["shapes"]["pairs"]
    seen = answers[1].document["shapes"]["pairs"]
    # a deck's own feet may be clamped, those of a stage are pinned
    assert min(p["mac"] for p in (*pairs[:5], *seen[:5])) > 0.98
    *_, last = stages(case.structure, 5)
    own = compare_modes(last.assembly, last.modes, nodal_modes(last.assembly, last.modes))
    assert len(own.pairs) == len(pairs)
    return f"MAC of the first five at least {min(p['mac'] for p in pairs[:5]):.4f}"


# --- chapter 6


def found_first(case: ThesisCase, answer: Answer) -> str:
    """Assert that an identification has the first mode of the simulated record; return how near."""
    truth = read_record(case.folder / "day.parquet").metadata["true_modes"]
    f = np.array([m["frequency_hz"] for m in truth[:2]])
    found = [m["frequency_hz"] for m in answer.document["modes"]]
    apart = min(abs(x / y - 1.0) for x in found for y in f)
    assert apart < 0.02, (found, f)
    return f"first pair within {100 * apart:.1f} %"


@row(45)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    motions = answers[0].document["motions"]
    assert any("wave" in m for m in motions) and any("record" in m for m in motions), motions
    return f"{len(motions)} motions, a wave and a record among them"


@row(47)
@row(51)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return "; ".join(found_first(case, a) for a in answers)


@row(48)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    assert any(pick["order"] == 35 for pick in answers[0].document["picks"]), answers[0].document["picks"]
    wrong = case.folder / "wrong.yaml"
    wrong.write_text(yaml.safe_dump([{"order": 35, "frequency_hz": 1.31 * float(case.on_feet[0][0])}]))
    refused = said("identify", str(case.folder / "day.parquet"), "--picks", str(wrong), fails=True)
    assert "nearest" in refused.heard, refused.heard
    return "order 35 is taken; where it has no pole the nearest is named"


@row(49)
@row(50)
@row(52)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    page = (case.folder / "page.html").read_text("utf-8")
    assert "picks.yaml" in page and "MAC" in page
    return f"page of {len(page) // 1000} kB; " + found_first(case, answers[0])


@row(53)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    turned = {**case.scenario, "time": {"duration_s": 400, "step_s": 0.08}}
    turned["wind"] = {**turned["wind"], "yaw_deg": 40}
    turned["sensors"] = [
        *({**s, "node": case.top, "frame": "nacelle"} for s in case.sensors[:2]),
        *case.sensors[2:],
    ]
    for one in turned["sensors"][:2]:
        del one["height_m"]
    case.write("turned.yaml", turned)
    said("simulate", str(case.folder / "turned.yaml"), "--out", str(case.folder / "turned.parquet"))
    answer = said("identify", str(case.folder / "turned.parquet"), "--json")
    own = observe(read_record(case.folder / "turned.parquet"), TwinModel("identify"))
    assert len(own.identification.modes) == len(answer.document["modes"])
    shape = {name: complex(*value) for name, value in answer.document["modes"][0]["mode_shape"].items()}
    headings = [np.degrees(np.arctan2(shape[f"a{k}_y"].real, shape[f"a{k}_x"].real)) for k in (0, 1)]
    apart = abs((headings[0] - headings[1] + 90.0) % 180.0 - 90.0)
    assert apart < 5.0, headings
    return found_first(case, answer) + f" at a yaw of 40°, nacelle and tower move within {apart:.1f}°"


# --- chapters 7, 8 and 10


@row(54)
@row(59)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    support = answers[0].argv[answers[0].argv.index("--support") + 1]
    assert len(answers[0].document["real_poles_rad_s"]) > 0
    return near(hertz(answers[0]), from_python(case, support)[0], 1e-6)


def exact_feet(case: ThesisCase, answer: Answer, bound: float = 0.01) -> str:
    """Assert that an update finds the feet whose exact modes are its data."""
    k, c = case.feet
    found = answer.document["parameters"]
    apart = relative([found["k"]["best_fit"], found["c"]["best_fit"]], [k, c])
    assert apart < bound, (found, k, c)
    return f"k and c of the data within {apart:.0e}"


@row(55)
@row(56)
@row(57)
@row(58)
@row(66)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return exact_feet(case, answers[0])


@row(70)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    k = answers[0].document["parameters"]["k"]["value"]
    assert min(2.5e9, case.feet[0]) / 1.5 < k < max(2.5e9, case.feet[0]) * 1.5
    return f"k = {k:.3g}, between the prior's 2.5e9 and the data's {case.feet[0]:.3g}"


@row(60)
@row(62)
@row(63)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    differences = [a.document["largest_difference_from_central_differences"] for a in answers]
    assert max(differences) < 1e-4
    loci = [locus for a in answers for locus in a.document["loci"]]
    return f"{len(loci)} loci; derivatives within {max(differences):.0e} of differences"


@row(61)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    surface = np.array(answers[0].document["surface"]["cost"], dtype=float)
    assert surface.shape == (81, 81)
    own = explore(read_twin(case.folder / "twin.yaml"), law="kelvin-voigt", settings=ExploreSettings(grid=9))
    assert own.landscape is not None
    return f"81 × 81 costs from {np.nanmin(surface):.1e}; a grid of 9 from Python"


@row(65)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    fates = [path["fate"] for path in answers[0].document["paths"]]
    assert len(fates) >= 16 and set(fates) <= {"solution", "plateau", "stalled"}
    return ", ".join(f"{fates.count(f)} {f}" for f in sorted(set(fates)))


@row(67)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    ranking = answers[0].document["law_ranking"]
    assert len(ranking) >= 3 and all(r["cost"] is not None for r in ranking)
    own = run_twin(read_twin(case.folder / "twin.yaml"), laws=("kelvin-voigt",)).updates[0]
    mine = next(r for r in ranking if r["law"] == "kelvin-voigt")
    assert own.best.cost <= max(1e-10, 2.0 * mine["cost"])
    return ", ".join(f"{r['place']} {r['law']} {r['cost']:.0e}" for r in ranking)


@row(68)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    names = set(answers[0].document["parameters"])
    assert {"rayleigh_ratio", "rayleigh_frequency_hz"} <= names
    return "steel's ratio and frequency beside k and c"


@row(69)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    cost = answers[0].document["solutions"][0]["cost"]
    assert cost < 1e-6, cost
    return f"prony-2 meets the data of Kelvin–Voigt feet at a cost of {cost:.0e}"


@row(71)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return "five modes and their shapes: " + exact_feet(case, answers[0])


@row(72)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    system = build_system(case.assembly, read_support(case.relaxing, case.structure))
    true = np.abs(damped_modes(system, below_hz=2.0).real_poles)
    found = answers[0].document["real_poles"]
    assert found, answers[0].document
    rate, (low, high) = found[0]["rate_rad_s"], found[0]["rate_interval_90"]
    assert low < true.max() and high > true.min() and high < 1.2 * low, (low, high, true)
    plain = said("identify", str(case.folder / "pull.parquet"), "--json").document["modes"]
    asked = answers[0].document["modes"]
    assert [(m["frequency_hz"], m["status"]) for m in plain] == [
        (m["frequency_hz"], m["status"]) for m in asked
    ]
    return (
        f"{rate:.3g} rad/s found, 90 % {low:.3g} to {high:.3g}, true {true.min():.3g} to {true.max():.3g};"
        " modes as without --real-poles"
    )


@row(73)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    (pole,) = answers[0].document["real_poles"]
    return f"real pole {pole['measured_rate_rad_s']:.3g} given, {pole['rate_rad_s']:.3g} fitted"


@row(74)
def _(case: ThesisCase, answers: list[Answer]) -> str:
    return "on its simulated record: " + found_first(case, answers[0])


# --- numbers of this structure in place of the shipped one's


def with_shapes(case: ThesisCase, keys: dict[str, Any]) -> dict[str, Any]:
    """Return a twin on five modes with standard deviations and shapes at the sensors."""
    steel = Rayleigh.minimum(STEEL["ratio"], STEEL["frequency_hz"])
    system = build_system(case.assembly, read_support(case.law, case.structure), rayleigh=steel)
    modes = damped_modes(system, below_hz=1.05 * case.pinned_hz[-1])
    sensors = tuple(Sensor(s["channel"], tuple(s["direction"]), None, s["height_m"]) for s in case.sensors)
    seen = (observation_matrix(case.assembly, sensors) @ modes.shapes).real
    targets = [
        {
            "mode": i + 1,
            "frequency_hz": float(modes.frequency_hz[i]),
            "frequency_std_hz": 0.002 * float(modes.frequency_hz[i]),
            "damping_ratio": float(modes.damping_ratio[i]),
            "damping_ratio_std": 0.1 * float(modes.damping_ratio[i]),
            # sensors on the axis do not see a symmetric structure twist: no shape
            **({"mode_shape": shape} if np.abs(seen[:, i]).max() > 1e-6 * np.abs(seen).max() else {}),
        }
        for i in range(5)
        for shape in [{s.channel: float(v) for s, v in zip(sensors, seen[:, i], strict=True)}]
    ]
    places = [{key: s[key] for key in ("channel", "height_m", "direction")} for s in case.sensors]
    update = {**keys["update"], "starts": 8, "damping_of": "all"}
    rest = {key: case.twin[key] for key in ("structure", "gravity", "damping", "support")}
    return {**rest, "sensors": places, "targets": targets, "update": update, "tolerances": "none"}


def with_prior(case: ThesisCase, keys: dict[str, Any]) -> dict[str, Any]:
    """Return the twin with standard deviations, which a prior is weighed against."""
    targets = [{**t, "frequency_std_hz": 0.003 * t["frequency_hz"]} for t in case.twin["targets"]]
    targets[0]["damping_ratio_std"] = 0.1 * targets[0]["damping_ratio"]
    rest = {key: case.twin[key] for key in ("structure", "gravity", "damping", "support")}
    return {**rest, "targets": targets, "update": {**keys["update"], "starts": 8}, "tolerances": "none"}


def with_real_pole(case: ThesisCase, keys: dict[str, Any]) -> dict[str, Any]:
    """Return a twin on the first modes and a real pole of Zener feet."""
    system = build_system(case.assembly, read_support(case.relaxing, case.structure))
    modes = damped_modes(system, below_hz=2.0)
    first, *_, real = keys["targets"]
    rate = float(np.median(np.abs(modes.real_poles)))
    given = [
        {
            **first,
            "frequency_hz": float(modes.frequency_hz[0]),
            "damping_ratio": float(modes.damping_ratio[0]),
        },
        {"mode": 4, "frequency_hz": float(modes.frequency_hz[3])},
        {**real, "rate_rad_s": rate, "rate_std_rad_s": 0.1 * rate},
    ]
    return {**case.twin, "damping": {"rayleigh": {"ratio": 1e-6, "frequency_hz": 0.4}}, "targets": given}


TWINS = {70: with_prior, 71: with_shapes, 73: with_real_pole}


# --- the walk


@dataclass(frozen=True)
class Walked:
    """A row on a structure: whether its check holds, and what it says."""

    row: Row
    good: bool
    words: str
    cpu_s: float
    silent_s: float


def walk(case: ThesisCase, wanted: Iterable[int], *, text: bool = False) -> Iterator[Walked]:
    """Yield the rows on a structure, each with its check; with ``text`` as on the terminal, too."""
    for one in rows():
        if one.number not in wanted or one.number in PUBLISHED:
            continue
        answers: list[Answer] = []
        try:
            answers = walked(one, case, TWINS, text=text)
            good, words = True, CHECKS[one.number](case, answers)
        except Exception as error:
            good, words = False, f"{type(error).__name__}: {error}"
        cpu, silent = sum(a.cpu_s for a in answers), max([a.silent_s for a in answers], default=0.0)
        yield Walked(one, good, words, cpu, silent)


def report(found: dict[str, list[Walked]]) -> list[str]:
    """Return the page."""
    good = {name: sum(w.good for w in done) for name, done in found.items()}
    every = [w for done in found.values() for w in done]
    total = len(next(iter(found.values())))
    lines = [
        "# The rows of the thesis on other structures",
        "",
        "`python qualify/thesis_rows.py [STRUCTURE …]` gives the commands of [the page](thesis.md) with a",
        "structure in place of the shipped one, computes the same from Python or in closed form, and",
        "compares. Without names the structures are those of `qualify/decks`, made for this: three legs with",
        "K-braces; four unlike legs on a slope with Z- and X-braces and girders, node by node; a tower on a",
        "SubDyn deck;",
        "four legs, symmetric about both axes and the diagonals.",
        "",
        "; ".join(f"{name}: {n} of {total} rows hold" for name, n in good.items())
        + f". The other {74 - total} rows",
        "are published numbers, which no other structure has: `jackettwin verify` recomputes them.",
        f"The commands take {sum(w.cpu_s for w in every) / len(found):.0f} CPU-s a structure, the longest",
        f"silence of one is {max(w.silent_s for w in every):.1f} CPU-s.",
        "",
        "| no. | what | " + " | ".join(found) + " |",
        "|---|---|" + "---|" * len(found),
    ]
    for k, first in enumerate(next(iter(found.values()))):
        cells = (("" if done[k].good else "FAILS: ") + done[k].words[:120] for done in found.values())
        words = " | ".join(" ".join(cell.split()).replace("|", "/") for cell in cells)
        lines.append(f"| {first.row.number} | {first.row.what} | {words} |")
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("structures", nargs="*", type=Path)
    parser.add_argument("--rows", default=",".join(map(str, range(1, 75))))
    parser.add_argument("--folder", type=Path, help="for the companion files; default: a temporary one")
    options = parser.parse_args()
    wanted = {int(number) for number in options.rows.split(",")}
    files = options.structures or [DECKS / f"{name}.yaml" for name in STRUCTURES]
    found: dict[str, list[Walked]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        for file in files:
            folder = (options.folder or Path(temporary)).absolute() / file.stem
            folder.mkdir(parents=True, exist_ok=True)
            found[file.stem] = []
            for one in walk(prepared(file, folder), wanted, text=file is files[0]):
                found[file.stem].append(one)
                mark = "" if one.good else "FAILS "
                sys.stderr.write(
                    f"{file.stem} {one.row.number}: {mark}{one.words} "
                    f"({one.cpu_s:.1f} CPU-s, silent {one.silent_s:.1f})\n"
                )
    if options.structures or len(wanted) < 74:
        sys.stdout.write("\n".join(report(found)) + "\n")
    else:
        write_page("thesis_rows", report(found))


if __name__ == "__main__":
    main()
