"""Changes that a file makes to the structure it names: factors on steel, walls, masses and springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.errors import located, look_up, require
from jackettwin.files import Schema
from jackettwin.structure import PROPERTIES, Structure, adjusted

Positive = Annotated[float, Field(gt=0.0)]


class SteelSchema(Schema):
    """Factors on the stiffness (E and G) and the density of a part."""

    youngs_modulus: Positive = 1.0
    density: Positive = 1.0


class AdjustedPlace(Schema):
    """Which property of a part, of the bodies on a node (``rna``), of a spring or a foot (``all``)."""

    part: str | None = None
    body: str | None = None
    spring: str | None = None
    foot: str | None = None
    what: str = Field(alias="property")

    @property
    def place(self) -> tuple[Literal["part", "body", "spring", "foot"], str]:
        """The object that is changed, and its name.

        Raises
        ------
        InputError
            If none or several are named, or there is no such property of it.
        """
        kinds: tuple[Literal["part", "body", "spring", "foot"], ...] = ("part", "body", "spring", "foot")
        given = [(of, str(getattr(self, of))) for of in kinds if getattr(self, of) is not None]
        require(
            len(given) == 1,
            "names none or several of part, body, spring and foot",
            value=[of for of, _ in given],
            allowed="one of them",
            remedy="e.g. {part: jacket, property: density}",
        )
        # the mass of a part is what people write who mean that of the nacelle
        others = [of for of in kinds if self.what in PROPERTIES[of]]
        remedy = f"it is one of a {others[0]}: {{{others[0]}: …, property: {self.what}}}" if others else None
        look_up(PROPERTIES[given[0][0]], self.what, "property", field="property", remedy=remedy)
        return given[0]


class AdjustedSchema(AdjustedPlace):
    """``structure.adjusted[]``: the factor on a property, or what is added to it."""

    value: float


def changed_structure(
    structure: Structure, steel: Mapping[str, SteelSchema], changes: Sequence[AdjustedSchema]
) -> Structure:
    """Return a structure with the changes that a file gives under ``structure``.

    Raises
    ------
    InputError
        Names the change and what it lacks.
    """
    for part, factors in steel.items():
        with located(field="structure.steel"):
            structure = structure.with_material(part, **factors.model_dump())
    for i, change in enumerate(changes):
        with located(field=f"structure.adjusted.{i}"):
            structure = adjusted(structure, *change.place, change.what, change.value)
    return structure
