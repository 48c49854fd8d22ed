r"""Grouted connections of piles and sleeves, ISO 19902 clause 15.1: axial force through the grout.

.. math::

    σ_a = \frac{P}{π D_p L_e}, \qquad
    f_{sliding} = C_p\,[2 + 140\,(h/s)^{0.8}]\,K^{0.6} f_{cu}^{0.3}, \qquad
    f_{shear} = [0.75 - 1.4\,h/s]\,f_{cu}^{0.5}, \qquad
    K = \Big(\frac{D_p}{t_p} + \frac{D_s}{t_s}\Big)^{-1} + \frac{1}{m}\Big(\frac{D_g}{t_g}\Big)^{-1}

in MPa, U = γ_R σ_a/(k f_g) with f_g the smaller and γ_R = 2.0. Written from knowledge of the 2007 edition and
not from its printed text; K also stands in HSE, Offshore Technology Report 2001/016.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import located, look_up, require
from jackettwin.files import Schema, read_yaml, validate

GAMMA_R = 2.0
"""Partial resistance factor of the interface."""
EARLY_MOVEMENT = 0.75
"""k where the connection moves by more than 0.035 % of D_p while grout with shear keys sets."""
_LENGTH = Annotated[float, Field(gt=0.0, le=100.0)]


class GroutedConnection(Schema):
    """A pile in a sleeve: diameters and walls of steel [m], grouted length, shear keys, cube strength [Pa].

    ``moves_early`` is whether it moves by more than 0.035 % of the pile's diameter while the grout sets;
    ``modular_ratio`` m is E of steel over that of grout.
    """

    feet: tuple[str, ...] = ()
    pile_diameter_m: _LENGTH
    pile_wall_m: _LENGTH
    sleeve_diameter_m: _LENGTH
    sleeve_wall_m: _LENGTH
    length_m: _LENGTH
    key_height_m: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    key_spacing_m: _LENGTH | None = None
    cube_strength_pa: Annotated[float, Field(ge=1e6, le=3e8)]
    modular_ratio: Annotated[float, Field(ge=1.0, le=100.0)] = 18.0
    moves_early: bool = False

    @property
    def annulus_m(self) -> float:
        """Thickness t_g of the grout."""
        return 0.5 * (self.sleeve_diameter_m - self.pile_diameter_m) - self.sleeve_wall_m

    @property
    def keys(self) -> float:
        """h/s; zero without shear keys."""
        return 0.0 if self.key_spacing_m is None else self.key_height_m / self.key_spacing_m

    @property
    def effective_length_m(self) -> float:
        """L_e: the length less twice the grout's thickness or one spacing of keys, whichever is more."""
        return self.length_m - max(2.0 * self.annulus_m, self.key_spacing_m or 0.0)

    @property
    def radial_stiffness(self) -> float:
        """K."""
        outside = self.sleeve_diameter_m - 2.0 * self.sleeve_wall_m
        steel = self.pile_diameter_m / self.pile_wall_m + self.sleeve_diameter_m / self.sleeve_wall_m
        return 1.0 / steel + self.annulus_m / (self.modular_ratio * outside)

    @property
    def scale_factor(self) -> float:
        """C_p = (D_p/1000)² − D_p/500 + 2 up to a diameter of 1000 mm, 1 beyond."""
        d = self.pile_diameter_m
        return d**2 - 2.0 * d + 2.0 if d <= 1.0 else 1.0

    @property
    def sliding_pa(self) -> float:
        """Strength of steel sliding on grout."""
        keys = 2.0 + 140.0 * self.keys**0.8
        return float(1e6 * self.scale_factor * keys * self.radial_stiffness**0.6 * self._cube**0.3)

    @property
    def shear_pa(self) -> float:
        """Strength of the grout between keys."""
        return float(1e6 * (0.75 - 1.4 * self.keys) * np.sqrt(self._cube))

    @property
    def _cube(self) -> float:
        return 1e-6 * self.cube_strength_pa

    @property
    def beyond_validity(self) -> tuple[str, ...]:
        """Quantities outside the range of the tests behind the formulas."""
        d, outside = self.pile_diameter_m, self.sleeve_diameter_m - 2.0 * self.sleeve_wall_m
        ranges = {
            "D_p/t_p": (d / self.pile_wall_m, 20.0, 40.0),
            "D_s/t_s": (self.sleeve_diameter_m / self.sleeve_wall_m, 30.0, 140.0),
            "D_g/t_g": (outside / self.annulus_m, 10.0, 45.0),
            "L_e/D_p": (self.effective_length_m / d, 1.0, 10.0),
            "f_cu [MPa]": (self._cube, 20.0, 80.0),
            "h/s": (self.keys, 0.0, 0.10),
            "K": (self.radial_stiffness, 0.0, 0.02),
            "h/D_p": (self.key_height_m / d, 0.0, 0.012),
            "D_p/s": (0.0 if self.key_spacing_m is None else d / self.key_spacing_m, 0.0, 16.0),
        }
        return tuple(
            f"{name} = {value:.3g} outside {low:g} to {high:g}"
            for name, (value, low, high) in ranges.items()
            if not low <= value <= high
        )

    def require_fit(self) -> None:
        """Refuse a pile that does not fit into its sleeve, or a length that grout and keys leave nothing of.

        Raises
        ------
        InputError
            Names what does not fit.
        """
        require(
            self.annulus_m > 0.0,
            "leaves no room for grout",
            field="sleeve_diameter_m",
            value=self.sleeve_diameter_m,
            allowed=f"> {self.pile_diameter_m + 2.0 * self.sleeve_wall_m:g}",
        )
        require(
            self.effective_length_m > 0.0,
            "leaves no effective length",
            field="length_m",
            value=self.length_m,
            allowed=f"> {self.length_m - self.effective_length_m:g}",
        )
        require(
            (self.key_height_m > 0.0) == (self.key_spacing_m is not None),
            "shear keys need height and spacing",
            field="key_spacing_m",
            value=self.key_spacing_m,
            remedy="give key_height_m and key_spacing_m, or neither",
        )


@dataclass(frozen=True)
class GroutUse:
    """Utilisation of the grout at a foot by an axial force [N], tension positive."""

    foot: str
    axial_n: float
    connection: GroutedConnection
    case: str = ""
    """The combination of actions it is of."""

    @property
    def stress_pa(self) -> float:
        """Interface transfer stress σ_a on the pile."""
        c = self.connection
        return abs(self.axial_n) / (np.pi * c.pile_diameter_m * c.effective_length_m)

    @property
    def governs(self) -> str:
        """``sliding`` or ``grout``: which strength is the smaller."""
        return "sliding" if self.connection.sliding_pa <= self.connection.shear_pa else "grout"

    @property
    def utilisation(self) -> float:
        """γ_R σ_a/(k f_g)."""
        c = self.connection
        k = EARLY_MOVEMENT if c.moves_early and c.keys > 0.0 else 1.0
        return GAMMA_R * self.stress_pa / (k * min(c.sliding_pa, c.shear_pa))


class _GroutFile(Schema):
    connections: Annotated[tuple[GroutedConnection, ...], Field(min_length=1)]


def read_grouted(path: Path, feet: tuple[str, ...]) -> dict[str, GroutedConnection]:
    """Return the grouted connection of each foot that a YAML file (``connections: [{…}, …]``) describes.

    Raises
    ------
    InputError
        If the file is wrong, names no foot of these, or one twice.
    """
    found: dict[str, GroutedConnection] = {}
    given = validate(_GroutFile, read_yaml(path, what="file of grouted connections"), file=path)
    for i, one in enumerate(given.connections):
        with located(file=path, field=f"connections.{i}"):
            one.require_fit()
            for foot in one.feet or feet:
                look_up(dict.fromkeys(feet), foot, "foot", field="feet")
                require(foot not in found, "a foot has two connections", field="feet", value=foot)
                found[foot] = one
    return found


def grout_uses(
    connections: Mapping[str, GroutedConnection], forces: Mapping[str, FloatArray]
) -> tuple[GroutUse, ...]:
    """Return the use of each foot's grout by the force (6,) of the foot on the ground, piles upright."""
    return tuple(GroutUse(foot, float(forces[foot][2]), one) for foot, one in connections.items())
