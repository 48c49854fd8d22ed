"""The structure of a twin as matrices."""

from __future__ import annotations

from dataclasses import replace

from jackettwin.structure import Assembly, assemble
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.water import moving_mass


def assembled(config: TwinConfig) -> Assembly:
    """Return the assembled structure of a twin, with the water that moves with it."""
    assembly = assemble(
        config.structure,
        beam_theory=config.beam,
        rotary_inertia=config.rotary_inertia,
        subdivide=config.subdivide,
        gravity=config.gravity,
    )
    if config.water is None or not config.water.adds_mass:
        return assembly
    return replace(assembly, mass=assembly.mass + moving_mass(config.water, assembly).tocsc())
