"""Refinement files: which frequencies are known of which parts, and which steel may change."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from jackettwin.errors import located
from jackettwin.files import Schema, read_yaml, validate
from jackettwin.structure import Structure
from jackettwin.twin.schema import StructureOrName
from jackettwin.updating import Factor, Refinement, RefinementStage

WORSE = 1e-3
"""Relative misfit by which a mode must be met worse than before to be named: least squares trade less."""

Positive = Annotated[float, Field(gt=0.0)]


class FactorSchema(Schema):
    """``stages[].free[]``."""

    part: str
    property: Literal["youngs_modulus", "density"]
    bounds: tuple[Positive, Positive] = (0.1, 10.0)


class StageSchema(Schema):
    """``stages[]``."""

    parts: list[str] = []
    frequency_hz: dict[Annotated[int, Field(ge=1, le=50)], Positive] = Field(min_length=1)
    free: list[FactorSchema] = []


class RefinementSchema(Schema):
    """A refinement file."""

    structure: StructureOrName
    stages: list[StageSchema] = Field(min_length=1)


@dataclass(frozen=True)
class RefinementConfig:
    """What a refinement file says."""

    path: Path
    structure: Structure
    stages: tuple[RefinementStage, ...]


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
        structure = schema.structure.build(path.parent)
        return RefinementConfig(path, structure, tuple(_stage(i, s) for i, s in enumerate(schema.stages)))


def _stage(index: int, schema: StageSchema) -> RefinementStage:
    with located(field=f"stages.{index}.free"):
        factors = tuple(Factor(f.part, f.property, *f.bounds) for f in schema.free)
    return RefinementStage(tuple(schema.parts), dict(schema.frequency_hz), factors)


def refinement_document(result: Refinement) -> dict[str, Any]:
    """Return the document of ``jackettwin refine``."""
    return {
        "stages": [
            {
                "factors": dict(fit.factors),
                "modes": [
                    {
                        "mode": mode,
                        "target_hz": target,
                        "before_hz": before,
                        "after_hz": after,
                        "worse": abs(after / target - 1.0) > abs(before / target - 1.0) + WORSE,
                    }
                    for mode, target, before, after in zip(
                        fit.modes,
                        fit.target_hz.tolist(),
                        fit.before_hz.tolist(),
                        fit.after_hz.tolist(),
                        strict=True,
                    )
                ],
            }
            for fit in result.stages
        ],
        "steel": {part: dict(values) for part, values in result.factors.items()},
    }
