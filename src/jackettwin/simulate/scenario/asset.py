"""The asset of a scenario file: structure, ground, damping."""

from __future__ import annotations

from pathlib import Path

from jackettwin.decks import read_structure
from jackettwin.errors import InputError, located
from jackettwin.response import build_system, undamped_modes
from jackettwin.simulate.scenario.scenario import Asset
from jackettwin.simulate.scenario.schema import ScenarioSchema
from jackettwin.soil import read_support
from jackettwin.soil.foundation import Foundation, FoundationSchema, SoilSchema, read_foundation
from jackettwin.soil.support import standing
from jackettwin.structure import Rayleigh, Structure, assemble


def build_asset(schema: ScenarioSchema, folder: Path) -> Asset:
    """Return the asset; relative paths are relative to ``folder``.

    Raises
    ------
    InputError
        If a part is missing, given twice, or wrong.
    """
    structure, foundation = _structure(schema, folder), _foundation(schema, folder)
    loops = schema.soil is not None and schema.soil.hysteresis
    if loops and foundation is not None:
        with located(field="soil"):
            foundation.cyclic()
    if foundation is not None:
        structure, support = foundation.lumped(structure)
    else:
        support = read_support(
            schema.support, structure, first_frequency_hz=lambda: _first_frequency(structure), folder=folder
        )
    steel = schema.damping.rayleigh
    return Asset(
        structure=structure,
        support=support,
        beam=schema.beam,
        rotary_inertia=schema.rotary_inertia,
        subdivide=schema.subdivide,
        gravity=schema.gravity,
        rayleigh=Rayleigh() if steel is None else Rayleigh.minimum(steel.ratio, steel.frequency_hz),
        support_text=schema.support,
        coupled_damping=schema.damping.coupled,
        foundation=foundation if loops else None,
    )


def _structure(schema: ScenarioSchema, folder: Path) -> Structure:
    choice = schema.structure
    structure = read_structure(choice if isinstance(choice, str) else choice.source, folder=folder)
    rna = schema.rna or (None if isinstance(choice, str) else choice.rna)
    return structure if rna is None else rna.stand_on(structure, folder=folder)


def _foundation(schema: ScenarioSchema, folder: Path) -> Foundation | None:
    given = [key for key in ("soil", "foundation", "support") if getattr(schema, key) is not None]
    if len(given) > 1:
        raise InputError("the ground is given twice", field=", ".join(given), remedy="keep one of them")
    if schema.foundation is not None:
        name = schema.foundation
        return read_foundation(folder / name if Path(name).suffix else name)
    if (schema.soil is None) != (schema.piles is None):
        raise InputError(
            "soil and piles go together",
            field="piles" if schema.piles is None else "soil",
            remedy="give both, or foundation, or support",
        )
    if schema.soil is None or schema.piles is None:
        return None
    ground = schema.soil
    whole = FoundationSchema(
        pile=schema.piles,
        soil=SoilSchema(layers=ground.layers, linear=ground.linear),
        scour=ground.scour,
        curves=ground.curves,
        damping=ground.damping,
        law=ground.law,
        radiation=ground.radiation,
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
