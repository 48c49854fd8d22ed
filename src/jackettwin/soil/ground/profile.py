"""Layered ground: what each layer is made of, and the effective stress it carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, require_between
from jackettwin.soil.ground.scour import NO_SCOUR, Scour

_SAND_AT_MOST = {"beta": 10.0, "limit_friction_pa": 1e7, "bearing_factor": 1e4, "limit_bearing_pa": 1e9}
"""Far beyond any sand: a slip, not a soil."""
_UNITS = {"_deg": "degrees", "_pa": "Pa", "_n_m3": "N/m³", "_m": "m"}


@dataclass(frozen=True)
class Sand:
    """Siliceous sand; API RP 2GEO (2011) table 1 gives β and its limits by density.

    ``modulus_n_m3`` is the initial modulus of subgrade reaction k; None takes it from the friction angle.
    """

    friction_angle_deg: float
    beta: float = 0.46
    limit_friction_pa: float = 96e3
    bearing_factor: float = 40.0
    limit_bearing_pa: float = 10e6
    modulus_n_m3: float | None = None

    def __post_init__(self) -> None:
        _check("friction_angle_deg", self.friction_angle_deg, 20.0, 45.0)
        for name, highest in _SAND_AT_MOST.items():
            _check(name, getattr(self, name), 0.0, highest)
        if self.modulus_n_m3 is not None:
            _check("modulus_n_m3", self.modulus_n_m3, 0.0, 1e10)


@dataclass(frozen=True)
class Clay:
    """Clay; the undrained shear strength goes linearly from the layer's top to its bottom.

    ``stiff`` chooses the p-y curve of Reese et al. (1975) in place of Matlock's (1970), or without
    ``free_water`` that of Welch & Reese (1972).
    """

    strength_top_pa: float
    strength_bottom_pa: float
    strain_50: float = 0.01
    J: float = 0.5
    residual: float = 0.9
    stiff: bool = False
    free_water: bool = True

    def __post_init__(self) -> None:
        for strength in (self.strength_top_pa, self.strength_bottom_pa):
            _check("strength_pa", strength, 0.0, 1e8)
        _check("strain_50", self.strain_50, 1e-4, 0.1)
        _check("J", self.J, 0.0, 1.0)
        _check("residual", self.residual, 0.0, 1.0)


@dataclass(frozen=True)
class Layer:
    """A layer of one soil; ``effective_weight_n_m3`` is its submerged unit weight."""

    thickness_m: float
    effective_weight_n_m3: float
    soil: Sand | Clay

    def __post_init__(self) -> None:
        _check("thickness_m", self.thickness_m, 1e-6, 1e4)
        _check("effective_weight_n_m3", self.effective_weight_n_m3, 0.0, 30e3)


@dataclass(frozen=True)
class SoilProfile:
    """Layers from the original mudline downwards; the lowest reaches as deep as it is asked."""

    layers: tuple[Layer, ...]
    scour: Scour = NO_SCOUR

    def __post_init__(self) -> None:
        if not self.layers:
            raise InputError("a soil profile needs a layer", field="layers", value=[])

    @property
    def boundaries_m(self) -> FloatArray:
        """Depth of the layers' lower edges [m], the lowest left out."""
        return np.cumsum([layer.thickness_m for layer in self.layers])[:-1]

    def effective_stress(self, z: FloatArray | float) -> FloatArray:
        """Return σ'_v [Pa] at depth ``z`` [m] below the original mudline, without scour.

        >>> SoilProfile((Layer(5.0, 10e3, Sand(35.0)),)).effective_stress(2.0).tolist()
        20000.0
        """
        z = np.asarray(z, dtype=np.float64)
        weights = np.array([layer.effective_weight_n_m3 for layer in self.layers])
        tops = np.concatenate([[0.0], self.boundaries_m])
        bottoms = np.append(self.boundaries_m, np.inf)
        inside = np.clip(z[..., None], tops, bottoms) - tops
        return np.asarray(inside @ weights)


@dataclass(frozen=True)
class Point:
    """The ground at one depth, scour allowed for.

    ``depth_m`` counts from the bottom of the scour hole, ``stress_pa`` is σ'_v, ``strength_pa`` is s_u and
    ``mean_strength_pa`` its mean over the clay from there down (zero in sand).
    """

    depth_m: float
    stress_pa: float
    strength_pa: float
    mean_strength_pa: float
    soil: Sand | Clay


def ground_at(profile: SoilProfile, z: float, layer: int, *, diameter: float) -> Point | None:
    """Return the ground at depth ``z`` [m] below the original mudline in ``layer``; None if scoured away."""
    scour = profile.scour
    depth = z - scour.total_m
    if depth < 0.0:
        return None
    stress = _stress(profile, depth, scour.recovery_m(diameter))
    soil = profile.layers[layer].soil
    strength = _strength(profile, layer, z)
    mean = _mean_strength(profile, layer, scour.total_m, z) if isinstance(soil, Clay) else 0.0
    return Point(depth, stress, strength, mean, soil)


def _stress(profile: SoilProfile, depth: float, recovery: float) -> float:
    """Return σ'_v [Pa] at ``depth`` below the hole's bottom, linear down to the recovery depth [m]."""
    scour = profile.scour
    below = max(depth, recovery)
    full = profile.effective_stress(scour.total_m + below) - profile.effective_stress(scour.general_m)
    return float(full) * (depth / below if below > 0.0 else 1.0)


def _strength(profile: SoilProfile, layer: int, z: float) -> float:
    """Return s_u [Pa] of a layer at depth ``z``, zero in sand; below the layer's bottom it stays."""
    one = profile.layers[layer]
    if not isinstance(one.soil, Clay):
        return 0.0
    top = float(np.sum([above.thickness_m for above in profile.layers[:layer]]))
    at = min((z - top) / one.thickness_m, 1.0)
    return one.soil.strength_top_pa + (one.soil.strength_bottom_pa - one.soil.strength_top_pa) * at


def _mean_strength(profile: SoilProfile, layer: int, top: float, z: float) -> float:
    """Return the mean of s_u [Pa] over the clay between depths ``top`` and ``z``, which lies in ``layer``."""
    edges = np.concatenate([[0.0], profile.boundaries_m])
    total = length = 0.0
    for k in range(layer + 1):
        bottom = z if k == layer else float(edges[k + 1])
        start = max(float(edges[k]), top)
        if isinstance(profile.layers[k].soil, Clay) and bottom > start:
            # three depths: below the lowest layer's bottom its strength stays
            at = [start, min(max(float(edges[k]) + profile.layers[k].thickness_m, start), bottom), bottom]
            total += float(np.trapezoid([_strength(profile, k, depth) for depth in at], at))
            length += bottom - start
    return total / length if length > 0.0 else _strength(profile, layer, z)


def _check(field: str, value: float, low: float, high: float) -> None:
    unit = next((unit for suffix, unit in _UNITS.items() if field.endswith(suffix)), "")
    require_between(field, value, low, high, unit)
