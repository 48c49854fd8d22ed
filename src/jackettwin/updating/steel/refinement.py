"""The staged refinement of the steel: part by part, from the jacket alone to the full structure (5.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from jackettwin.errors import located
from jackettwin.structure import Structure
from jackettwin.updating.steel.update import Factor, SteelFit, fit_steel, only_parts


@dataclass(frozen=True)
class RefinementStage:
    """One stage: some parts on pinned feet, their measured frequencies and what may change.

    Attributes
    ----------
    parts : tuple of str
        Empty for the whole structure.
    target_hz : mapping of mode number to frequency
    factors : tuple of Factor
        Empty for a stage that only compares.
    """

    parts: tuple[str, ...]
    target_hz: Mapping[int, float]
    factors: tuple[Factor, ...]


@dataclass(frozen=True)
class Refinement:
    """The refined structure and what each stage did.

    Attributes
    ----------
    factors : mapping of part to property to the product of all stages' factors
    """

    structure: Structure
    stages: tuple[SteelFit, ...]
    factors: Mapping[str, Mapping[str, float]]


def refine(structure: Structure, stages: tuple[RefinementStage, ...]) -> Refinement:
    """Fit stage after stage; each starts from what the earlier ones found.

    Raises
    ------
    InputError
        If a stage names an unknown part or has more factors than frequencies; the field says which stage.
    """
    fits: list[SteelFit] = []
    factors: dict[str, dict[str, float]] = {}
    for i, stage in enumerate(stages):
        with located(field=f"stages.{i}"):
            standing = only_parts(structure, stage.parts) if stage.parts else structure
            fit = fit_steel(standing, stage.factors, stage.target_hz)
        for factor in stage.factors:
            value = fit.factors[factor.name]
            structure = structure.with_material(factor.part, **{factor.what: value})
            part = factors.setdefault(factor.part, {})
            part[factor.what] = part.get(factor.what, 1.0) * value
        fits.append(fit)
    return Refinement(structure, tuple(fits), factors)
