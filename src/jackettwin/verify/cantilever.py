"""Chapter 3: the cantilever of Table 3.1 and its ten modes."""

from __future__ import annotations

import numpy as np

from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import clamped
from jackettwin.structure import Material, Section, Structure, assemble
from jackettwin.structure.model import Member, Reaction
from jackettwin.verify.rows import Row, rounded

L, E, RHO, G = 10.0, 210e9, 7850.0, 81e9
GYRATION = 0.19514
"""√(I/A) [m] that gives the analytic row of Table 3.1."""
_PRINTED = {"bending 1": (35.487, 35.488), "torsion 1": (504.577, 505.111), "axial 1": (812.446, 813.306)}
_BARS = {"bending 1": 1e-5, "torsion 1": 1.04e-3, "axial 1": 1.04e-3}
_KNOWN = {"bending 2": 3.3e-5, "bending 3": 2.55e-4, "bending 4": 9.53e-4}


def cantilever(n_elements: int = 10, direction: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> Structure:
    """Return the tube of the benchmark, clamped at its first node."""
    D = 0.6
    section = Section(D, 0.5 * (D - float(np.sqrt(16.0 * GYRATION**2 - D**2))))
    unit = np.array(direction) / np.linalg.norm(direction)
    nodes = {}
    for k in range(n_elements + 1):
        x, y, z = unit * L * k / n_elements
        nodes[f"n{k}"] = (float(x), float(y), float(z))
    members = tuple(
        Member(f"m{k}", f"n{k}", f"n{k + 1}", section, section, Material(E, G, RHO))
        for k in range(n_elements)
    )
    return Structure("cantilever", nodes, members, reactions=(Reaction("n0"),))


def closed_forms() -> dict[str, float]:
    """Return ω [rad/s] of bending 1–4 (3.18, with (β_nL)²), torsion 1 (3.20) and axial 1 (3.19)."""
    beta_l = (1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349)
    forms = {
        f"bending {n}": bl**2 / L**2 * GYRATION * float(np.sqrt(E / RHO))
        for n, bl in enumerate(beta_l, start=1)
    }
    quarter = np.pi / (2.0 * L)
    return forms | {
        "torsion 1": float(quarter * np.sqrt(G / RHO)),
        "axial 1": float(quarter * np.sqrt(E / RHO)),
    }


def rows() -> list[Row]:
    """Return the rows of chapter 3."""
    structure = cantilever(direction=(0.6, 0.0, 0.8))
    omega = undamped_modes(build_system(assemble(structure), clamped(structure)), 12).omega
    exact = closed_forms()

    def ours(name: str) -> float:
        return float(omega[np.argmin(np.abs(omega - exact[name]))])

    table = []
    for name, (analytic, fe) in _PRINTED.items():
        table.append(
            Row(f"T3.1-{name}-analytic", "Table 3.1", f"cantilever {name}, analytic [rad/s]", analytic, exact[name],
                rounded(analytic, 3))
        )  # fmt: skip
        table.append(
            Row(f"T3.1-{name}-fe", "Table 3.1", f"cantilever {name}, ten elements [rad/s]", fe, ours(name), 5e-5,
                note="the printed digits come from rounded inputs")
        )  # fmt: skip
        error = abs(ours(name) / exact[name] - 1.0)
        table.append(
            Row(f"T3.1-{name}-error", "Table 3.1", f"cantilever {name}, error of ten elements", _BARS[name], error, 0.0,
                "at most")
        )  # fmt: skip
    for name, known in _KNOWN.items():
        error = abs(ours(name) / exact[name] - 1.0)
        table.append(
            Row(
                f"T3.1-{name}-error",
                "Appendix A",
                f"cantilever {name}, error of ten elements",
                known,
                error,
                0.02,
            )
        )
    pairs = [exact[f"bending {n}"] for n in (1, 1, 2, 2, 3, 3, 4, 4)]
    first_ten = sorted([*pairs, exact["torsion 1"], exact["axial 1"]])
    for k, value in enumerate(first_ten):
        table.append(
            Row(f"cantilever-mode-{k + 1}", "(3.18)–(3.20)", f"cantilever mode {k + 1} of ten [rad/s]", value,
                float(omega[k]), 1.1e-3, note="closed form; ten elements")
        )  # fmt: skip
    return table
