"""A structure built up part by part: the stages that thesis section 5.4 compares models at."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.arrays import FloatArray
from jackettwin.structure import Structure, assemble, check
from jackettwin.updating.steel.band import numbered_modes
from jackettwin.updating.steel.update import only_parts


@dataclass(frozen=True)
class Stage:
    """Some parts of a structure on pinned feet.

    Attributes
    ----------
    parts : names of the parts standing
    mass_kg : float
    frequency_hz : (n_modes,) undamped
    """

    parts: tuple[str, ...]
    mass_kg: float
    frequency_hz: FloatArray

    @property
    def name(self) -> str:
        """``jacket``, then ``+ transition_piece`` and so on: the part added last."""
        last = self.parts[-1] or "members of no named part"
        if len(self.parts) > 1:
            return f"+ {last}"
        return self.parts[0] or "whole structure"


def stages(structure: Structure, number: int, *, gravity: bool = False) -> tuple[Stage, ...]:
    """Return a stage for every part, in the order the structure names them; the last is the whole.

    Raises
    ------
    InputError
        If the first part does not stand on its own: parts must be named from the ground upwards.
    """
    # what stands on beams other than tubes alone has no parts, and is one stage
    parts = tuple(dict.fromkeys(member.part for member in structure.members)) or ("",)
    found = []
    for k in range(1, len(parts) + 1):
        # the whole keeps what no member holds, rigid links' ends among them
        standing = structure if k == len(parts) else only_parts(structure, parts[:k])
        assembly = assemble(standing, gravity=gravity)
        found.append(Stage(parts[:k], check(assembly).mass_kg, numbered_modes(assembly, number).frequency_hz))
    return tuple(found)
