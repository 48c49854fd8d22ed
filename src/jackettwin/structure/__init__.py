"""Steel: geometry to matrices."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.structure.assemble import Assembly, assemble
    from jackettwin.structure.check import ModelCheck, check
    from jackettwin.structure.damping import Rayleigh
    from jackettwin.structure.files import read_structure, shipped_structures
    from jackettwin.structure.jacket import jacket
    from jackettwin.structure.model import Material, Section, Structure

__all__ = [
    "Assembly",
    "Material",
    "ModelCheck",
    "Rayleigh",
    "Section",
    "Structure",
    "assemble",
    "check",
    "jacket",
    "read_structure",
    "shipped_structures",
]

door(
    __name__,
    {
        "assemble": "Assembly assemble",
        "check": "ModelCheck check",
        "damping": "Rayleigh",
        "files": "read_structure shipped_structures",
        "jacket": "jacket",
        "model": "Material Section Structure",
    },
)
