"""What a pile's neighbours and cycles along its axis take from the ground's reaction on it."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require, require_between
from jackettwin.soil.ground.profile import Clay, SoilProfile, ground_at
from jackettwin.soil.piles.piles import Pile, Stations

REACH = 7.0
"""Diameters between two piles beyond which neither weakens the other's ground."""
BEARING = 9.0
"""Bearing over undrained strength under a block of clay, as under a pile (API RP 2GEO 8.1)."""
_HEADINGS = np.radians(np.arange(360.0))


@dataclass(frozen=True)
class PileGroup:
    """Where the other piles of a group stand, x and y from this one [m], in the axes of the structure.

    ``heading_deg`` is the direction of the lateral load, anticlockwise from x; without it the direction that
    weakens this pile most counts.
    """

    others_m: tuple[tuple[float, float], ...]
    heading_deg: float | None = None

    def __post_init__(self) -> None:
        require(
            1 <= len(self.others_m) <= 500,
            "a group has other piles",
            field="others_m",
            value=len(self.others_m),
            allowed="1 to 500",
            remedy="give x and y of each from this pile, or leave the group out",
        )
        for place in self.others_m:
            for value in place:
                require_between("others_m", value, -1000.0, 1000.0, "m")
        if self.heading_deg is not None:
            require_between("heading_deg", self.heading_deg, -360.0, 360.0, "degrees")

    def p_multiplier(self, diameter_m: float) -> float:
        r"""Return the factor on this pile's p-y curves (Reese & Van Impe 2001; Reese, Isenhower & Wang 2006).

        Each neighbour, ``s`` diameters away, has β_a = 0.64 s^0.34 beside this pile, β_b = 0.7 s^0.26 behind
        it and β_b = 0.48 s^0.38 ahead, at most 1, and askew √(β_b² cos²φ + β_a² sin²φ); the factor is their
        product.

        >>> round(PileGroup(((6.0, 0.0),), heading_deg=0.0).p_multiplier(2.0), 4)
        0.7287

        Raises
        ------
        InputError
            If two piles overlap.
        """
        place = np.array(self.others_m)
        apart = np.hypot(place[:, 0], place[:, 1]) / diameter_m
        for number, one in enumerate(place):
            others = np.vstack([[0.0, 0.0], place[:number]])
            require(
                bool((np.hypot(*(others - one).T) >= diameter_m).all()),
                "piles of the group overlap",
                field="others_m",
                value=[float(v) for v in one],
                allowed=f"at least {diameter_m:g} m apart, and from this pile: at 0, 0 and not named",
            )
        given = self.heading_deg
        heading = _HEADINGS if given is None else np.radians([given])
        along = np.cos(np.arctan2(place[:, 1], place[:, 0]) - heading[:, None])
        beside = np.minimum(0.64 * apart**0.34, 1.0)
        behind = np.minimum(0.7 * apart**0.26, 1.0)
        ahead = np.minimum(0.48 * apart**0.38, 1.0)
        in_line = np.where(along > 0.0, ahead, behind)
        each = np.sqrt(in_line**2 * along**2 + beside**2 * (1.0 - along**2))
        return float(each.prod(axis=1).min())

    def block(
        self, pile: Pile, profile: SoilProfile, at: Stations, layer: list[int | None]
    ) -> ClayBlock | None:
        """Return this pile's share of a block of clay that fails with all its piles; None in other ground.

        Parameters
        ----------
        at, layer : stations along the pile, and the layer of each
        """
        if not all(isinstance(one.soil, Clay) for one in profile.layers):
            return None
        D = pile.outer_diameter_m
        points = [
            None if one is None else ground_at(profile, float(z), one, diameter=D)
            for z, one in zip(at.depth, layer, strict=True)
        ]
        strength = np.array([0.0 if point is None else point.strength_pa for point in points])
        perimeter, area = _around(np.array([(0.0, 0.0), *self.others_m]), 0.5 * D)
        n = 1 + len(self.others_m)
        shaft = perimeter * float(at.weight @ strength) / n
        return ClayBlock(shaft, BEARING * float(strength[-1]) * area / n)


@dataclass(frozen=True)
class ClayBlock:
    """A pile's share of the resistance of its group's block [N]: shear along its sides, bearing below."""

    shaft_n: float
    base_n: float


def _around(points: FloatArray, margin: float) -> tuple[float, float]:
    """Return perimeter and area of the convex hull of points (n, 2), moved outwards by a margin."""
    hull = _hull(points)
    sides = np.roll(hull, -1, axis=0) - hull
    perimeter = float(np.hypot(*sides.T).sum())
    area = 0.5 * abs(float((hull[:, 0] * sides[:, 1] - hull[:, 1] * sides[:, 0]).sum()))
    return perimeter + 2.0 * pi * margin, area + perimeter * margin + pi * margin**2


def _hull(points: FloatArray) -> FloatArray:
    """Return the corners of the convex hull, anticlockwise: two of points on a line (Andrew 1979)."""

    def half(ordered: FloatArray) -> list[FloatArray]:
        kept: list[FloatArray] = []
        for point in ordered:
            while len(kept) > 1 and _turns_left(kept[-2], kept[-1], point) <= 0.0:
                kept.pop()
            kept.append(point)
        return kept[:-1]

    ordered = np.unique(points, axis=0)
    return np.array([*half(ordered), *half(ordered[::-1])])


def _turns_left(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


@dataclass(frozen=True)
class AxialCycles:
    """Cycles along a pile's axis: their amplitude over the static shaft capacity, and their number.

    ``A``, ``B`` and ``C`` are of the field tests at Dunkirk in dense sand.
    """

    amplitude: float
    number: float
    A: float = -0.126
    B: float = -0.10
    C: float = 0.45

    def __post_init__(self) -> None:
        require_between("amplitude", self.amplitude, 0.0, 1.0)
        require_between("number", self.number, 1.0, 1e9)
        require_between("A", self.A, -1.0, 0.0)
        require_between("B", self.B, -1.0, 1.0)
        require_between("C", self.C, 0.0, 2.0)
        require(
            self.friction_left > 0.0,
            "so many cycles leave no friction on the shaft in sand",
            field="amplitude, number",
            value=[self.amplitude, self.number],
            allowed=f"at most {self.most:.4g} cycles of this amplitude",
            remedy="count the cycles of the storm that are as large, or lengthen the pile",
        )

    @property
    def friction_left(self) -> float:
        """Part of the shaft friction in sand that is left: 1 + A (B + τ_cyc/τ_max) N^C, at most 1.

        Jardine, Chow, Overy & Standing (2005); Jardine & Standing (2012).

        >>> round(AxialCycles(0.3, 100.0).friction_left, 4)
        0.7998
        """
        return float(min(1.0 + self.A * (self.B + self.amplitude) * self.number**self.C, 1.0))

    @property
    def most(self) -> float:
        """Number of cycles that leave nothing; infinite where the amplitude does no harm."""
        lost = -self.A * (self.B + self.amplitude)
        return float(lost ** (-1.0 / self.C)) if lost > 0.0 and self.C > 0.0 else np.inf
