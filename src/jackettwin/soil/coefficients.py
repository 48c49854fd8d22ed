"""Support laws as rows of numbers, for code that evaluates many of them at once.

A row is (k0, c, k_α, α, ω0, m, k_1, τ_1, k_2, τ_2, …):

    D(s) = k0 + c s + m s² + k_α (s/ω0)^α + Σ k_j τ_j s/(1 + τ_j s).

No law has a mass; water that moves with the structure has.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.viscoelastic import Law, Prony, Springpot

K0, C, K_ALPHA, ALPHA, OMEGA0, MASS, BRANCHES = range(7)
"""Places in a row; branches k_1, τ_1, k_2, … follow from BRANCHES on."""


def law_rows(laws: Sequence[Law]) -> FloatArray:
    """Return (n_laws, width) rows, padded with zeros to the longest.

    Raises
    ------
    InputError
        If a law is neither a Prony series nor a springpot.

    Examples
    --------
    >>> from jackettwin.soil.viscoelastic import kelvin_voigt, zener
    >>> law_rows([kelvin_voigt(2.0, 3.0), zener(2.0, 3.0, 6.0)]).tolist()
    [[2.0, 3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 6.0, 0.5]]
    """
    width = BRANCHES + 2 * max([len(law.k) for law in laws if isinstance(law, Prony)], default=0)
    rows = np.zeros((len(laws), width))
    rows[:, OMEGA0] = 1.0
    for row, law in zip(rows, laws, strict=True):
        if isinstance(law, Prony):
            row[K0], row[C] = law.k0, law.c
            n = len(law.k)
            row[BRANCHES : BRANCHES + 2 * n : 2] = law.k
            row[BRANCHES + 1 : BRANCHES + 1 + 2 * n : 2] = law.tau
        elif isinstance(law, Springpot):
            row[K_ALPHA], row[ALPHA], row[OMEGA0] = law.k, law.alpha, law.omega0
        else:
            raise InputError("not a Prony series or springpot", field="law", value=type(law).__name__)
    return rows


def static_rows(rows: FloatArray) -> FloatArray:
    """Return the rows of springs with the laws' static stiffness, masses kept: the undamped structure.

    Parameters
    ----------
    rows : (..., width)
    """
    springs = np.zeros_like(rows)
    springs[..., OMEGA0] = 1.0
    springs[..., MASS] = rows[..., MASS]
    springs[..., K0] = rows[..., K0] + rows[..., K_ALPHA] * np.cos(0.5 * np.pi * rows[..., ALPHA])
    return springs


def law_stiffness(rows: FloatArray, s: ComplexArray) -> ComplexArray:
    """Return D(s) of each row at its own points.

    Parameters
    ----------
    rows : (n_laws, width)
    s : (n_laws, n_points)
    """
    k0, c, k_alpha, alpha, omega0, m = (rows[:, j, None] for j in range(BRANCHES))
    D = k0 + c * s + m * s**2 + k_alpha * (s / omega0) ** alpha
    for j in range(BRANCHES, rows.shape[1], 2):
        k, tau = rows[:, j, None], rows[:, j + 1, None]
        D = D + k * (tau * s / (1.0 + tau * s))
    return np.asarray(D)
