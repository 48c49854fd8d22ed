"""Chapter 4: Rayleigh damping, creep and relaxation, the Zener oscillator of Table 4.1."""

from __future__ import annotations

from math import exp, pi

import numpy as np

from jackettwin.response.sdof import poles, sdof
from jackettwin.soil.laws.viscoelastic import kelvin_voigt, loss_factor, maxwell, zener
from jackettwin.structure import Rayleigh
from jackettwin.verify.rows import Row, rounded

M, K0, K1, C = 1.12e6, 1.48e6, 3.1096e5, 5.0e4
"""Table 4.1, with the k1 whose poles are the printed ones (3.11e5 is rounded)."""


def rows() -> list[Row]:
    """Return the rows of chapter 4."""
    values = poles(sdof(M, zener(K0, C, K1)))
    pair, real = complex(values[0]), float(values[2].real)
    f0, f_inf = np.sqrt(K0 / M) / (2 * pi), np.sqrt((K0 + K1) / M) / (2 * pi)
    misprint = "k1 = 3.1096e5: the printed 3.11e5 is rounded"
    table = [
        Row("T4.1-f0", "Table 4.1", "frequency of k0 alone [Hz]", 0.183, float(f0), rounded(0.183, 3)),
        Row(
            "T4.1-f-ratio",
            "section 4.4",
            "f∞/f0",
            1.1,
            float(f_inf / f0),
            rounded(1.1, 3),
            note="printed inverted",
        ),
        Row(
            "4.16-real",
            "(4.16)",
            "Zener pole, real part [rad/s]",
            -0.022,
            pair.real,
            rounded(0.022, 3),
            note=misprint,
        ),
        Row("4.16-imag", "(4.16)", "Zener pole, imaginary part [rad/s]", 1.153, pair.imag, rounded(1.153, 3)),
        Row(
            "4.16-third", "(4.16)", "Zener real pole [rad/s]", -6.176, real, rounded(6.176, 3), note=misprint
        ),
        Row("4.17", "(4.17)", "frequency |λ|/2π [Hz]", 0.1836, abs(pair) / (2 * pi), rounded(0.1836, 4)),
        Row("4.18", "(4.18)", "Ω = k1/c [rad/s]", 6.219, K1 / C, rounded(6.219, 3), note="sign corrected"),
    ]
    steel = Rayleigh.minimum(0.01, 0.183)
    table += [
        Row("4.2-at-minimum", "(4.1)–(4.2)", "Rayleigh ζ at ω_min", 0.01, float(steel.ratio(0.183)), 1e-12,
            note="C = αM + βK with α = ζω, β = ζ/ω: printed the other way round"),
        Row("4.2-at-twice", "(4.1)–(4.2)", "Rayleigh ζ at 2ω_min", 0.0125, float(steel.ratio(0.366)), 1e-12),
    ]  # fmt: skip
    one = np.array([1.0])
    table += [
        Row("4.4", "(4.4)", "Maxwell relaxation at t = τ", exp(-1.0), float(maxwell(1.0, 1.0).relaxation(one)[0]),
            1e-12, note="exp(−t/τ): sign corrected"),
        Row("4.6", "(4.6)", "Kelvin–Voigt creep at t = τ", 1.0 - exp(-1.0), float(kelvin_voigt(1.0, 1.0).creep(one)[0]),
            1e-12),
        Row("4.8", "(4.8)", "Zener creep at t = τ", 0.5 - 0.25 * exp(-0.5), float(zener(2.0, 2.0, 2.0).creep(one)[0]),
            1e-12, note="E1 = E2 = η = 2: τ = η(E1+E2)/E1E2 = 2"),
        Row("4.9", "(4.9)", "Zener relaxation at t = τ", 2.0 + 2.0 * exp(-1.0),
            float(zener(2.0, 2.0, 2.0).relaxation(one)[0]), 1e-12),
    ]  # fmt: skip
    omega = 2.0 * pi * 0.183
    eta = float(loss_factor(kelvin_voigt(1.0, 2.0 * 0.02 / omega), 0.183))
    table.append(Row("5.4", "(5.2)–(5.4)", "ζ of c = 2ζk/ω1 at ω1", 0.02, 0.5 * eta, 1e-12))
    return table
