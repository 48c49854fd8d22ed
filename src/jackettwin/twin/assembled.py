"""The structure of a twin as matrices."""

from __future__ import annotations

from jackettwin.structure import Assembly, assemble
from jackettwin.twin.config import TwinConfig


def assembled(config: TwinConfig) -> Assembly:
    """Return the assembled structure of a twin."""
    return assemble(
        config.structure,
        beam_theory=config.beam,
        rotary_inertia=config.rotary_inertia,
        subdivide=config.subdivide,
        gravity=config.gravity,
    )
