"""A quantity of a structure that a refinement may change, within bounds and a tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from jackettwin.errors import require
from jackettwin.structure import PROPERTIES, Structure, adjusted

_WIDEST = 3.0
"""Default distance of the bounds from the present value, in tolerances."""


@dataclass(frozen=True)
class Factor:
    """A quantity of a structure that may change, by a factor or an addition.

    Attributes
    ----------
    name_of : str
        Name of the part, node of the body (``rna`` for the top), spring or foot (``all``).
    what : str
        Property: a key of ``PROPERTIES`` of its kind.
    low, high : float, optional
        Bounds, both or none; by default 0.1 and 10 for a factor, and three tolerances about the present
        value.
    tolerance : float, optional
        Prior standard deviation: of ln of a factor, or of an addition in its unit.
    of : {"part", "body", "spring", "foot"}
    """

    name_of: str
    what: str
    low: float | None = None
    high: float | None = None
    tolerance: float | None = None
    of: Literal["part", "body", "spring", "foot"] = "part"

    def __post_init__(self) -> None:
        low, high = self.bounds
        rest = 1.0 if self.is_factor else 0.0
        require(
            low < high and (low > 0.0 or not self.is_factor),
            "bounds are reversed or not positive",
            field="bounds",
            value=[low, high],
            allowed="0 < low < high" if self.is_factor else "low < high",
            remedy="give [low, high]",
        )
        require(
            low <= rest <= high,
            "the bounds exclude the present value",
            field="bounds",
            value=[low, high],
            allowed=f"around {rest:g}",
            remedy="change the structure first, or widen the bounds",
        )

    @property
    def is_factor(self) -> bool:
        """Whether it multiplies the present value; otherwise it is added."""
        return PROPERTIES[self.of][self.what].is_factor

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value."""
        if self.low is not None and self.high is not None:
            return self.low, self.high
        return _usual_bounds(self.what, self.is_factor, self.tolerance)

    @property
    def scale(self) -> float:
        """Scale of the search variable; for a factor it is that of the logarithm."""
        low, high = self.bounds
        return 1.0 if self.is_factor else self.tolerance or 0.5 * (high - low)

    @property
    def name(self) -> str:
        """``part.property``."""
        return f"{self.name_of}.{self.what}"

    @property
    def key(self) -> str:
        """Name with the kind, which is unique in a structure."""
        return f"{self.of} {self.name}"

    def value(self, z: float) -> float:
        """Return the factor or the addition at a value z of the search variable."""
        return float(np.exp(z)) if self.is_factor else float(self.scale * z)

    def place(self, value: float) -> float:
        """Return the inverse of :meth:`value`."""
        return float(np.log(value)) if self.is_factor else value / self.scale

    def on(self, structure: Structure, value: float) -> Structure:
        """Return the structure with this quantity changed."""
        return adjusted(structure, self.of, self.name_of, self.what, value)


def _usual_bounds(what: str, is_factor: bool, tolerance: float | None) -> tuple[float, float]:
    if tolerance is None:
        require(
            is_factor, "needs bounds or a tolerance", field="bounds", value=None, remedy="bounds: [low, high]"
        )
        return 0.1, 10.0
    if is_factor:
        return float(np.exp(-_WIDEST * tolerance)), float(np.exp(_WIDEST * tolerance))
    return (0.0 if what in ("added_mass_kg", "growth_m") else -_WIDEST * tolerance), _WIDEST * tolerance
