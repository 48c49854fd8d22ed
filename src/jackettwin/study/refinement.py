"""Refinement files: known frequencies of parts of a structure, and its properties to update."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from jackettwin.decks import AdjustedPlace
from jackettwin.errors import located
from jackettwin.files import Schema, read_yaml, validate
from jackettwin.structure import Structure
from jackettwin.twin.schema import StructureOrName
from jackettwin.updating import Factor, Refinement, RefinementStage, refine

WORSE = 1e-3
"""Least growth of a mode's relative misfit that is reported; least squares trade smaller amounts."""
STEEL = ("youngs_modulus", "density")
"""Properties of parts that are ``structure.steel`` of a twin file; the others are ``structure.adjusted``."""

Positive = Annotated[float, Field(gt=0.0)]


class FreeSchema(AdjustedPlace):
    """``stages[].free[]``."""

    bounds: tuple[float, float] | None = None
    tolerance: Positive | None = None

    def factor(self) -> Factor:
        """Return it as a factor of the refinement."""
        of, name = self.place
        low, high = self.bounds or (None, None)
        return Factor(name, self.what, low, high, self.tolerance, of)


class StageSchema(Schema):
    """``stages[]``."""

    parts: list[str] = []
    frequency_hz: dict[Annotated[int, Field(ge=1, le=50)], Positive] = Field(min_length=1)
    frequency_std: Annotated[float, Field(gt=0.0, le=1.0)] = 0.005
    free: list[FreeSchema] = []


class RefinementSchema(Schema):
    """A refinement file."""

    structure: StructureOrName
    gravity: bool = True
    feet: Literal["pinned", "own"] = "pinned"
    stages: list[StageSchema] = Field(min_length=1)


@dataclass(frozen=True)
class RefinementConfig:
    """Contents of a refinement file."""

    path: Path
    structure: Structure
    stages: tuple[RefinementStage, ...]
    gravity: bool = True
    own_feet: bool = False
    given: Mapping[str, Any] = field(default_factory=dict)
    """What its ``structure`` is, in the keys of a twin's."""

    def refine(self) -> Refinement:
        """Return the structure refined by the stages.

        Raises
        ------
        InputError
            Names file, stage and field.
        """
        with located(file=self.path):
            return refine(self.structure, self.stages, gravity=self.gravity, own_feet=self.own_feet)

    def block(self, document: Mapping[str, Any]) -> dict[str, Any]:
        """Return the ``structure`` of a twin: what is given, then changed as a document says."""
        steel = {part: dict(factors) for part, factors in self.given.get("steel", {}).items()}
        for part, factors in document["steel"].items():
            own = steel.setdefault(part, {})
            own |= {what: own.get(what, 1.0) * factor for what, factor in factors.items()}
        changes = {"steel": steel, "adjusted": [*self.given.get("adjusted", ()), *document["adjusted"]]}
        return {**self.given, **{key: value for key, value in changes.items() if value}}


def read_refinement(path: Path | str) -> RefinementConfig:
    """Read a refinement file.

    Raises
    ------
    InputError
        Names file, field and value.
    """
    path = Path(path)
    schema = validate(RefinementSchema, read_yaml(path, what="refinement file"), file=path)
    with located(file=path):
        structure = schema.structure.read(path.parent)
        stages = tuple(_stage(i, s) for i, s in enumerate(schema.stages))
    given = schema.structure.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    return RefinementConfig(path, structure, stages, schema.gravity, schema.feet == "own", given)


def _stage(index: int, schema: StageSchema) -> RefinementStage:
    factors = []
    for i, free in enumerate(schema.free):
        with located(field=f"stages.{index}.free.{i}"):
            factors.append(free.factor())
    targets = dict(schema.frequency_hz)
    return RefinementStage(tuple(schema.parts), targets, tuple(factors), schema.frequency_std)


def refinement_document(result: Refinement) -> dict[str, Any]:
    """Return the document of ``jackettwin refine``.

    ``worse`` states that the stage increased a mode's misfit, ``worse_at_the_end`` that later stages did.
    """
    steel: dict[str, dict[str, float]] = {}
    adjusted = []
    for factor, value in result.changes:
        if factor.of == "part" and factor.what in STEEL:
            steel.setdefault(factor.name_of, {})[factor.what] = value
        else:
            adjusted.append({factor.of: factor.name_of, "property": factor.what, "value": value})
    return {
        "stages": [
            {
                "factors": dict(fit.factors),
                "std": {name: value if value < float("inf") else None for name, value in fit.std.items()},
                "at_bound": list(fit.at_bound),
                "modes": [
                    {
                        "mode": mode,
                        "target_hz": target,
                        "before_hz": before,
                        "after_hz": after,
                        "final_hz": last,
                        "worse": _further(after, before, target),
                        "worse_at_the_end": _further(last, after, target) and _further(last, before, target),
                    }
                    for mode, target, before, after, last in zip(
                        fit.modes,
                        fit.target_hz.tolist(),
                        fit.before_hz.tolist(),
                        fit.after_hz.tolist(),
                        final.tolist(),
                        strict=True,
                    )
                ],
            }
            for fit, final in zip(result.stages, result.final_hz, strict=True)
        ],
        "steel": steel,
        "adjusted": adjusted,
    }


def _further(after_hz: float, before_hz: float, target_hz: float) -> bool:
    return abs(after_hz / target_hz - 1.0) > abs(before_hz / target_hz - 1.0) + WORSE
