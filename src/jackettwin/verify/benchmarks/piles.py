"""Piles and beams on springs whose answers are in every textbook: Hetényi, Matlock & Reese, Winkler."""

from __future__ import annotations

from math import pi, sqrt, tanh

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.soil import Foundation, Pile, linear_springs
from jackettwin.verify.rows import Computed

_PILE = Pile(length_m=60.0, outer_diameter_m=1.0, thickness_m=0.02, element_m=0.2)


def pile_benchmarks() -> Computed:
    """Return the coefficients of laterally and axially loaded piles, by their ids."""
    return {**_linear_ground(), **_constant_ground(), **_axial()}


def _flexibility(lateral: float, *, growing: bool) -> FloatArray:
    """Return displacement and slope of the head under unit force and moment, (2, 2) [m, rad]."""
    springs = linear_springs(
        _PILE,
        lateral=lambda z: lateral * (z if growing else np.ones_like(z)),
        axial=np.ones_like,
        tip_n_m=1.0,
    )
    head = Foundation(_PILE, springs).head()
    K = (head.steel + head.soil)[np.ix_((0, 4), (0, 4))]
    return np.asarray(np.linalg.inv(K))


def _linear_ground() -> Computed:
    """Return Matlock & Reese's coefficients: k_h = n_h z, T = (EI/n_h)^(1/5), ten T long or more."""
    n_h, EI = 20e6, _bending_stiffness()
    T = (EI / n_h) ** 0.2
    F = _flexibility(n_h, growing=True)
    # the slope of the books is dy/dz, z down: about y it is −θ
    return {
        "MR-Ay": F[0, 0] * EI / T**3,
        "MR-As": -F[0, 1] * EI / T**2,
        "MR-By": F[0, 1] * EI / T**2,
        "MR-Bs": -F[1, 1] * EI / T,
        "MR-fixed": (F[0, 0] - F[0, 1] ** 2 / F[1, 1]) * EI / T**3,
    }


def _constant_ground() -> Computed:
    """Return Hetényi's coefficients of a half-infinite beam: λ = (k/4EI)^(1/4)."""
    k, EI = 20e6, _bending_stiffness()
    beta = (k / (4.0 * EI)) ** 0.25
    F = _flexibility(k, growing=False)
    return {
        "hetenyi-force-displacement": F[0, 0] * k / beta,
        "hetenyi-force-slope": F[0, 1] * k / beta**2,
        "hetenyi-moment-slope": F[1, 1] * k / beta**3,
        "hetenyi-fixed": (F[0, 0] - F[0, 1] ** 2 / F[1, 1]) * k / beta,
    }


def _axial() -> Computed:
    """Return the axial stiffness of a pile on springs along its shaft, K = EA μ tanh μL, and ours."""
    k, EA = 50e6, _PILE.youngs_modulus_pa * pi * 0.02 * 0.98
    springs = linear_springs(_PILE, lateral=np.ones_like, axial=lambda z: k * np.ones_like(z))
    head = Foundation(_PILE, springs).head()
    mu = sqrt(k / EA)
    return {"winkler-axial": (EA * mu * tanh(mu * _PILE.length_m), float((head.steel + head.soil)[2, 2]))}


def _bending_stiffness() -> float:
    d = _PILE.outer_diameter_m - 2.0 * _PILE.thickness_m
    return _PILE.youngs_modulus_pa * pi / 64.0 * (_PILE.outer_diameter_m**4 - d**4)
