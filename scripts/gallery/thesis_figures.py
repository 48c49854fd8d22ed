"""The thesis's figures, drawn from our own computations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import as_file, files

import numpy as np
import plotly.graph_objects as go

from gallery import figures_theory, schematics
from gallery.figures_elevation import elevation
from gallery.modes_3d import Shape, mode_shapes_3d
from gallery.open_questions import open_questions
from gallery.structure_3d import structure_3d
from jackettwin.decks import read_structure
from jackettwin.identification import Identification, identify, mac
from jackettwin.records import Record, read_record
from jackettwin.report.figures import (
    identification as figures_identification,
    landscape,
    law,
    record as figures_record,
)
from jackettwin.report.pages.page import PageSection, Plot
from jackettwin.report.tables.numbers import frequency, percent, scientific, words
from jackettwin.response import FreeVibration, free_vibration
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.modes.modal import UndampedModes
from jackettwin.response.motion.time import free_decay
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.soil import family, law_curves
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt, maxwell, zener
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import (
    SupportModel,
    cost_curve,
    cost_surface,
    numbered_modes,
    root_locus,
    single,
    support_model,
)
from jackettwin.updating.steel import only_parts
from jackettwin.verify import supports
from jackettwin.verify.open_questions import fit, ways

RECORD = "pile_U12_s301"
"""The shipped record behind the figures of identification: OpenFAST, 12 m/s."""
STEPS = 5
"""How often ``thesis_figures`` announces what it does."""
_KV_1, _KV_2 = supports.KELVIN_VOIGT
_ZENER_1, _ZENER_2 = supports.ZENER


@dataclass(frozen=True)
class _Jacket:
    """The reference structure on pinned feet."""

    assembly: Assembly
    steel: Rayleigh
    pinned: UndampedModes
    labels: tuple[str, ...]


def thesis_figures(step: Callable[[str], None] = lambda _: None) -> list[PageSection]:
    """Return the gallery's sections: every listed figure of the thesis, from the same code as the report."""
    assembly = assemble(read_structure("jacket15"))
    pinned = numbered_modes(assembly, 8)
    labels = mode_labels(mode_kinds(assembly, pinned.shapes, pinned.frequency_hz))
    jacket = _Jacket(assembly, Rayleigh.minimum(0.01, float(pinned.frequency_hz[0])), pinned, labels)
    with as_file(files("jackettwin.data") / "records") as directory:
        record = read_record(directory / f"{RECORD}.parquet")
    step("figures of chapters 3 and 4")
    sections = [
        PageSection("Chapter 3: theory of structures", tuple(_chapter_3(jacket))),
        PageSection("Chapter 4: viscoelastic laws", tuple(_chapter_4())),
    ]
    step("figures of chapter 5")
    sections.append(PageSection("Chapter 5: the jacket", tuple(_chapter_5(jacket, record))))
    step("figures of chapter 6")
    found = identify(record)
    names = _paired_names(jacket, found)
    sections.append(PageSection("Chapter 6: identification", tuple(_chapter_6(found, names))))
    step("figures of chapters 7 and 8")
    sections.append(PageSection("Chapter 7: viscoelastic supports", (_figure_7_1(jacket),)))
    sections.append(PageSection("Chapter 8: updating", tuple(_chapter_8(jacket))))
    sections.append(open_questions())
    step("figures of chapter 11")
    sections.append(PageSection("Chapter 11: appendix", tuple(_chapter_11(record, found, names))))
    return sections


def _chapter_3(jacket: _Jacket) -> list[Plot]:
    regimes = {
        f"{name}, ζ = {zeta:g}": free_vibration(
            1.0, kelvin_voigt(4.0 * np.pi**2, 4.0 * np.pi * zeta), duration_s=5.0
        )
        for name, zeta in (("underdamped", 0.1), ("critically damped", 1.0), ("overdamped", 2.0))
    }
    return [
        Plot(
            "figure_3_1",
            "Figure 3.1: a mass on a Kelvin–Voigt element.",
            schematics.draw([("", schematics.sdof(schematics.kelvin_voigt_element()))], height=300),
        ),
        Plot(
            "figure_3_2",
            "Figure 3.2: free vibration in the three regimes of damping; undamped, a period takes a second.",
            law.let_go(regimes),
        ),
        Plot(
            "figure_3_3",
            "Figure 3.3: the structure in the plane; the rotor–nacelle assembly is the larger node.",
            elevation([("", jacket.assembly)]),
        ),
    ]


def _chapter_4() -> list[Plot]:
    laws = {
        "Maxwell": (schematics.maxwell_element(("E", "η")), maxwell(1.0, 1.0)),
        "Kelvin–Voigt": (schematics.kelvin_voigt_element(("E", "η")), kelvin_voigt(1.0, 1.0)),
        "Zener": (schematics.zener_element(("E₁", "E₂", "η")), zener(0.5, 0.5, 0.5)),
    }
    caption = (
        "Figure 4.2: relaxation under a unit step of strain, creep under a unit step of stress, as "
        "jackettwin law draws them. Kelvin–Voigt also gives an impulse at t = 0, not drawn."
    )
    curves = {name: law_curves(one, 0.03, 1e3) for name, (_, one) in laws.items()}
    return [
        Plot(
            "figure_4_1",
            "Figure 4.1: harmonic loading of an elastic spring and of a Zener element.",
            law.cycle({"elastic": Prony(k0=1.0), "viscoelastic": zener(0.5, 0.3, 1.0)}, 0.5),
        ),
        Plot(
            "figure_4_2_models",
            "Figure 4.2: the models.",
            schematics.draw([(name, drawing) for name, (drawing, _) in laws.items()], height=240),
        ),
        Plot("figure_4_2", caption, law.transients(curves)),
        Plot(
            "figure_4_3",
            "Figure 4.3: a mass on a Zener element.",
            schematics.draw([("", schematics.sdof(schematics.zener_element()))], height=300),
        ),
    ]


def _chapter_5(jacket: _Jacket, record: Record) -> list[Plot]:
    structure = jacket.assembly.structure
    staged = [
        ("(a) jacket", assemble(only_parts(structure, ("jacket",)))),
        ("(b) with transition piece", assemble(only_parts(structure, ("jacket", "transition_piece")))),
        ("(c) full", jacket.assembly),
    ]
    shapes = [_pinned_shape(jacket, mode) for mode in range(1, 6)]
    smeared = "Marine growth and water in flooded members (figure 5.7) are smeared into the jacket's density."
    return [
        Plot(
            "figure_5_1",
            "Figure 5.1: the parts of the structure.",
            elevation([("", jacket.assembly)], notes=True),
        ),
        Plot(
            "figure_5_2",
            "Figure 5.2: springs and dashpots along a pile.",
            schematics.draw([("", schematics.pile_springs())], height=520),
        ),
        Plot(
            "figure_5_3",
            "Figure 5.3: modes 1, 2 and 4 on pinned feet.",
            mode_shapes_3d(jacket.assembly, [shapes[i] for i in (0, 1, 3)]),
        ),
        _figure_5_4(jacket),
        Plot(
            "figure_5_5",
            f"Figure 5.5: acceleration of the tower top, record {record.name}.",
            _pair(record, "top"),
        ),
        Plot(
            "figure_5_6", "Figures 5.6, 5.8 and 5.10: the three stages of the refinement.", elevation(staged)
        ),
        Plot(
            "figure_5_9_density",
            f"Figures 5.7 and 5.9 (a): density by member. {smeared}",
            structure_3d(jacket.assembly, colour="density"),
        ),
        Plot(
            "figure_5_9_modulus",
            "Figure 5.9 (b): modulus of elasticity by member.",
            structure_3d(jacket.assembly, colour="Young's modulus"),
        ),
        Plot(
            "figure_5_11",
            "Figures 5.11 and 5.12: the first five modes on pinned feet.",
            mode_shapes_3d(jacket.assembly, shapes),
        ),
    ]


def _pinned_shape(jacket: _Jacket, mode: int) -> Shape:
    label = jacket.labels[mode - 1]
    text = (
        f"<b>mode {mode}</b>, {words(label)}<br>{frequency(float(jacket.pinned.frequency_hz[mode - 1]))} Hz"
    )
    return Shape(text, label, jacket.pinned.shapes[:, mode - 1].astype(np.complex128))


def _figure_5_4(jacket: _Jacket) -> Plot:
    """Release the tower top from a pull along x on the Kelvin–Voigt feet of point 1."""
    model = support_model(jacket.assembly, family=family("kelvin-voigt"), rayleigh=jacket.steel)
    pencil = model.condensed.pencil.with_laws(model.laws(np.array(_KV_1)))
    top = jacket.assembly.dofs(jacket.assembly.structure.top_node)[0]
    row = model.condensed.basis[top]
    pulled = np.linalg.solve(pencil.static_stiffness(), 1e6 * row)
    step_s, n = 0.1, 3000
    motion = free_decay(pencil, pulled, step_s=step_s, n_steps=n) @ row
    pole = model.predict(np.array(_KV_1), (2,)).poles[0]
    f, zeta = abs(pole) / (2.0 * np.pi), -pole.real / abs(pole)
    seen = FreeVibration(
        np.array([pole, pole.conjugate()]),
        "underdamped",
        f,
        zeta,
        np.linspace(0.0, step_s * n, n + 1),
        motion / motion[0],
    )
    caption = (
        "Figure 5.4: free decay of the tower top after a pull of 1 MN along x, on Kelvin–Voigt feet "
        f"(k {scientific(_KV_1[0])} N/m, c {scientific(_KV_1[1])} N·s/m): {frequency(f)} Hz, "
        f"ζ {percent(zeta)} %, logarithmic decrement {seen.logarithmic_decrement or 0.0:.4f}."
    )
    return Plot("figure_5_4", caption, law.let_go({"tower top": seen}))


def _pair(record: Record, place: str) -> go.Figure:
    return figures_record.time_series(record, channels=[f"acc_{place}_x", f"acc_{place}_y"])


def _chapter_6(found: Identification, names: list[str]) -> list[Plot]:
    source = f"record {found.records[0]} (OpenFAST)"
    return [
        Plot(
            "figure_6_1",
            f"Figure 6.1: stabilisation in frequency, {source}.",
            figures_identification.stabilisation(found, names),
        ),
        Plot(
            "figure_6_2",
            f"Figure 6.2: damping against frequency, {source}.",
            figures_identification.damping_against_frequency(found, names),
        ),
    ]


def _paired_names(jacket: _Jacket, found: Identification) -> list[str]:
    """Return the label of the pinned mode nearest in shape and within 15 % in frequency."""
    sensors = tuple(Sensor(c.name, c.direction, node=c.node, height_m=c.height_m) for c in found.channels)
    H = observation_matrix(jacket.assembly, sensors) @ jacket.pinned.shapes
    names = [""] * len(found.modes)
    for j, f in enumerate(jacket.pinned.frequency_hz):
        near = [i for i, m in enumerate(found.modes) if abs(m.frequency_hz / f - 1.0) < 0.15 and not names[i]]
        best = max(near, key=lambda i: float(mac(found.modes[i].mode_shape, H[:, j])), default=None)
        if best is not None and float(mac(found.modes[best].mode_shape, H[:, j])) > 0.5:
            names[best] = jacket.labels[j]
    return names


def _figure_7_1(jacket: _Jacket) -> Plot:
    lower = assemble(only_parts(jacket.assembly.structure, ("jacket", "transition_piece")))
    drawings = [
        ("(a) Kelvin–Voigt", schematics.on_supports(lower, schematics.kelvin_voigt_element())),
        ("(b) Zener", schematics.on_supports(lower, schematics.zener_element())),
    ]
    caption = "Figure 7.1: the structure on viscoelastic feet; a third element acts across the plane."
    return Plot("figure_7_1", caption, schematics.draw(drawings, height=760))


def _chapter_8(jacket: _Jacket) -> list[Plot]:
    plots = [_figure_8_1(jacket), *_surfaces()]
    bare_kv = support_model(jacket.assembly, family=family("kelvin-voigt"), rayleigh=Rayleigh())
    plots += [
        _locus(bare_kv, theta, f"figure_8_4_{x}", f"Figure 8.4 ({x})")
        for x, theta in (("a", _KV_1), ("b", _KV_2))
    ]
    zener_model = support_model(jacket.assembly, family=family("zener"), rayleigh=jacket.steel)
    plots += [
        _sensitivity(zener_model, theta, name) for name, theta in (("8.5", _ZENER_1), ("8.6", _ZENER_2))
    ]
    bare = support_model(jacket.assembly, family=family("zener"), rayleigh=Rayleigh())
    plots += [
        _locus(bare, theta, f"figure_8_7_{x}", f"Figure 8.7 ({x})")
        for x, theta in (("a", _ZENER_1), ("b", _ZENER_2))
    ]
    return plots


def _figure_8_1(jacket: _Jacket) -> Plot:
    k0, k1 = supports.FIGURE_8_1_K0, supports.FIGURE_8_1_K1
    model = support_model(jacket.assembly, family=family("zener"), rayleigh=Rayleigh())
    path = root_locus(model, np.array([k0, 1e9, k1]), "c", (1,))
    limits = tuple(supports.elastic_f1(jacket.assembly, k) for k in (k0, k0 + k1))
    caption = f"Figure 8.1: f₁ of the Zener model against c; k₀ {scientific(k0)}, k₁ {scientific(k1)} N/m."
    return Plot("figure_8_1", caption, figures_theory.frequency_along(path, 0, (limits[0], limits[1])))


def _surfaces() -> list[Plot]:
    result = fit("kelvin-voigt", zeta_4=False)
    k, c = _KV_1
    points = [("thesis, point 1", k, c), ("thesis, point 2: damper nearly locked", *_KV_2)]
    points += [
        (f"solution {i}{', locked damper' if s.locked_damper else ''}", *map(float, s.theta))
        for i, s in enumerate(result.solutions[:4], start=1)
    ]
    theta, problem = np.array(_KV_1), result.problem
    x, y = (np.geomspace(p.low, p.high, 48) for p in problem.parameters)
    wide = cost_surface(problem, theta, (0, 1), x, y)
    close = cost_surface(
        problem, theta, (0, 1), np.geomspace(0.5 * k, 2.0 * k, 36), np.geomspace(0.5 * c, 2.0 * c, 36)
    )
    near = [p for p in points if 0.5 * k < p[1] < 2.0 * k and 0.5 * c < p[2] < 2.0 * c]
    return [
        Plot(
            "figure_8_2",
            "Figure 8.2: cost of the Kelvin–Voigt model over its bounds, targets of Table 6.1, and where the "
            "simplex goes from the thesis's points and from 16 scattered ones.",
            landscape.cost_surface(wide, points, ways("kelvin-voigt", "nelder-mead")),
        ),
        Plot("figure_8_3", "Figure 8.3: close-up of point 1.", landscape.cost_surface(close, near)),
    ]


def _locus(model: SupportModel, theta: tuple[float, ...], name: str, title: str) -> Plot:
    path = root_locus(model, np.array(theta), "c", (1,))
    values = ", ".join(f"{p.name} {scientific(v)}" for p, v in zip(model.parameters, theta, strict=True))
    caption = (
        f"{title}: root locus of mode 1 as c varies, {model.family.name}, {values}; the steel is undamped."
    )
    return Plot(name, caption, landscape.root_locus(path, ("side_side_1",)))


def _sensitivity(model: SupportModel, theta: tuple[float, ...], number: str) -> Plot:
    problem = single(model, supports.table_6_1())
    curves = [cost_curve(problem, np.array(theta), j) for j in range(len(theta))]
    values = ", ".join(f"{p.name} {scientific(v)}" for p, v in zip(model.parameters, theta, strict=True))
    caption = f"Figure {number}: cost as one parameter moves by ±50 %, Zener at {values}."
    return Plot(f"figure_{number.replace('.', '_')}", caption, landscape.cost_curves(curves))


def _chapter_11(record: Record, found: Identification, names: list[str]) -> list[Plot]:
    close = figures_identification.stabilisation(found, names, band=(0.15, 0.21))
    places = (("2", "g77", "77 m"), ("3", "g41", "41 m"), ("4", "tp", "the transition piece"))
    return [
        Plot(
            "figure_11_1", "Figure 11.1: stabilisation in frequency, close-up of the first two modes.", close
        ),
        *(
            Plot(
                f"figure_11_{number}", f"Figure 11.{number}: accelerations at {where}.", _pair(record, place)
            )
            for number, place, where in places
        ),
    ]
