"""Frames and beams that others use to check their programs: NAFEMS, MacNeal & Harder, Timoshenko & Gere."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import cos, pi, sin, sqrt

import numpy as np
import scipy.linalg

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.response import build_system, nodal_load, static_displacement, undamped_modes
from jackettwin.soil import Support, clamped
from jackettwin.structure import (
    Beam,
    Material,
    Member,
    PointMass,
    Reaction,
    RigidLink,
    Section,
    Structure,
    Vector,
    assemble,
    rectangular_section,
)
from jackettwin.verify.rows import Computed

_STEEL = Material(200e9, density_kg_m3=8000.0)
"""Of every NAFEMS test here."""
_OUT_OF_PLANE = (2, 3, 4)
_ALL = (0, 1, 2, 3, 4, 5)


def frame_benchmarks() -> Computed:
    """Return frequencies [Hz], displacements and buckling factors of the frames, by their ids."""
    return {
        **_double_cross(),
        **_square_frame(),
        **_off_centre_masses(),
        **_deep_beam(),
        **_single_spans(),
        **_straight_beam(),
        **_curved_beam(),
        **_twisted_beam(),
        **_columns(),
    }


def _double_cross() -> Computed:
    """Eight arms of 5 m, pinned at their ends, in their plane."""
    side, lines = 0.125, []
    nodes: dict[str, Vector] = {"centre": (0.0, 0.0, 0.0)}
    held: dict[str, tuple[int, ...]] = {}
    for arm in range(8):
        names = [f"{arm}.{k}" for k in range(1, 9)]
        for k, name in enumerate(names, start=1):
            r = 5.0 * k / 8.0
            nodes[name] = (r * cos(arm * pi / 4.0), r * sin(arm * pi / 4.0), 0.0)
        lines.append(["centre", *names])
        held[names[-1]] = (0, 1, *_OUT_OF_PLANE)
    held = dict.fromkeys(nodes, _OUT_OF_PLANE) | held
    f = _frequencies(_bars("double cross", nodes, lines, side), held, 16)
    return dict(zip(("FV2-1", "FV2-2", "FV2-9", "FV2-10"), f[[0, 1, 8, 9]].tolist(), strict=True))


def _square_frame() -> Computed:
    """A free frame of four beams of 10 m, in its plane."""
    corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)]
    nodes: dict[str, Vector] = {}
    lines = []
    for side, (a, b) in enumerate(pairwise(corners)):
        names = [*(f"{side}.{k}" for k in range(12)), f"{(side + 1) % 4}.0"]
        ends = np.linspace(a, b, 13)
        nodes |= {n: (float(x), float(y), 0.0) for n, (x, y) in zip(names[:-1], ends[:-1], strict=True)}
        lines.append(names)
    f = _frequencies(_bars("square frame", nodes, lines, 0.25), dict.fromkeys(nodes, _OUT_OF_PLANE), 10)
    return {f"FV3-{mode}": float(f[mode - 1]) for mode in (4, 5, 6, 8, 9, 10)}


def _off_centre_masses() -> Computed:
    """A round cantilever of 10 m with masses 2 m to either side of its tip."""
    round_bar, n = Section(0.5, 0.25), 20
    nodes: dict[str, Vector] = {f"n{k}": (10.0 * k / n, 0.0, 0.0) for k in range(n + 1)}
    nodes |= {"heavy": (10.0, 2.0, 0.0), "light": (10.0, -2.0, 0.0)}
    tip = f"n{n}"
    structure = Structure(
        "FV4",
        nodes,
        tuple(
            Member(f"m{k}", f"n{k}", f"n{k + 1}", round_bar, round_bar, _STEEL) for k in range(n)
        ),
        masses=(PointMass("heavy", 10e3), PointMass("light", 1e3)),
        rigid_links=(RigidLink(tip, "heavy"), RigidLink(tip, "light")),
        reactions=(Reaction("n0"),),
    )  # fmt: skip
    f = undamped_modes(build_system(assemble(structure), clamped(structure)), 6).frequency_hz
    return {f"FV4-{mode}": float(value) for mode, value in enumerate(f, start=1)}


def _deep_beam() -> Computed:
    """A square beam of 10 m × 2 m × 2 m on two supports, with shear and rotary inertia."""
    n = 40
    nodes: dict[str, Vector] = {f"n{k}": (10.0 * k / n, 0.0, 0.0) for k in range(n + 1)}
    beam = _bars("deep beam", nodes, [list(nodes)], 2.0, theory="timoshenko")
    f = _frequencies(beam, {"n0": (0, 1, 2, 3), f"n{n}": (1, 2)}, 9)
    return {f"FV5-{mode}": float(f[mode - 1]) for mode in (1, 3, 4, 5, 7, 8)}


def _single_spans() -> Computed:
    """λ of f = λ²/(2πL²) √(EI/m) for clamped–clamped and clamped–pinned beams."""
    side, L, n = 0.1, 10.0, 30
    nodes: dict[str, Vector] = {f"n{k}": (L * k / n, 0.0, 0.0) for k in range(n + 1)}
    beam = _bars("span", nodes, [list(nodes)], side)
    per_square = sqrt(_STEEL.youngs_modulus_pa / _STEEL.density_kg_m3 / 12.0) * side / (2.0 * pi * L**2)
    in_plane = dict.fromkeys(nodes, _OUT_OF_PLANE)
    found: Computed = {}
    for key, last in (("clamped-clamped", _ALL), ("clamped-pinned", (0, 1, *_OUT_OF_PLANE))):
        f = _frequencies(beam, in_plane | {"n0": _ALL, f"n{n}": last}, 3)
        found |= {f"span-{key}-{k}": sqrt(float(value) / per_square) for k, value in enumerate(f, start=1)}
    return found


def _straight_beam() -> Computed:
    """MacNeal & Harder's straight cantilever, 6 × 0.2 × 0.1, unit forces at its tip."""
    material = Material(1e7, density_kg_m3=0.0)
    nodes: dict[str, Vector] = {f"n{k}": (float(k), 0.0, 0.0) for k in range(7)}
    beam = _bars("straight", nodes, [list(nodes)], (0.2, 0.1), theory="timoshenko", material=material)
    names = ("extension", "in-plane", "out-of-plane", "twist")
    return {f"MH-straight-{name}": value for name, value in zip(names, _at_tip(beam), strict=True)}


def _curved_beam() -> Computed:
    """MacNeal & Harder's quarter of a ring, radii 4.12 and 4.32, 0.1 thick."""
    n, radius = 24, 4.22
    turned = np.linspace(0.0, 0.5 * pi, n + 1)
    nodes: dict[str, Vector] = {
        f"n{k}": (radius * sin(a), radius * cos(a), 0.0) for k, a in enumerate(turned.tolist())
    }
    material = Material(1e7, poisson_ratio=0.25, density_kg_m3=0.0)
    ring = _bars("curved", nodes, [list(nodes)], (0.2, 0.1), theory="timoshenko", material=material)
    # at its tip the ring runs along −y
    in_plane, _, out_of_plane, _ = _at_tip(ring)
    return {"MH-curved-in-plane": in_plane, "MH-curved-out-of-plane": out_of_plane}


def _twisted_beam() -> Computed:
    """MacNeal & Harder's beam of 12 × 1.1 × 0.32, twisted by 90° between its ends."""
    n = 48
    nodes: dict[str, Vector] = {f"n{k}": (12.0 * k / n, 0.0, 0.0) for k in range(n + 1)}
    material = Material(29e6, poisson_ratio=0.22, density_kg_m3=0.0)
    twist = [0.5 * pi * (k + 0.5) / n for k in range(n)]
    beam = _bars(
        "twisted", nodes, [list(nodes)], (1.1, 0.32), theory="timoshenko", material=material, twist=twist
    )
    _, first, second, _ = _at_tip(beam)
    return {"MH-twisted-along-width": first, "MH-twisted-along-depth": second}


def _columns() -> Computed:
    """Return qL³/EI of a heavy column, and PL²/EI of a light one with a weight on its tip, as they buckle."""
    tube, L, n = Section(0.5, 0.01), 50.0, 20
    nodes: dict[str, Vector] = {f"n{k}": (0.0, 0.0, L * k / n) for k in range(n + 1)}
    d = tube.outer_diameter_m - 2.0 * tube.thickness_m
    A, I = pi / 4.0 * (0.5**2 - d**2), pi / 64.0 * (0.5**4 - d**4)  # noqa: E741

    def factor(density: float, tip_kg: float) -> float:
        steel = Material(210e9, density_kg_m3=density)
        members = (Member(f"m{k}", f"n{k}", f"n{k + 1}", tube, tube, steel) for k in range(n))
        column = Structure(
            "column", nodes, tuple(members), masses=(PointMass(f"n{n}", tip_kg),), reactions=(Reaction("n0"),)
        )
        return _buckling_factor(column)

    EI, weight = 210e9 * I, 7850.0 * A * L * GRAVITY_M_S2
    return {
        "column-own-weight": factor(7850.0, 0.0) * weight * L**2 / EI,
        "column-tip-weight": factor(0.0, 1e3) * 1e3 * GRAVITY_M_S2 * L**2 / EI,
    }


def _buckling_factor(structure: Structure) -> float:
    """Return by what the weight must be multiplied until a clamped structure buckles."""
    elastic, with_weight = (
        build_system(assemble(structure, gravity=gravity), clamped(structure)).pencil.K.toarray()
        for gravity in (False, True)
    )
    softening = scipy.linalg.eigh(elastic - with_weight, elastic, eigvals_only=True)
    return 1.0 / float(softening.max())


def _bars(
    name: str,
    nodes: dict[str, Vector],
    lines: list[list[str]],
    sides: float | tuple[float, float],
    *,
    theory: str = "euler-bernoulli",
    material: Material = _STEEL,
    twist: Iterable[float] | None = None,
) -> Structure:
    """Return beams of a rectangular section along lines of nodes; the first side lies in the x–y plane."""
    a, b = sides if isinstance(sides, tuple) else (sides, sides)
    section = rectangular_section(a, b, 0.0, poisson_ratio=material.poisson_ratio)
    pairs = [pair for line in lines for pair in pairwise(line)]
    turned = [0.0] * len(pairs) if twist is None else list(twist)
    beams = tuple(
        Beam(f"{start}-{end}", start, end, section, material, angle)
        for (start, end), angle in zip(pairs, turned, strict=True)
    )
    return Structure(name, nodes, (), beams=beams, beam=theory)


def _frequencies(structure: Structure, held: dict[str, tuple[int, ...]], n: int) -> FloatArray:
    """Return the lowest ``n`` frequencies [Hz] with these DOFs of nodes held."""
    system = build_system(assemble(structure), Support(fixed=tuple(held.items())))
    return undamped_modes(system, n).frequency_hz


def _at_tip(structure: Structure) -> tuple[float, float, float, float]:
    """Return what the tip moves along x, y, z under unit forces there, and turns under a unit torque."""
    first, *_, tip = structure.nodes
    system = build_system(assemble(structure), Support(fixed=((first, _ALL),)))
    dofs = system.assembly.dofs(tip)

    def moved(along: int) -> float:
        unit = tuple(float(k == along) for k in range(6))
        load = nodal_load(system.assembly, {tip: unit})
        return float(static_displacement(system, load)[dofs[along]])

    x, y, z, turned = (moved(along) for along in range(4))
    return x, y, z, turned
