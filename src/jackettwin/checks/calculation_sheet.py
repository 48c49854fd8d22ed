"""How a member's utilisation comes about: every quantity with formula, number and clause."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from jackettwin.checks.iso19902 import CHECKS, Stress, Tube, strength, utilisation
from jackettwin.checks.member_check import DesignBasis, MemberUse
from jackettwin.errors import require
from jackettwin.structure import Member


class SheetLine(NamedTuple):
    """One quantity: symbol, formula in the standard's symbols, value, unit and clause of ISO 19902."""

    symbol: str
    formula: str
    value: float
    unit: str
    clause: str


def calculation_sheet(member: Member, use: MemberUse, basis: DesignBasis) -> tuple[SheetLine, ...]:
    """Return the calculation of a member's governing check, line by line.

    Raises
    ------
    InputError
        If the member is a cone, or hydrostatic pressure governs it.
    """
    section = member.section_start
    require(
        section == member.section_end,
        "a calculation sheet is of uniform tubes",
        field="--sheet",
        value=member.name,
        remedy="name a member that is no cone",
    )
    require(
        use.check in CHECKS,
        "a calculation sheet knows no hydrostatic pressure, which governs this member",
        field="--sheet",
        value=member.name,
        remedy="leave out --still-water, or flood the member",
    )
    D, t, E = section.outer_diameter_m, section.thickness_m, member.material.youngs_modulus_pa
    d, KL, f_y = D - 2.0 * t, use.buckling.K * use.buckling.L, basis.yield_strength_pa
    A, Z_e = np.pi / 4.0 * (D**2 - d**2), np.pi / 32.0 * (D**4 - d**4) / D
    N, V_y, V_z, T, M_y, M_z = (float(value) for value in use.worst.forces)
    s = strength(Tube(*(np.array(value) for value in (D, t, E, f_y, KL))))
    stresses = (N / A, M_y / Z_e, M_z / Z_e, 2.0 * np.hypot(V_y, V_z) / A, T / (2.0 * Z_e))
    stress = Stress(*(np.array(value) for value in stresses))
    U = utilisation(s, stress, C_m=basis.C_m, edition=basis.edition)
    lines: list[tuple[str, str, Any, str, str]] = [
        ("D", "outer diameter", D, "m", "13.1"),
        ("t", "wall", t, "m", "13.1"),
        ("A", "π/4 (D² − d²)", A, "m²", "13.2.2"),
        ("Z_e", "π/32 (D⁴ − d⁴)/D", Z_e, "m³", "13.2.4"),
        ("f_y", "yield strength", f_y, "Pa", "13.2.2"),
        ("K L", "effective length factor times length of the column", KL, "m", "13.5"),
        ("f_yc", "f_y, 1.047 f_y − 0.274 f_y²/f_xe or f_xe, with f_xe = 0.6 E t/D", s.f_yc, "Pa", "13.2.3.3"),
        ("f_c", "(1 − 0.278 λ²) f_yc or 0.9 f_yc/λ², with λ = K L/(π r) √(f_yc/E)", s.f_c, "Pa", "13.2.3.2"),
        ("f_e", "π² E/(K L/r)²", s.f_e, "Pa", "13.3.3"),
        ("f_b", "Z_p/Z_e f_y, less by f_y D/(E t) above 0.0517", s.f_b, "Pa", "13.2.4"),
        ("f_v", "f_y/√3", s.f_v, "Pa", "13.2.5"),
        ("N", "axial force, tension positive", N, "N", ""),
        ("M", "√(M_y² + M_z²)", float(np.hypot(M_y, M_z)), "N·m", ""),
        ("V", "√(V_y² + V_z²)", float(np.hypot(V_y, V_z)), "N", ""),
        ("T", "torsional moment", T, "N·m", ""),
        ("σ_a", "N/A", stress.axial, "Pa", "13.2.2"),
        ("σ_b", "M/Z_e", float(np.hypot(M_y, M_z)) / Z_e, "Pa", "13.2.4"),
        ("τ_b", "2 V/A", stress.shear, "Pa", "13.2.5.1"),
        ("τ_t", "T D/(2 J)", stress.torsion, "Pa", "13.2.5.2"),
        ("U tension", "1.05 σ_t/f_y", U.tension, "", "13.2.2"),
        ("U compression", "1.18 σ_c/f_c", U.compression, "", "13.2.3"),
        ("U bending", "1.05 σ_b/f_b", U.bending, "", "13.2.4"),
        ("U shear", "1.05 τ_b/f_v", U.shear, "", "13.2.5.1"),
        ("U torsion", "1.05 τ_t/f_v", U.torsion, "", "13.2.5.2"),
        ("U section", _SECTION[basis.edition], U.section, "", "13.3.2, 13.3.3"),
        ("U stability", "1.18 σ_c/f_c + 1.05 C_m σ_b/(f_b (1 − σ_c/f_e))", U.stability, "", "13.3.3"),
    ]
    return tuple(SheetLine(name, how, float(value), unit, clause) for name, how, value, unit, clause in lines)


_SECTION = {
    "2007": "1.05 σ_t/f_y or 1.18 σ_c/f_yc, + 1.05 σ_b/f_b",
    "2020": "1 − cos(π/2 · (1.05 σ_t/f_y or 1.18 σ_c/f_yc)) + 1.05 σ_b/f_b",
}
