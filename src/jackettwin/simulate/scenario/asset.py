"""The asset of a scenario: structure, ground, damping of the steel."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.decks import RnaSchema, StructureChoice
from jackettwin.errors import InputError, located, require
from jackettwin.files import Placed, Schema
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import (
    CurveOptions,
    Foundation,
    Pile,
    PileModel,
    Radiation,
    Scour,
    Support,
    read_foundation,
    read_supported,
    standing,
)
from jackettwin.soil.foundation import FoundationDampingSchema, FoundationSchema, SoilSchema
from jackettwin.soil.laws.files import LawSchema
from jackettwin.structure import Rayleigh, RayleighSchema, Structure, assemble


@dataclass(frozen=True)
class Asset:
    """The structure on its supports."""

    structure: Structure
    support: Support
    beam: str | None = None
    rotary_inertia: bool | None = None
    subdivide: int | None = None
    gravity: bool = True
    rayleigh: Rayleigh = Rayleigh()
    support_text: str | None = None
    """The support as a short form, if it was given so: parameters that an update should find again."""
    coupled_damping: float | None = None
    """Damping ratio to which the tower is tuned: that of the first modes of the whole asset in still air."""
    foundation: Foundation | None = None
    """Piles whose ground unloads and reloads in time; None if it is the support's linear law."""


class SteelDampingSchema(Schema):
    """``damping``: of the steel, and the ratio to which the tower is tuned in the coupled first modes."""

    rayleigh: RayleighSchema | None = None
    coupled: Annotated[float, Field(gt=0.0, lt=0.2)] | None = None


class GroundSchema(SoilSchema):
    """``soil``: layers or linear ground, scour, which curves, and the ground's damping or law."""

    scour: Placed[Scour] | None = None
    curves: Placed[CurveOptions] = CurveOptions()
    damping: FoundationDampingSchema | None = None
    law: LawSchema | None = None
    radiation: Placed[Radiation] | None = None
    hysteresis: bool = False


class AssetSchema(Schema):
    """The asset of a scenario file.

    The ground is ``soil`` with ``piles``, or ``foundation`` (a file or a shipped name), or ``support``.
    """

    structure: str | StructureChoice
    rna: RnaSchema | None = None
    beam: Literal["euler-bernoulli", "timoshenko"] | None = None
    rotary_inertia: bool | None = None
    subdivide: Annotated[int, Field(ge=1, le=1000)] | None = None
    gravity: bool = True
    damping: SteelDampingSchema = SteelDampingSchema()
    soil: GroundSchema | None = None
    piles: Placed[Pile] | None = None
    foundation: str | None = None
    support: str | None = None
    pile_model: PileModel | None = None

    def build(self, folder: Path) -> Asset:
        """Return the asset; relative paths are relative to ``folder``.

        Raises
        ------
        InputError
            If a part is missing, given twice, or wrong.
        """
        structure = _structure(self, folder).with_theory(self.beam, self.rotary_inertia)
        foundation = _foundation(self, folder)
        loops = self.soil is not None and self.soil.hysteresis
        if foundation is None:
            structure, support = read_supported(
                self.support,
                structure,
                pile_model=self.pile_model,
                first_frequency_hz=lambda: _first_frequency(structure),
                folder=folder,
            )
        else:
            structure, support = foundation.under(structure, self.pile_model)
            if loops:
                _check_loops(foundation, self.pile_model)
        steel = self.damping.rayleigh
        return Asset(
            structure=structure,
            support=support,
            beam=self.beam,
            rotary_inertia=self.rotary_inertia,
            subdivide=self.subdivide,
            gravity=self.gravity,
            rayleigh=Rayleigh() if steel is None else steel.build(),
            support_text=self.support,
            coupled_damping=self.damping.coupled,
            foundation=foundation if loops else None,
        )


def _check_loops(foundation: Foundation, model: PileModel | None) -> None:
    """Refuse loops of ground that has none, or that is not stepped at the heads."""
    with located(field="soil"):
        foundation.cyclic()
    require(
        (model or foundation.pile_model) == "head",
        "loops are stepped at the heads of piles",
        field="pile_model",
        value="members",
        allowed="head",
        remedy="take pile_model: head, or soil.hysteresis: false",
    )


def _structure(schema: AssetSchema, folder: Path) -> Structure:
    choice = schema.structure
    return (StructureChoice(source=choice) if isinstance(choice, str) else choice).read(folder, schema.rna)


def _foundation(schema: AssetSchema, folder: Path) -> Foundation | None:
    given = [key for key in ("soil", "foundation", "support") if getattr(schema, key) is not None]
    twice = "the ground is given twice"
    require(len(given) <= 1, twice, field=", ".join(given), remedy="keep one of them")
    if schema.foundation is not None:
        name = schema.foundation
        return read_foundation(folder / name if Path(name).suffix else name)
    require(
        (schema.soil is None) == (schema.piles is None),
        "soil and piles go together",
        field="piles" if schema.piles is None else "soil",
        remedy="give both, or foundation, or support",
    )
    if schema.soil is None or schema.piles is None:
        return None
    ground = schema.soil
    soil = SoilSchema(layers=ground.layers, linear=ground.linear)
    options = ("scour", "curves", "damping", "law", "radiation")
    whole = FoundationSchema(
        pile=schema.piles, soil=soil, **{name: getattr(ground, name) for name in options}
    )
    try:
        return whole.build()
    except InputError as error:
        raise _in_words_of_scenario(error) from None


def _in_words_of_scenario(error: InputError) -> InputError:
    """Return an error of a foundation with a scenario's key: ``pile`` is ``piles``, the rest in ``soil``."""
    first, dot, rest = (error.field or "").partition(".")
    field = f"piles{dot}{rest}" if first == "pile" else f"soil{dot}{rest}"
    if first not in ("pile", "soil"):
        field = f"soil.{error.field}"
    return InputError(
        error.problem, field=field, value=error.value, allowed=error.allowed, remedy=error.remedy
    )


def _first_frequency(structure: Structure) -> float:
    system = build_system(assemble(structure), standing(structure))
    return float(undamped_modes(system, 1).frequency_hz[0])
