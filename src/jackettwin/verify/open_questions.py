"""Questions that the thesis leaves open, answered: damping of several modes, other laws, its three optima."""

from __future__ import annotations

from functools import cache

import numpy as np

from jackettwin.soil import family
from jackettwin.updating import (
    NuisanceParameters,
    Residuals,
    SearchMethod,
    SearchPath,
    Target,
    Update,
    search_paths,
    starting_points,
    support_model,
)
from jackettwin.verify import supports
from jackettwin.verify.rows import Computed

ZETA_4 = 0.0281
"""Identified damping ratio of mode 4, Table 6.1; no target of the thesis."""
_ZETA_1 = 0.0127
SIMPLEX_STARTS = 16
_POINTS: dict[str, tuple[tuple[str, tuple[float, ...]], ...]] = {
    "kelvin-voigt": tuple(zip(("T8.1", "T8.3"), supports.KELVIN_VOIGT, strict=True)),
    "zener": tuple(zip(("T8.4-1", "T8.4-2"), supports.ZENER, strict=True)),
}
"""The thesis's optima, by the tables that print them."""


def with_zeta_4() -> Residuals:
    """Return the targets of Table 6.1 and the damping of mode 4."""
    targets = (Target(m, f, damping_ratio=ZETA_4 if m == 4 else zeta) for m, f, zeta in supports.T6_1)
    return Residuals(tuple(targets), relative=True)


@cache
def fit(law: str, *, zeta_4: bool, free_steel: bool = False) -> Update:
    """Return a law fitted to Table 6.1.

    Parameters
    ----------
    zeta_4 : bool
        Whether the damping of mode 4 is among the targets, or predicted.
    free_steel : bool
        Whether ratio and frequency of the steel's least damping are updated as well: chapter 10's first wish.
    """
    assembly, rayleigh = supports.reference_jacket()
    nuisance = NuisanceParameters((), free_steel)
    model = support_model(assembly, family=family(law), rayleigh=rayleigh, nuisance=nuisance)
    return supports.fitted(model, with_zeta_4() if zeta_4 else supports.table_6_1())


@cache
def ways(law: str, method: SearchMethod) -> tuple[SearchPath, ...]:
    """Return the ways of searches from the thesis's own optima of a law, then from scattered points."""
    found = fit(law, zeta_4=False)
    own = np.array([theta for _, theta in _POINTS[law]])
    starts = np.vstack([own, starting_points(found.problem, SIMPLEX_STARTS, 0)])
    return search_paths(found.problem, starts, found.solutions, method=method)


def open_questions() -> Computed:
    """Return what stands beside the thesis's own rows."""
    return {**_several_dampings(), **_blind(), **_three_optima()}


def _several_dampings() -> Computed:
    computed: Computed = {}
    cases = {
        "wish-1": fit("kelvin-voigt", zeta_4=True, free_steel=True),
        "zeta4-zener": fit("zener", zeta_4=True),
    }
    for key, found in cases.items():
        f, zeta = _errors(found)
        computed |= {f"{key}-f": max(f), f"{key}-zeta1": zeta[0], f"{key}-zeta4": zeta[1]}
    kelvin_voigt = fit("kelvin-voigt", zeta_4=True).best.theta
    return computed | {
        "zeta4-kelvin-voigt-k": float(kelvin_voigt[0]),
        "zeta4-kelvin-voigt-c": float(kelvin_voigt[1]),
    }


def _blind() -> Computed:
    return {f"blind-{law}": _errors(fit(law, zeta_4=False))[1][1] for law in ("maxwell-3", "springpot")}


def _three_optima() -> Computed:
    computed: Computed = {}
    for law, points in _POINTS.items():
        lowest = fit(law, zeta_4=False).best.cost
        for (key, _), path in zip(points, ways(law, "least-squares"), strict=False):
            computed[f"{key}-cost"] = (lowest, float(path.cost[0]))
            computed[f"{key}-end"] = (lowest, path.end_cost)
        scattered = ways(law, "nelder-mead")[len(points) :]
        ended = sum(path.fate == "solution" for path in scattered)
        computed[f"{law}-simplex"] = (float(len(scattered)), float(ended))
    kelvin_voigt, zener = (fit(law, zeta_4=False).best for law in ("kelvin-voigt", "zener"))
    return computed | {
        "collapse-cost": (kelvin_voigt.cost, zener.cost),
        "collapse-k0": (float(kelvin_voigt.theta[0]), float(zener.theta[0])),
        "collapse-c": (float(kelvin_voigt.theta[1]), float(zener.theta[1])),
    }


def _errors(found: Update) -> tuple[list[float], tuple[float, float]]:
    """Return the relative errors of the frequencies, and of ζ1 and ζ4."""
    f = [hz for _, hz, _ in supports.T6_1]
    zeta = found.modes.damping_ratio
    return (
        [abs(float(ours) / theirs - 1.0) for ours, theirs in zip(found.modes.frequency_hz, f, strict=True)],
        (abs(float(zeta[0]) / _ZETA_1 - 1.0), abs(float(zeta[2]) / ZETA_4 - 1.0)),
    )
