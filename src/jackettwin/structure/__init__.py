"""Steel: geometry to matrices."""

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
