"""Chapters 3 to 5 of the thesis: cantilever, viscoelastic laws, the undamped jacket."""

from __future__ import annotations

from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.response import build_system, poles, sdof, undamped_modes
from jackettwin.soil import clamped, read_foundation
from jackettwin.soil.laws.viscoelastic import kelvin_voigt, loss_factor, maxwell, zener
from jackettwin.structure import (
    Assembly,
    Material,
    Member,
    Rayleigh,
    Reaction,
    Section,
    Structure,
    assemble,
    rigid_body_mass,
)
from jackettwin.updating import numbered_modes
from jackettwin.verify.rows import Computed

_L, _E, _RHO, _G = 10.0, 210e9, 7850.0, 81e9
_GYRATION = 0.19514
"""√(I/A) [m] that gives the analytic row of Table 3.1."""
_M, _K0, _K1, _C = 1.12e6, 1.48e6, 3.1096e5, 5.0e4
"""Table 4.1, with the k1 whose poles are the printed ones (3.11e5 is rounded)."""


def cantilever() -> Computed:
    """Return the cantilever of Table 3.1 by ten elements and in closed form, ω [rad/s]."""
    structure = _tube(10, direction=np.array([0.6, 0.0, 0.8]))
    omega = undamped_modes(build_system(assemble(structure), clamped(structure)), 12).omega
    computed: Computed = {f"cantilever-mode-{k}": float(w) for k, w in enumerate(omega, start=1)}
    for name, exact in _closed_forms().items():
        ours = float(omega[np.argmin(np.abs(omega - exact))])
        computed[f"T3.1-{name}-analytic"] = exact
        computed[f"T3.1-{name}-fe"] = ours
        computed[f"T3.1-{name}-error"] = abs(ours / exact - 1.0)
    return computed


def _tube(n_elements: int, direction: FloatArray) -> Structure:
    """Return the tube of the benchmark, clamped at its first node."""
    D = 0.6
    section = Section(D, 0.5 * (D - float(np.sqrt(16.0 * _GYRATION**2 - D**2))))
    ends = [direction * _L * k / n_elements for k in range(n_elements + 1)]
    nodes = {f"n{k}": (float(x), float(y), float(z)) for k, (x, y, z) in enumerate(ends)}
    steel = Material(_E, _G, _RHO)
    members = (Member(f"m{k}", f"n{k}", f"n{k + 1}", section, section, steel) for k in range(n_elements))
    return Structure("cantilever", nodes, tuple(members), reactions=(Reaction("n0"),))


def _closed_forms() -> dict[str, float]:
    """Return ω [rad/s] of bending 1–4 (3.18, with (β_nL)²), torsion 1 (3.20) and axial 1 (3.19)."""
    beta_l = (1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349)
    wave_speed = float(np.sqrt(_E / _RHO))
    forms = {f"bending {n}": b**2 / _L**2 * _GYRATION * wave_speed for n, b in enumerate(beta_l, start=1)}
    quarter = pi / (2.0 * _L)
    return forms | {"torsion 1": quarter * float(np.sqrt(_G / _RHO)), "axial 1": quarter * wave_speed}


def viscoelasticity() -> Computed:
    """Return the Zener oscillator of Table 4.1, Rayleigh damping, creep and relaxation at t = 1 s."""
    values = poles(sdof(_M, zener(_K0, _C, _K1)))
    pair, f0 = complex(values[0]), float(np.sqrt(_K0 / _M)) / (2 * pi)
    steel, two, one = Rayleigh.minimum(0.01, 0.183), zener(2.0, 2.0, 2.0), np.array([1.0])
    dashpot = 2.0 * 0.02 / (2.0 * pi * 0.183)
    return {
        "T4.1-f0": f0,
        "T4.1-f-ratio": float(np.sqrt((_K0 + _K1) / _M)) / (2 * pi) / f0,
        "4.16-real": pair.real,
        "4.16-imag": pair.imag,
        "4.16-third": float(values[2].real),
        "4.17": abs(pair) / (2 * pi),
        "4.18": _K1 / _C,
        "4.2-at-minimum": float(steel.ratio(0.183)),
        "4.2-at-twice": float(steel.ratio(0.366)),
        "4.4": float(maxwell(1.0, 1.0).relaxation(one)[0]),
        "4.6": float(kelvin_voigt(1.0, 1.0).creep(one)[0]),
        "4.8": float(two.creep(one)[0]),
        "4.9": float(two.relaxation(one)[0]),
        "5.4": 0.5 * float(loss_factor(kelvin_voigt(1.0, dashpot), 0.183)),
    }


def jacket() -> Computed:
    """Return the undamped jacket: whole, on pins and on piles without P-Δ."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    pinned = numbered_modes(assembly, 10)
    # the soil of the shipped foundation was chosen to meet tables 5.1 and 6.1
    on_piles = build_system(assembly, read_foundation("jacket15").heads(structure))
    f_piles = undamped_modes(on_piles, 10).frequency_hz
    by_table = {
        **dict.fromkeys(("jacket15", "T5.4"), pinned.frequency_hz),
        **dict.fromkeys(("T5.1", "T6.1"), f_piles),
    }
    lift = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], assembly.n_dof // 6)
    rna = rigid_body_mass(structure.masses[0])
    return {
        **{f"{key}-f{k}": float(f) for key, fs in by_table.items() for k, f in enumerate(fs, start=1)},
        **{f"3.21-{i}{j}": float(rna[i - 1, j - 1]) for i in range(1, 7) for j in range(1, 7)},
        "T4.1-modal-mass": _modal_mass(assembly, pinned.shapes[:, 0]),
        "jacket15-mass": float(lift @ (assembly.mass @ lift)),
    }


def _modal_mass(assembly: Assembly, shape: FloatArray) -> float:
    """Return the modal mass [kg] of a mass-normalised mode scaled to unit largest translation."""
    motion = (assembly.expand @ shape).reshape(-1, 6)[:, :3]
    return float(np.abs(motion).max() ** -2.0)
