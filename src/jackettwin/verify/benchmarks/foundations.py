"""Foundations and towers that other programs computed: SubDyn, BModes, ANSYS."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response import System, build_system, nodal_load, static_displacement, undamped_modes
from jackettwin.soil import Spring, Support, clamped
from jackettwin.structure import (
    Beam,
    BeamSection,
    Material,
    Member,
    PointMass,
    Reaction,
    RigidLink,
    Section,
    Structure,
    assemble,
    two_node_element,
)
from jackettwin.verify.rows import Computed

_GRAVITY_M_S2 = 9.8066
"""Of the input of ANSYS's case."""
_TOWER_M = np.array([0.0, 0.27881, 0.27882, 0.35094, 0.42306, 0.49517, 0.56729,
                     0.63941, 0.71153, 0.78365, 0.85576, 0.92788, 1.0]) * 107.6  # fmt: skip
"""Stations of the OC3 monopile and its tower above the mud line, CS_monopile_tower_secs.dat."""
_MASS = np.array([9517.14, 9517.14, 4306.51, 4030.44, 3763.45, 3505.52, 3256.66, 3016.86, 2786.13, 2564.46,
                  2351.87, 2148.34, 1953.87])  # fmt: skip
_INERTIA = np.array([41979.2, 41979.2, 19205.6, 16720.0, 14483.4, 12478.7, 10689.2, 9098.9, 7692.7, 6455.7,
                     5373.9, 4433.6, 3622.1])  # fmt: skip
_BENDING = 1e9 * np.array([1037.13, 1037.13, 474.49, 413.08, 357.83, 308.30, 264.08, 224.80, 190.06, 159.49,
                           132.77, 109.54, 89.49])  # fmt: skip
_TORSION = 1e9 * np.array([798.098, 798.098, 365.133, 317.878, 275.356, 237.242, 203.220, 172.987, 146.252,
                           122.735, 102.167, 84.291, 68.863])  # fmt: skip
"""Mass [kg/m], rotary inertia [kg·m], EI and GJ [N·m²] at the stations, between which they are linear."""
_ELEMENTS = np.concatenate([
    [0.0], np.linspace(0.003481894, 0.135793872, 20), [0.1399], np.linspace(0.149721448, 0.247214485, 15),
    [0.250696379, 0.320334262, 0.37971, 0.424791072, 0.45961], np.linspace(0.486635, 1.0, 20),
])  # fmt: skip
"""Ends of its elements over its height, CS_Monopile.bmi; the wall's step at 30 m lies within one of 7.5 m."""
_PILE = {"x": 2.5748e9, "xry": -2.25325e10, "ry": 2.629123e11}
"""Coupled springs of the pile at the mud line [N/m, N, N·m/rad], CS_Monopile.bmi."""


def foundation_benchmarks() -> Computed:
    """Return what SubDyn, BModes and ANSYS computed, by the rows' ids."""
    return {**_oc3_monopile(), **_coupled_springs(), **_pinned_beam()}


def _oc3_monopile() -> Computed:
    """Return mass, frequencies and Guyan matrices at z = 10 m of the OC3 monopile, clamped in the bed."""
    steel = Material(210e9, shear_modulus_pa=80.8e9, density_kg_m3=8500.0)
    levels, tube = (-20.0001, -10.0, 0.0, 10.0), Section(6.0, 0.06)
    nodes = {f"n{k}": (0.0, 0.0, z) for k, z in enumerate(levels)}
    members = tuple(Member(f"m{k}", f"n{k}", f"n{k + 1}", tube, tube, steel) for k in range(3))
    pile = Structure(
        "OC3 monopile", nodes, members, reactions=(Reaction("n0"),), subdivide=3, beam="timoshenko",
        rotary_inertia=True, shear_in_mass=False,
    )  # fmt: skip
    assembly = assemble(pile)
    system = build_system(assembly, clamped(pile))
    f = undamped_modes(system, 8).frequency_hz
    K, M = _guyan(system, "n3")
    rigid = np.zeros((assembly.stiffness.shape[0], 2))
    z = assembly.mesh.coordinates[:, 2]
    rigid[0::6, 0], rigid[0::6, 1], rigid[4::6, 1] = 1.0, z, 1.0
    inertia = rigid.T @ (assembly.mass @ rigid)
    return {
        "OC3-mass": float(inertia[0, 0]),
        "OC3-cg": float(inertia[0, 1] / inertia[0, 0]),
        "OC3-inertia": float(inertia[1, 1]),
        **{f"OC3-f{mode}": float(f[mode - 1]) for mode in (1, 3, 4, 6, 7)},
        "OC3-K-x": float(K[0, 0]),
        "OC3-K-x-ry": float(K[0, 4]),
        "OC3-K-z": float(K[2, 2]),
        "OC3-K-ry": float(K[4, 4]),
        "OC3-K-rz": float(K[5, 5]),
        "OC3-M-x": float(M[0, 0]),
        "OC3-M-x-ry": float(M[0, 4]),
        "OC3-M-z": float(M[2, 2]),
        "OC3-M-ry": float(M[4, 4]),
        "OC3-M-rz": float(M[5, 5]),
    }


def _guyan(system: System, node: str) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of a structure reduced statically to one node, (6, 6) each."""
    dofs = system.assembly.dofs(node)
    moved = np.column_stack([
        static_displacement(system, nodal_load(system.assembly, {node: tuple(float(v) for v in unit)}))
        for unit in np.eye(6)
    ])  # fmt: skip
    K = np.linalg.inv(moved[dofs])
    shapes = moved @ K
    return np.asarray(K), np.asarray(shapes.T @ (system.assembly.mass @ shapes))


def _coupled_springs() -> Computed:
    """Return the modes of the NREL 5 MW turbine on the OC3 monopile with its pile as springs."""
    G, E, levels = 80.8e9, 210e9, 107.6 * _ELEMENTS
    nodes = {f"n{k}": (0.0, 0.0, float(z)) for k, z in enumerate(levels)}
    beams = []
    for k, middle in enumerate(0.5 * (levels[1:] + levels[:-1])):
        mass, inertia, EI, GJ = (
            np.interp(middle, _TOWER_M, v) for v in (_MASS, _INERTIA, _BENDING, _TORSION)
        )
        density = float(inertia * E / EI)  # so that ρI is the stated rotary inertia
        section = BeamSection(
            float(mass) / density, np.inf, np.inf, float(EI / E), float(EI / E), float(2.0 * EI / E),
            float(GJ / G),
        )  # fmt: skip
        material = Material(E, shear_modulus_pa=G, density_kg_m3=density)
        beams.append(Beam(f"b{k}", f"n{k}", f"n{k + 1}", section, material))
    head = PointMass(
        f"n{len(beams)}", 350000.3109, (-0.4137754432, 0.0, 1.9669893542),
        (4.37e7, 2.353e7, 2.542e7, 0.0, 1.169e6, 0.0),
    )  # fmt: skip
    tower = Structure(
        "OC3 monopile and tower", nodes, (), masses=(head,), reactions=(Reaction("n0"),), beams=tuple(beams),
        rotary_inertia=True,
    )  # fmt: skip
    springs = np.diag([_PILE["x"], _PILE["x"], 0.0, _PILE["ry"], _PILE["ry"], 0.0])
    springs[0, 4] = springs[4, 0] = _PILE["xry"]
    springs[1, 3] = springs[3, 1] = -_PILE["xry"]
    support = Support((Spring("n0", springs),), fixed=(("n0", (2, 5)),))
    f = undamped_modes(build_system(assemble(tower), support), 4).frequency_hz
    return {f"OC3-springs-{k}": float(value) for k, value in enumerate(f, start=1)}


def _pinned_beam() -> Computed:
    """Return displacements of a heavy beam of 32 m, with a spring hinge near its root, pushed at its tip."""
    steel = Material(4.2e10, poisson_ratio=0.2, density_kg_m3=1375.0)
    bar, n = Section(2.1, 1.05), 32
    nodes = {f"n{k}": (float(k), 0.0, 0.0) for k in range(n + 1)} | {"hinge": (1.0, 0.0, 0.0)}
    names = [("n0", "n1"), ("hinge", "n2"), *((f"n{k}", f"n{k + 1}") for k in range(2, n))]
    members = tuple(Member(f"m{k}", a, b, bar, bar, steel) for k, (a, b) in enumerate(names))
    turning = np.zeros((12, 12))
    turning[np.ix_((4, 10), (4, 10))] = 9.1673e9 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    beam = Structure(
        "pinned beam", nodes, members, reactions=(Reaction("n0"),), beam="timoshenko",
        rigid_links=(RigidLink("n1", "hinge", ((0.0, 1.0, 0.0),)),),
        elements=(two_node_element("spring", "joint spring", ("n1", "hinge"), turning),),
    )  # fmt: skip
    system = build_system(assemble(beam), clamped(beam))
    assembly = system.assembly
    up = np.zeros(assembly.expand.shape[0])
    up[2::6] = 1.0
    weight = -_GRAVITY_M_S2 * (assembly.mass @ (assembly.expand.T @ up))
    load = weight + nodal_load(assembly, {"n32": (-5.31e7, 0.0, 7.3e5, 0.0, 0.0, 0.0)})
    moved = static_displacement(system, load)
    return {
        "hinged-beam-tip-x": float(moved[assembly.dofs("n32")[0]]),
        "hinged-beam-middle-z": float(moved[assembly.dofs("n16")[2]]),
        "hinged-beam-tip-z": float(moved[assembly.dofs("n32")[2]]),
    }
