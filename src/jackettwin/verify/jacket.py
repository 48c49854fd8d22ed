"""Chapters 3, 4 and 5: the jacket itself, undamped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil.foundation import read_foundation
from jackettwin.structure import Assembly, Structure, assemble
from jackettwin.structure.masses import rigid_body_mass
from jackettwin.structure.model import STEEL
from jackettwin.updating import numbered_modes
from jackettwin.updating.steel.update import only_parts
from jackettwin.verify.rows import Row

T3_3 = (0.142, 0.144, 0.504, 0.697, 0.761, 0.976, 1.068, 1.318, 1.657, 2.176)
T5_1 = (0.183, 0.186, 0.595, 0.760, 0.805, 0.960, 1.088, 1.268, 1.723, 1.978)
T5_1_TOLERANCE = (0.005, 0.005, 0.05, 0.04, 0.04)
T6_1 = {1: 0.1819, 2: 0.1838, 4: 0.7362}
T5_2 = (0.901, 0.901, 1.144, 1.150, 1.727)
T5_2_ROSAP = (0.898, 0.909, 1.093, 1.165, 1.575)
T5_4 = (0.183, 0.186, 0.572, 0.749, 0.794)
T5_4_ROSAP = (0.1839, 0.1867, 0.593, 0.776, 0.819)
JACKET15 = (0.1832, 0.1859, 0.5720, 0.7489, 0.7941, 0.9145)


def modal_mass(assembly: Assembly, shape: FloatArray) -> float:
    """Return the modal mass [kg] of a mass-normalised mode scaled to unit largest translation."""
    motion = (assembly.expand @ shape).reshape(-1, 6)[:, :3]
    return float(np.abs(motion).max() ** -2.0)


def all_steel(structure: Structure) -> Structure:
    """Return the initial model of section 3.3.5: E 210 GPa and ρ 7850 everywhere."""
    return replace(structure, members=tuple(replace(member, material=STEEL) for member in structure.members))


def rows() -> list[Row]:
    """Return the rows of the undamped jacket."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    full = numbered_modes(assembly, 10)
    f = full.frequency_hz
    table = [
        Row(
            f"jacket15-f{k}",
            "reference structure",
            f"jacket15 pinned, mode {k} [Hz]",
            value,
            float(f[k - 1]),
            2e-3,
        )
        for k, value in enumerate(JACKET15, start=1)
    ]
    table += [
        Row(
            f"T5.4-f{k}",
            "Table 5.4, Python",
            f"full model pinned, mode {k} [Hz]",
            value,
            float(f[k - 1]),
            3e-3,
        )
        for k, value in enumerate(T5_4, start=1)
    ]
    lift = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], assembly.n_dof // 6)
    table += [
        Row("T4.1-modal-mass", "Table 4.1", "modal mass of mode 1 [kg]", 1.12e6, modal_mass(assembly, full.shapes[:, 0]),
            1e-2),
        Row("jacket15-mass", "reference structure", "total mass [kg]", 3578e3, float(lift @ (assembly.mass @ lift)), 2e-4),
    ]  # fmt: skip
    table += _rna_rows(structure)
    initial = numbered_modes(assemble(all_steel(structure)), 10).frequency_hz
    jacket = numbered_modes(assemble(only_parts(structure, ("jacket",))), 5).frequency_hz
    drawings = "needs the drawings, which the thesis does not give"
    table += _informational("T3.3", "Table 3.3", "initial model, mode {} [Hz]", T3_3, initial, drawings)
    table += _pile_rows(structure, assembly)
    table += _informational("T5.2", "Table 5.2, Python", "jacket alone, mode {} [Hz]", T5_2, jacket, drawings)
    table += _informational(
        "T5.2-ROSAP", "Table 5.2, ROSAP", "jacket alone, mode {} [Hz]", T5_2_ROSAP, jacket, drawings
    )
    table += _informational("T5.4-ROSAP", "Table 5.4, ROSAP", "full model, mode {} [Hz]", T5_4_ROSAP, f,
                            "the printed row is garbled; these follow from its errors")  # fmt: skip
    return table


def _pile_rows(structure: Structure, assembly: Assembly) -> list[Row]:
    """Return tables 5.1 and 6.1 beside the shipped foundation, whose soil was chosen to meet them; no P-Δ."""
    system = build_system(assembly, read_foundation("jacket15").heads(structure))
    f = undamped_modes(system, len(T5_1)).frequency_hz
    rows = [
        Row(
            f"T5.1-f{k}",
            "Table 5.1",
            f"full model on piles, mode {k} [Hz]",
            value,
            float(computed),
            tolerance,
        )
        for k, (value, computed, tolerance) in enumerate(zip(T5_1, f, T5_1_TOLERANCE, strict=False), start=1)
    ]
    first = len(T5_1_TOLERANCE)
    later = _informational("T5.1", "Table 5.1", "full model on piles, mode {} [Hz]", T5_1, f,
                           "brace modes: need the drawings, which the thesis does not give")  # fmt: skip
    identified = [
        Row(
            f"T6.1-f{k}",
            "Table 6.1",
            f"identified, mode {k}: ours on piles, undamped [Hz]",
            value,
            float(f[k - 1]),
            0.015,
        )
        for k, value in T6_1.items()
    ]
    return [*rows, *later[first:], *identified]


def _rna_rows(structure: Structure) -> list[Row]:
    """Return entries of (3.21) for the numbers of Table 3.2, written out by hand."""
    m, ax, az = 80.9e4, -3.5, 4.0
    M = rigid_body_mass(structure.masses[0])
    entries = (
        ("m a_z", (0, 4), m * az),
        ("m a_x", (1, 5), m * ax),
        ("I_xx + m a_z²", (3, 3), 4.84e8 + m * az**2),
        ("I_yy + m (a_x² + a_z²)", (4, 4), 2.78e8 + m * (ax**2 + az**2)),
        ("I_zz + m a_x²", (5, 5), 2.79e8 + m * ax**2),
        ("−m a_x a_z", (3, 5), -m * ax * az),
    )
    return [
        Row(f"3.21-{i + 1}{j + 1}", "(3.21), Table 3.2", f"RNA mass matrix ({i + 1}, {j + 1}) = {name}", value,
            float(M[i, j]), 1e-12)
        for name, (i, j), value in entries
    ]  # fmt: skip


def _informational(
    key: str, source: str, quantity: str, published: tuple[float, ...], computed: FloatArray, note: str
) -> list[Row]:
    return [
        Row(f"{key}-f{k}", source, quantity.format(k), value, float(ours), None, note=note)
        for k, (value, ours) in enumerate(zip(published, computed, strict=False), start=1)
    ]
