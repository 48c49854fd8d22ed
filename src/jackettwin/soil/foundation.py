"""Pile foundations from YAML: a pile, its ground, and the damping of both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from math import inf, pi
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from jackettwin.errors import InputError, located, require
from jackettwin.files import Frequency, Placed, Schema, find_file, read_yaml, shipped, validate
from jackettwin.soil.ground.profile import Layer, Scour, SoilProfile
from jackettwin.soil.laws.files import LawSchema
from jackettwin.soil.laws.viscoelastic import Law
from jackettwin.soil.piles.cyclic import CyclicPile, cyclic_pile
from jackettwin.soil.piles.group import REACH
from jackettwin.soil.piles.impedance import lumped_head, on_pile_heads
from jackettwin.soil.piles.pile_head import PileHead
from jackettwin.soil.piles.piles import Pile, PileSprings, dashpots, linear_springs, with_piles
from jackettwin.soil.piles.radiation import Radiation
from jackettwin.soil.piles.reaction_curves import PileCurves, linearised, pile_curves
from jackettwin.soil.piles.soil_curves import CurveOptions
from jackettwin.soil.support import ELASTIC, Support
from jackettwin.structure import Structure

SLENDER = 10.0
"""Diameters of length below which a pile is not slender: on monopiles, of 2 to 6, shear at the base and along
the sides counts as well (Byrne et al. 2015, the PISA tests)."""

PileModel = Literal["head", "members"]
"""Piles lumped at their heads (fast; what an update scales), or beams on springs along their length."""

Stiffness = Annotated[float, Field(ge=0.0, le=1e15)]
"""Of linear ground [N/m³, N/m² or N/m]: the upper end is rigid."""


@dataclass(frozen=True)
class Foundation:
    """One pile design for every foot: the pile, its linear springs, and the law of the ground."""

    pile: Pile
    springs: PileSprings
    law: Law = ELASTIC
    radiation: Radiation | None = None
    curves: PileCurves | None = None
    """The ground's own curves; None for linear ground."""
    notes: tuple[str, ...] = ()
    """Assumptions about the ground, one sentence each."""
    profile: SoilProfile | None = None
    """The layers that the curves are of; None for linear ground."""
    options: CurveOptions = CurveOptions()
    """Which curves they are."""
    pile_model: PileModel = "head"
    """Whether the piles are members of a structure that stands on them, or lumped at its feet."""

    def under(self, structure: Structure, model: PileModel | None = None) -> tuple[Structure, Support]:
        """Return the structure on its piles: by ``model``, or else as the foundation itself says."""
        return self.piled(structure) if (model or self.pile_model) == "members" else self.lumped(structure)

    def scoured(self, depth_m: float) -> Foundation:
        """Return the foundation with a hole around the pile that is so much deeper.

        Raises
        ------
        InputError
            If the ground is linear, or the hole reaches the tip of the pile.
        """
        if self.profile is None:
            raise InputError(
                "linear ground knows no scour", field="scour", remedy="describe the ground by layers"
            )
        scour = replace(self.profile.scour, local_m=self.profile.scour.local_m + depth_m)
        profile = replace(self.profile, scour=scour)
        curves = pile_curves(self.pile, profile, self.options)
        return replace(self, springs=linearised(curves), curves=curves, profile=profile)

    def head(self, above: Structure | None = None) -> PileHead:
        """Return a pile lumped at its head, with the beam theory of the structure above."""
        return lumped_head(self.pile, self.springs, law=self.law, dashpots=self.dashpots, above=above)

    def cyclic(self) -> CyclicPile:
        """Return a pile in ground that unloads and reloads.

        Raises
        ------
        InputError
            If the ground is linear, or damps by a law already.
        """
        if self.curves is None:
            raise InputError(
                "linear ground has no loops", field="hysteresis", remedy="describe the ground by layers"
            )
        require(
            not self.curves.sides,
            "loops know no moments along the shaft",
            field="hysteresis",
            remedy="take other curves than PISA's",
        )
        require(
            self.law == ELASTIC,
            "loops are the ground's damping already",
            field="hysteresis",
            remedy="leave damping and law out",
        )
        return cyclic_pile(self.pile, self.curves)

    @property
    def dashpots(self) -> PileSprings | None:
        """Radiation damping of the ground [N·s/m], beside its law."""
        return None if self.radiation is None else self.radiation.on(self.pile, self.springs)

    def piled(self, structure: Structure) -> tuple[Structure, Support]:
        """Return the structure on its piles, every node of them."""
        piled, support = with_piles(structure, self.pile, self.springs, law=self.law, dashpots=self.dashpots)
        return piled, replace(support, notes=(*self.notes, *self._close_feet(structure)))

    def heads(self, structure: Structure) -> Support:
        """Return pile heads lumped at the feet: as many unknowns as without piles."""
        notes = (*self.notes, *self._close_feet(structure))
        return replace(on_pile_heads(structure, self.head(structure)), notes=notes)

    def _close_feet(self, structure: Structure) -> tuple[str, ...]:
        """Return a sentence on feet whose piles weaken each other's ground, if no group is given."""
        if self.profile is None or self.options.group is not None or self.options.p_multiplier != 1.0:
            return ()
        plan = [np.array(structure.nodes[node][:2]) for node in structure.reaction_nodes]
        apart = min((float(np.hypot(*(b - a))) for a, b in combinations(plan, 2)), default=inf)
        D = self.pile.outer_diameter_m
        if apart >= REACH * D:
            return ()
        return (
            f"feet are {apart / D:.1f} diameters apart: their piles weaken each other's ground, which is "
            "left out; give curves: {group: {others_m: …}}",
        )

    def lumped(self, structure: Structure) -> tuple[Structure, Support]:
        """Return the structure and its pile heads, as ``piled`` does with every node of the piles."""
        return structure, self.heads(structure)


class LinearSchema(Schema):
    """Linear ground: k_h = lateral·z, constant k_v, a spring under the tip."""

    lateral_n_m3: Stiffness
    axial_n_m2: Stiffness
    tip_n_m: Stiffness = 0.0


class SoilSchema(Schema):
    """Layers of soil, or linear ground."""

    layers: list[Placed[Layer]] | None = Field(default=None, min_length=1)
    linear: LinearSchema | None = None


class FoundationDampingSchema(Schema):
    """Dashpots c = 2ζk/ω1 (thesis eq. (5.4))."""

    ratio: Annotated[float, Field(ge=0.0, lt=1.0)]
    frequency_hz: Frequency


class FoundationSchema(Schema):
    """A foundation file."""

    pile: Placed[Pile]
    soil: SoilSchema
    scour: Placed[Scour] | None = None
    curves: Placed[CurveOptions] = CurveOptions()
    damping: FoundationDampingSchema | None = None
    law: LawSchema | None = None
    radiation: Placed[Radiation] | None = None
    pile_model: PileModel = "head"

    def build(self) -> Foundation:
        """Return the foundation."""
        once = self.damping is None or self.law is None
        require(once, "damping is given twice", field="damping, law", remedy="give one of them")
        law: Law = ELASTIC
        if self.damping is not None:
            law = dashpots(self.damping.ratio, 2.0 * pi * self.damping.frequency_hz)
        elif self.law is not None:
            with located(field="law"):
                law = self.law.build()
        profile, curves = self._profile(), None
        if profile is not None:
            curves = pile_curves(self.pile, profile, self.curves)
        springs = self._linear() if curves is None else linearised(curves)
        notes = self._notes()
        about = (curves, notes, profile, self.curves, self.pile_model)
        return Foundation(self.pile, springs, law, self.radiation, *about)

    def _notes(self) -> tuple[str, ...]:
        """Return sentences on a pile longer than its layers, on one not slender, and on cycles in clay."""
        if self.soil.layers is None:
            return ()
        notes, length = [], self.pile.length_m
        described = sum(layer.thickness_m for layer in self.soil.layers)
        if length > described + 1e-9:
            notes.append(
                f"the pile reaches {length:g} m, the layers {described:g} m: "
                "the lowest is taken to go on below"
            )
        slenderness = length / self.pile.outer_diameter_m
        stocky = all(self.curves.is_stocky(layer.soil) for layer in self.soil.layers)
        if slenderness < SLENDER and not stocky:
            notes.append(
                f"the pile is only {slenderness:.1f} diameters long: API's curves are of slender piles; base "
                "and side shear, by which a monopile or a caisson carries much of its load, are left out"
            )
        if self.curves.axial_cycles is not None and any(one.clay for one in self.soil.layers):
            notes.append("cycles along the axis weaken sand alone; for clay give curves: {t_multiplier: …}")
        return tuple(notes)

    def _profile(self) -> SoilProfile | None:
        layers, linear = self.soil.layers, self.soil.linear
        one = (layers is None) != (linear is None)
        require(one, "the ground is either layers or linear", field="soil", remedy="give one of them")
        return None if layers is None else SoilProfile(tuple(layers), self.scour or Scour())

    def _linear(self) -> PileSprings:
        linear = self.soil.linear
        assert linear is not None
        require(
            self.scour is None,
            "linear ground knows no scour",
            field="scour",
            remedy="describe the ground by layers",
        )
        return linear_springs(
            self.pile,
            lateral=lambda z: linear.lateral_n_m3 * z,
            axial=lambda z: np.full_like(z, linear.axial_n_m2),
            tip_n_m=linear.tip_n_m,
        )


def shipped_foundations() -> tuple[str, ...]:
    """Return the names of the foundations that come with the package."""
    return shipped("foundations")


def read_foundation(name: str | Path) -> Foundation:
    """Return the foundation of a YAML file, or a shipped one (``jacket15``, ``jacket15_records``).

    Raises
    ------
    InputError
        If the file is missing or says something that cannot be.
    """
    path = find_file(name, "foundations")
    return build_foundation(read_yaml(path, what="foundation file"), path)


def build_foundation(content: Any, path: Path) -> Foundation:
    """Return the foundation that a file's content describes.

    Raises
    ------
    InputError
        If it says something that cannot be.
    """
    schema = validate(FoundationSchema, content, file=path)
    with located(file=path):
        return schema.build()
