"""Layers by equivalent depths: Georgiadis (1983, Geotechnical Practice in Offshore Engineering, ASCE, 536).

A layer's p-y curves are those of ground made of this layer alone, whose surface lies so high that it resists
a pile from there to the layer's top with the same ultimate force as all real layers above:

    ∫₀^h p_u(ζ) dζ = Σ ∫ p_u dz over the layers above, each from its own surface.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import brentq

from jackettwin.arrays import FloatArray
from jackettwin.errors import require
from jackettwin.soil.ground.profile import Clay, Layer, Point, SoilProfile

Resistance = Callable[[Point], float]
"""Ultimate lateral resistance of a metre of pile [N/m]."""

_STEPS = 200
"""Trapezoids over a layer: some 1e-4 of its force where p_u has a kink."""
_DEEPEST = 2.0**12
"""Highest equivalent surface above a layer [m]; one that would lie higher does not exist."""


def equivalent_points(
    profile: SoilProfile, depth: FloatArray, layer: Sequence[int | None], resistance: Resistance
) -> list[Point | None]:
    """Return the ground at every depth below its layer's own equivalent surface; None if scoured away.

    Parameters
    ----------
    depth : (n,) below the original mudline [m]
    layer : (n,) of each depth

    Raises
    ------
    InputError
        If scour is local, for which no equivalent depth is defined, or a layer has no strength.
    """
    require(
        profile.scour.local_m <= 0.0,
        "equivalent depths know no local scour",
        field="scour.local_m",
        value=profile.scour.local_m,
        allowed="0",
        remedy="give it as general_m, or take curves.layering: overburden",
    )
    surfaces = equivalent_depths(profile, resistance)
    return [
        None if one is None else _point(profile, one, float(z), surfaces[one])
        for z, one in zip(depth, layer, strict=True)
    ]


def equivalent_depths(profile: SoilProfile, resistance: Resistance) -> list[float]:
    """Return how deep every layer's top lies below the layer's own equivalent surface [m].

    Raises
    ------
    InputError
        If a layer has no strength.
    """
    scour = profile.scour.general_m
    edges = np.concatenate([[0.0], profile.boundaries_m, [np.inf]])
    depths: list[float] = []
    force = 0.0
    for k in range(len(profile.layers)):
        top, bottom = max(float(edges[k]), scour), float(edges[k + 1])
        h = _equivalent_depth(profile, k, top, force, resistance)
        depths.append(h)
        if np.isfinite(bottom) and bottom > top:
            z = np.linspace(top, bottom, _STEPS + 1)
            force += float(np.trapezoid([resistance(_point(profile, k, d, h)) for d in z], z))
    return depths


def _equivalent_depth(
    profile: SoilProfile, k: int, top: float, force: float, resistance: Resistance
) -> float:
    """Return h with ∫₀^h p_u dζ = ``force`` in layer ``k`` alone."""
    if force == 0.0:
        return 0.0

    def short_of(h: float) -> float:
        zeta = np.linspace(0.0, h, _STEPS + 1)
        # at the layer's top h is the depth below the surface, so these points lie above it
        return force - float(np.trapezoid([resistance(_point(profile, k, top, one)) for one in zeta], zeta))

    deepest = 1.0
    while short_of(deepest) > 0.0:
        deepest *= 2.0
        require(
            deepest <= _DEEPEST,
            "a layer this weak has no equivalent depth",
            field=f"soil.layers.{k}",
            value=f"{force:.3g} N above it",
            remedy="check its strength, or take curves.layering: overburden",
        )
    return float(brentq(short_of, 0.0, deepest, xtol=1e-9))


def _point(profile: SoilProfile, k: int, z: float, h: float) -> Point:
    """Return the ground at depth ``z`` in layer ``k`` whose top lies ``h`` below its equivalent surface."""
    layer = profile.layers[k]
    edge = float(profile.boundaries_m[k - 1]) if k else 0.0
    top = max(edge, profile.scour.general_m)
    zeta = h + z - top
    strength, mean = _strengths(layer, edge, top, z, h)
    return Point(zeta, layer.effective_weight_n_m3 * zeta, strength, mean, layer.soil)


def _strengths(layer: Layer, edge: float, top: float, z: float, h: float) -> tuple[float, float]:
    """Return s_u at ``z`` and its mean from the equivalent surface down; above the top it is the top's."""
    if not isinstance(layer.soil, Clay):
        return 0.0, 0.0
    (upper, lower), t = layer.soil.strength_pa, layer.thickness_m
    at = np.array([top, z, min(max(edge + t, top), z)])
    su = upper + (lower - upper) * np.minimum((at - edge) / t, 1.0)
    first, here, last = map(float, su)
    if h + z - top <= 0.0:
        return here, here
    within = 0.5 * (first + last) * (at[2] - top) + last * (z - at[2])
    return here, float((first * h + within) / (h + z - top))
