r"""Damping budget: contributions of the parts of the model to the damping of each mode.

By the imaginary part of :math:`x^H F(λ)\,x = 0`, the dissipation of a mode is the sum of that of the parts,

.. math::

    -2\,\mathrm{Re}λ\; x^H M x
    = x^H (αM + βK)\,x + \sum_g \frac{\mathrm{Im}\,D_g(λ)}{\mathrm{Im}\,λ}\; x^H S_g\, x,

exactly, for any law. Each term divided by :math:`2|λ|\,x^H M x` is that part's contribution to ζ.

Errors of the model change ζ by a factor. What an error of the ground's loss adds is the ground's; all other
errors change all parts alike. So the parts add up to the damping ratio that is told of the asset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.intervals import QUANTILES
from jackettwin.response import NumberedModes, Points, damping_ratio
from jackettwin.soil import law_stiffness
from jackettwin.updating.model import SupportModel

SOURCES = ("structure", "soil", "rotor", "water")
"""Sources of damping; water is left out if no drag is modelled, as its contribution is then not known."""
_SOIL = SOURCES.index("soil")

LITERATURE = {"structure": (0.01, 0.02), "soil": (0.005, 0.015), "water": (0.001, 0.004)}
"""Damping ratios of first bending modes that the literature reports by source, thesis section 2.1."""


@dataclass(frozen=True)
class Budget:
    """Damping ratio by source, NaN for a mode without a pole.

    Attributes
    ----------
    modes : mode numbers
    damping_ratio : (n_modes, n_sources) sums to the reported ζ; the first of ``SOURCES``
    damping_ratio_interval_90 : (n_modes, n_sources, 2), or None without draws
    """

    modes: tuple[int, ...]
    damping_ratio: FloatArray
    damping_ratio_interval_90: FloatArray | None


def damping_budget(
    model: SupportModel, theta: FloatArray, modes: tuple[int, ...], *, factors: FloatArray | None = None
) -> Budget:
    """Return the damping budget at a parameter vector.

    Parameters
    ----------
    factors : (3, 1, n_modes), optional
        Of the model's errors at θ, as of :meth:`jackettwin.updating.model_error.ErrorModel.factors`.
    """
    found = model.predict_many(theta[None], modes)
    parts = damping_sources(model, model.points(theta[None]), found)
    return Budget(modes, (parts if factors is None else of_the_asset(parts, factors))[0], None)


def budget_of_draws(modes: tuple[int, ...], draws: FloatArray) -> Budget:
    """Return the budget of draws of each source's damping ratio (n_draws, n_modes, n_sources).

    Medians of parts do not add up. What the parts are on average where the whole is at its median, the
    reported ζ, does: it is a line through the middle half of the draws.
    """
    ratio, interval = np.full(draws.shape[1:], np.nan), np.full((*draws.shape[1:], 2), np.nan)
    for m in range(len(modes)):
        parts = draws[~np.isnan(draws[:, m]).any(axis=1), m]
        if len(parts) == 0:
            continue
        whole = parts.sum(axis=1)
        near = np.argsort(whole)[len(parts) // 4 : len(parts) - len(parts) // 4]
        off = whole[near] - whole[near].mean()
        slope = off @ parts[near] / max(float(off @ off), np.finfo(float).tiny)
        ratio[m] = parts[near].mean(axis=0) + slope * (np.median(whole) - whole[near].mean())
        interval[m] = np.quantile(parts, QUANTILES[::2], axis=0).T
    return Budget(modes, ratio, interval)


def of_the_asset(parts: FloatArray, factors: FloatArray) -> FloatArray:
    """Return the sources' damping ratios (n_sets, n_modes, n_sources) of the asset from those of the model.

    If the ground's loss is so much smaller that the ground would give less than nothing, it gives nothing.

    Parameters
    ----------
    factors : (3, n_sets, n_modes)
        Of the model's errors, as of :meth:`jackettwin.updating.model_error.ErrorModel.factors`.
    """
    _, by_all, by_loss = factors
    told = parts * (by_all / by_loss)[..., None]
    told[..., _SOIL] = np.maximum(told[..., _SOIL] + told.sum(axis=-1) * (by_loss - 1.0), 0.0)
    return np.asarray(told * (parts.sum(axis=-1) * by_all / told.sum(axis=-1))[..., None])


def beyond_literature(label: str, ratios: Mapping[str, float | None]) -> tuple[str, ...]:
    """Return a sentence for every source whose damping ratio is outside the range of ``LITERATURE``.

    The ranges are those of first bending modes; other modes and unknown ratios are not checked.

    >>> beyond_literature("fore_aft_1", {"structure": 0.012, "soil": 0.0002, "water": None})
    ('soil gives fore_aft_1 0.02 % damping, less than the 0.5 to 1.5 % of the literature',)
    """
    if label not in ("fore_aft_1", "side_side_1"):
        return ()
    found = []
    for source, (low, high) in LITERATURE.items():
        zeta = ratios.get(source)
        if zeta is None or low <= zeta <= high or zeta != zeta:
            continue
        side = "less" if zeta < low else "more"
        found.append(
            f"{source} gives {label} {100 * zeta:.2g} % damping, "
            f"{side} than the {100 * low:g} to {100 * high:g} % of the literature"
        )
    return tuple(found)


def damping_sources(model: SupportModel, points: Points, found: NumberedModes) -> FloatArray:
    """Return the damping ratio (n_sets, n_modes, n_sources) that each source gives the model's modes."""
    pencil, n_soil = model.condensed.pencil, len(model.tie_groups.suffixes)
    n_rotor = n_soil + len(model.nuisance.dashpots)
    known = ~np.isnan(found.poles)
    x, pole = np.where(known[..., None], found.shapes, 1.0), np.where(known, found.poles, 1j)
    m = np.einsum("kmi,kmi->km", x.conj() @ pencil.M, x).real
    k = np.einsum("kmi,kmi->km", x.conj() @ pencil.K, x).real
    a, b = points.rayleigh[:, :1], points.rayleigh[:, 1:]
    groups = np.zeros((*pole.shape, len(pencil.groups)))
    for g, group in enumerate(pencil.groups):
        D = law_stiffness(points.rows[:, g, None], pole)
        groups[..., g] = D.imag / pole.imag * np.einsum("kmi,kmi->km", x.conj() @ group.S, x).real
    soil, rotor = groups[..., :n_soil].sum(axis=-1), groups[..., n_soil:n_rotor].sum(axis=-1)
    spread = (*model.nuisance.matrices, *model.nuisance.given)
    of_matrices = dict(zip(spread, np.moveaxis(groups[..., n_rotor:], -1, 0), strict=True))
    drag = of_matrices.pop("water_damping", None)
    steel = a * m + b * k + sum(of_matrices.values())
    lost = np.stack([steel, soil, rotor, *([] if drag is None else [drag])], axis=-1)
    # M and K of the coordinates lack the contribution of truncated modes (1e-4): scale the sum to ζ
    zeta = damping_ratio(pole)
    ratio = lost * (zeta / lost.sum(axis=-1))[..., None]
    return np.where(known[..., None], ratio, np.nan)
