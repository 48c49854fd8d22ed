"""Calculation sheet of a member or joint: every quantity with its formula, value and clause."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from jackettwin.checks.iso19902 import C_X, Strength, Stress, strength, utilisation
from jackettwin.checks.iso19902_joints import (
    ALPHA_F,
    C_1,
    C_2,
    C_BENDING,
    GAMMA_J,
    GAMMA_Q,
    gap_factor,
    strength_factors,
)
from jackettwin.checks.iso19902_pressure import (
    column_strength,
    hoop_strength,
    pressure_terms,
    pressure_use,
)
from jackettwin.checks.joint_check import BraceUse
from jackettwin.checks.member_check import DesignBasis, MemberUse

Row = tuple[str, str, Any, str, str]


class SheetLine(NamedTuple):
    """One quantity: symbol, formula in the standard's symbols, value, unit and clause of ISO 19902."""

    symbol: str
    formula: str
    value: float
    unit: str
    clause: str


def calculation_sheet(use: MemberUse, basis: DesignBasis) -> tuple[SheetLine, ...]:
    """Return the calculation of a member's checks where its governing one is worst, line by line."""
    tube, KL = use.worst.tube, use.buckling.K * use.buckling.L
    D, t, f_y = float(tube.D), float(tube.t), float(tube.f_y)
    d = D - 2.0 * t
    A, Z_e = np.pi / 4.0 * (D**2 - d**2), np.pi / 32.0 * (D**4 - d**4) / D
    N, V_y, V_z, T, M_y, M_z = (float(value) for value in use.worst.forces)
    s = strength(tube)
    stresses = (N / A, M_y / Z_e, M_z / Z_e, 2.0 * np.hypot(V_y, V_z) / A, T / (2.0 * Z_e))
    stress = Stress(*(np.array(value) for value in stresses))
    U = utilisation(s, stress, C_m=basis.C_m, edition=basis.edition)
    lines: list[Row] = [
        ("D", "outer diameter, of a cone in the middle of the element", D, "m", "13.1"),
        ("t", "wall, at least 6 mm", t, "m", "13.1"),
        ("D/t", "at most 120", D / t, "", "13.1"),
        ("A", "π/4 (D² − d²)", A, "m²", "13.2.2"),
        ("Z_e", "π/32 (D⁴ − d⁴)/D", Z_e, "m³", "13.2.4"),
        ("f_y", "yield strength, at most 500 MPa", f_y, "Pa", "13.2.2"),
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
    if use.worst.pressure_pa > 0.0:
        lines += _under_pressure(use, s, stress, basis)
    return _sheet(lines)


def _under_pressure(use: MemberUse, s: Strength, stress: Stress, basis: DesignBasis) -> list[Row]:
    """Return the lines of 13.2.6 and 13.4."""
    tube, p = use.worst.tube, np.array(use.worst.pressure_pa)
    h = hoop_strength(tube, np.array(use.buckling.L))
    terms = pressure_terms(tube, h, p)
    U = pressure_use(tube, s, h, stress, p, C_m=basis.C_m)
    f_xe = 2.0 * C_X * tube.E * tube.t / tube.D
    return [
        ("p", "hydrostatic pressure, factored", p, "Pa", "13.4.1"),
        ("σ_h", "p D/(2 t)", terms.hoop_stress, "Pa", "13.2.6.1"),
        ("σ_q", "σ_h/2", terms.capped, "Pa", "13.4.1"),
        ("L_r", "between rings, here joints", use.buckling.L, "m", "13.2.6.2"),
        ("μ", "L_r/D √(2 D/t)", use.buckling.L / tube.D * np.sqrt(2.0 * tube.D / tube.t), "", "13.2.6.2"),
        ("f_he", "2 C_h E t/D, C_h by μ", h.f_he, "Pa", "13.2-26 to 13.2-30"),
        ("f_h", "f_y, 0.7 f_y (f_he/f_y)^0.4 or f_he", h.f_h, "Pa", "13.2-23 to 13.2-25"),
        ("B", "1.25 σ_h/f_h ≤ 1", terms.B, "", "13.4-10"),
        ("η", "5 − 4 f_h/f_y", terms.eta, "", "13.4-11"),
        ("r", "√(1 + 0.09 B² − B^(2η)) − 0.3 B", terms.left, "", "13.4-8"),
        ("f_t,h", "f_y r", tube.f_y * terms.left, "Pa", "13.4-8"),
        ("f_b,h", "f_b r", s.f_b * terms.left, "Pa", "13.4-9"),
        ("f_c,h", "f_yc by λ and σ_q", column_strength(tube, s, terms.capped), "Pa", "13.4-15, 13.4-16"),
        ("f_xe", "0.6 E t/D", f_xe, "Pa", "13.2-10"),
        ("U hoop", "1.25 σ_h/f_h", U.hoop, "", "13.2.6"),
        ("U pressure_section", "1.05 (σ_t − σ_q)/f_t,h or 1.18 (σ_c + σ_q)/f_yc, + 1.05 σ_b/f_b,h",
         U.section, "", "13.4-12, 13.4-19"),
        ("U pressure_stability", "1.18 σ_c/f_c,h + 1.05 C_m σ_b/(f_b,h (1 − σ_c/f_e))",
         U.stability, "", "13.4-20"),
        ("U pressure_local", "(σ_b + σ_c + σ_q − f_he/2.5)/(f_xe/1.18 − f_he/2.5) + (1.25 σ_h/f_he)²",
         U.local, "", "13.4-21"),
    ]  # fmt: skip


def _sheet(lines: list[Row]) -> tuple[SheetLine, ...]:
    kept = [line for line in lines if np.isfinite(line[2])]
    return tuple(SheetLine(name, how, float(value), unit, clause) for name, how, value, unit, clause in kept)


def joint_sheet(use: BraceUse, *, conservative: bool = False) -> tuple[SheetLine, ...]:
    """Return the calculation of a brace's joint at its worst instant, line by line.

    The strength of each kind counts by its share, or with ``conservative`` the weakest.
    """
    joint, q = use.joint, strength_factors(use.joint)
    P, M_ip, M_op = use.forces
    inner = joint.D - 2.0 * joint.T
    P_y = joint.f_y * 0.25 * np.pi * (joint.D**2 - inner**2)
    M_p = joint.f_y * (joint.D**3 - inner**3) / 6.0
    C1, C2 = (max(c) if conservative else float(np.array(c) @ use.shares) for c in (C_1, C_2))
    sides = np.array(use.chord_sides) / [P_y, M_p]
    q_A, q_M = (
        GAMMA_Q * float(np.sqrt((sides**2 @ factors).max())) for factors in ([C1, C2], np.array(C_BENDING))
    )
    Q_f = [max(1.0 - a * v**2, 1e-3) for a, v in zip(ALPHA_F, (q_A, q_M, q_M), strict=True)]
    force = joint.f_y * joint.T**2 / (GAMMA_J * np.sin(joint.theta))
    P_d = force * use.Q_u * Q_f[0]
    M_ipd, M_opd = force * joint.d * q.in_plane * Q_f[1], force * joint.d * q.out_of_plane * Q_f[2]
    parts = abs(P) / P_d, (M_ip / M_ipd) ** 2, abs(M_op) / M_opd
    kinds = q.tension if P >= 0.0 else q.compression
    lines: list[Row] = [
        ("D", "outer diameter of the chord", joint.D, "m", "14.3.1"),
        ("T", "wall of the chord", joint.T, "m", "14.3.1"),
        ("d", "outer diameter of the brace", joint.d, "m", "14.3.1"),
        ("t", "wall of the brace", joint.t, "m", "14.3.1"),
        ("θ", "angle between brace and chord", np.degrees(joint.theta), "°", "14.3.1"),
        ("g", "gap to the brace beside, negative where they overlap", joint.gap, "m", "14.3.1"),
        ("β", "d/D", joint.beta, "", "14.3.1"),
        ("γ", "D/(2 T)", joint.gamma, "", "14.3.1"),
        ("f_y", "yield strength of the chord, at most 0.8 f_u", joint.f_y, "Pa", "14.2.3"),
        *((f"share {k}", "balance of the braces' axial forces", use.shares[i], "", "14.2.4")
          for i, k in enumerate("KYX")),
        ("Q_g", "1.9 − 0.7 √(g/(T γ)) ≥ 1, 0.13 + 0.65 φ √γ overlapping", gap_factor(joint), "", "14.3.3"),
        *((f"Q_u {k}", "table 14.3-1, tension or compression", kinds[i], "", "14.3.3")
          for i, k in enumerate("KYX")),
        ("can", "share of Y's and X's strength that a short can leaves", joint.can_factor, "", "14.3.5"),
        ("Q_u", "weakest kind" if conservative else "Σ share · Q_u", use.Q_u, "", "14.2.4"),
        ("Q_u ip", "4.5 β √γ", q.in_plane, "", "14.3.3"),
        ("Q_u op", "3.2 γ^(β²/2)", q.out_of_plane, "", "14.3.3"),
        ("P_y", "f_y π/4 (D² − (D − 2 T)²)", P_y, "N", "14.3.4"),
        ("M_p", "f_y (D³ − (D − 2 T)³)/6", M_p, "N·m", "14.3.4"),
        *((name, how, value, unit, "14.3.4") for k, (N, M) in enumerate(use.chord_sides, start=1)
          for name, how, value, unit in (
              (f"P_C side {k}", "axial force of the chord", N, "N"),
              (f"M_C side {k}", "resultant moment of the chord", M, "N·m"))),
        ("q_A", "γ_q √(C_1 (P_C/P_y)² + C_2 (M_C/M_p)²), worse side, γ_q = 1.05", q_A, "", "14.3-10"),
        ("q_A bending", "the same, C_1 = 25 and C_2 = 43", q_M, "", "14.3-10"),
        ("Q_f", "1 − 0.030, for K, Y and X, q_A²", Q_f[0], "", "14.3-9"),
        ("Q_f ip", "1 − 0.045 q_A²", Q_f[1], "", "14.3-9"),
        ("Q_f op", "1 − 0.021 q_A²", Q_f[2], "", "14.3-9"),
        ("P_d", "f_y T² Q_u Q_f/(γ_j sin θ), γ_j = 1.05", P_d, "N", "14.3-1, 14.3-3"),
        ("M_d ip", "f_y T² d Q_u Q_f/(γ_j sin θ)", M_ipd, "N·m", "14.3-2, 14.3-4"),
        ("M_d op", "f_y T² d Q_u Q_f/(γ_j sin θ)", M_opd, "N·m", "14.3-2, 14.3-4"),
        ("P", "axial force of the brace, tension positive", P, "N", ""),
        ("M ip", "in-plane moment of the brace", M_ip, "N·m", ""),
        ("M op", "out-of-plane moment of the brace", M_op, "N·m", ""),
        ("U axial", "|P|/P_d", parts[0], "", "14.3-12"),
        ("U ip", "(M ip/M_d ip)²", parts[1], "", "14.3-12"),
        ("U op", "|M op|/M_d op", parts[2], "", "14.3-12"),
        ("U joint", "U axial + U ip + U op", sum(parts), "", "14.3-12"),
    ]  # fmt: skip
    return _sheet(lines)


_SECTION = {
    "2007": "1.05 σ_t/f_y or 1.18 σ_c/f_yc, + 1.05 σ_b/f_b",
    "2020": "1 − cos(π/2 · (1.05 σ_t/f_y or 1.18 σ_c/f_yc)) + 1.05 σ_b/f_b",
}
