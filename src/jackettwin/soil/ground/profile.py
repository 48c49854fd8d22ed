"""Layered ground: properties of each layer, scour, and the effective stress."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require, require_between
from jackettwin.files import Placed, refuse_tiny

_SAND_AT_MOST = {"beta": 10.0, "limit_friction_pa": 1e7, "bearing_factor": 1e4, "limit_bearing_pa": 1e9}
"""Far beyond any sand: a larger value is a slip of the pen."""
_DEEPEST_SCOUR = 300.0
"""Metres, or pile diameters."""
_UNITS = {"_deg": "degrees", "_pa": "Pa", "_n_m3": "N/m³", "_m": "m"}


@dataclass(frozen=True)
class Sand:
    """Siliceous sand; API RP 2GEO (2011) table 1 gives β and its limits by density.

    ``modulus_n_m3`` is the initial modulus of subgrade reaction k; None takes it from the friction angle.
    ``shear_modulus_pa``, of small strain at the layer's top and bottom, and ``relative_density`` (0 to 1) are
    for PISA's curves alone.
    """

    friction_angle_deg: float
    beta: float = 0.46
    limit_friction_pa: float = 96e3
    bearing_factor: float = 40.0
    limit_bearing_pa: float = 10e6
    modulus_n_m3: float | None = None
    relative_density: float | None = None
    shear_modulus_pa: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _check("friction_angle_deg", self.friction_angle_deg, 20.0, 45.0)
        for name, highest in _SAND_AT_MOST.items():
            _check(name, getattr(self, name), 0.0, highest)
        _check_shear_modulus(self.shear_modulus_pa)
        if self.relative_density is not None:
            _check("relative_density", self.relative_density, 0.2, 1.0)
        if self.modulus_n_m3 is not None:
            _check("modulus_n_m3", self.modulus_n_m3, 0.0, 1e10)
        refuse_tiny("limit_friction_pa", self.limit_friction_pa, least=1e3, remedy="Pa: 96 kPa is 96e3")
        refuse_tiny("limit_bearing_pa", self.limit_bearing_pa, least=5e4, remedy="Pa: 10 MPa is 10e6")
        refuse_tiny("modulus_n_m3", self.modulus_n_m3 or 0.0, least=1e5, remedy="N/m³: 22 MN/m³ is 22e6")


@dataclass(frozen=True)
class Clay:
    """Clay; ``strength_pa`` is the undrained shear strength at the layer's top and bottom, linear in between.

    ``stiff`` chooses the p-y curve of Reese et al. (1975) in place of Matlock's (1970), or without
    ``free_water`` that of Welch & Reese (1972). ``shear_modulus_pa``, of small strain at the layer's top and
    bottom, is for PISA's curves alone.
    """

    strength_pa: tuple[float, float]
    strain_50: float = 0.01
    J: float = 0.5
    residual: float = 0.9
    stiff: bool = False
    free_water: bool = True
    shear_modulus_pa: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _check_shear_modulus(self.shear_modulus_pa)
        for strength in self.strength_pa:
            _check("strength_pa", strength, 0.0, 1e8)
            refuse_tiny("strength_pa", strength, least=500.0, remedy="Pa: 20 kPa is 20e3")
        _check("strain_50", self.strain_50, 1e-4, 0.1)
        _check("J", self.J, 0.0, 1.0)
        _check("residual", self.residual, 0.0, 1.0)


@dataclass(frozen=True)
class Layer:
    """A layer of either sand or clay; ``effective_weight_n_m3`` is its submerged unit weight."""

    thickness_m: float
    effective_weight_n_m3: float
    sand: Placed[Sand] | None = None
    clay: Placed[Clay] | None = None

    def __post_init__(self) -> None:
        one = (self.sand is None) != (self.clay is None)
        require(one, "a layer is either sand or clay", field="sand, clay", remedy="give one of them")
        _check("thickness_m", self.thickness_m, 1e-6, 1e4)
        _check("effective_weight_n_m3", self.effective_weight_n_m3, 0.0, 30e3)
        weight = self.effective_weight_n_m3
        refuse_tiny("effective_weight_n_m3", weight, least=1e3, remedy="N/m³: 9 kN/m³ is 9e3")

    @property
    def soil(self) -> Sand | Clay:
        """Kind of soil of the layer."""
        soil = self.clay if self.sand is None else self.sand
        assert soil is not None
        return soil


@dataclass(frozen=True)
class Scour:
    """General scour lowers the whole seabed, local scour is a hole around the pile.

    Under a hole the vertical effective stress σ'_v grows linearly from zero at its bottom to its value
    without the hole at ``recovery_diameters`` pile diameters below (6 D: API RP 2GEO 2011, section 8.3 and
    its figure of the overburden reduction depth; DNV-ST-0126).
    """

    general_m: float = 0.0
    local_m: float = 0.0
    recovery_diameters: float = 6.0

    def __post_init__(self) -> None:
        for field in ("general_m", "local_m", "recovery_diameters"):
            require_between(field, getattr(self, field), 0.0, _DEEPEST_SCOUR)

    @property
    def total_m(self) -> float:
        """Depth of the hole's bottom below the original mudline [m]."""
        return self.general_m + self.local_m

    def recovery_m(self, diameter: float) -> float:
        """Return how far below the hole's bottom σ'_v has its value without the hole again [m].

        >>> Scour(local_m=2.0).recovery_m(1.5)
        9.0
        """
        return self.recovery_diameters * diameter if self.local_m > 0.0 else 0.0


@dataclass(frozen=True)
class SoilProfile:
    """Layers from the original mudline downwards; the lowest reaches as deep as it is asked."""

    layers: tuple[Layer, ...]
    scour: Scour = Scour()

    def __post_init__(self) -> None:
        require(self.layers, "a soil profile needs a layer", field="layers", value=[])

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
    ``mean_strength_pa`` its mean over the clay from there down (zero in sand); ``shear_modulus_pa`` is 0
    where the layer says none.
    """

    depth_m: float
    stress_pa: float
    strength_pa: float
    mean_strength_pa: float
    soil: Sand | Clay
    shear_modulus_pa: float = 0.0


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
    return Point(depth, stress, strength, mean, soil, _between(profile, layer, z, soil.shear_modulus_pa))


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
    return _between(profile, layer, z, one.soil.strength_pa)


def _between(profile: SoilProfile, layer: int, z: float, ends: tuple[float, float] | None) -> float:
    """Return a value at depth ``z`` from those at a layer's top and bottom, constant below; 0 of none."""
    if ends is None:
        return 0.0
    upper, lower = ends
    top = float(np.sum([above.thickness_m for above in profile.layers[:layer]]))
    return upper + (lower - upper) * min((z - top) / profile.layers[layer].thickness_m, 1.0)


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


def _check_shear_modulus(ends: tuple[float, float] | None) -> None:
    for value in ends or ():
        _check("shear_modulus_pa", value, 1e5, 1e11)


def _check(field: str, value: float, low: float, high: float) -> None:
    unit = next((unit for suffix, unit in _UNITS.items() if field.endswith(suffix)), "")
    require_between(field, value, low, high, unit)
