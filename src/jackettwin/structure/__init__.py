"""Steel: geometry to matrices."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.structure.assemble import Assembly as Assembly, assemble as assemble
    from jackettwin.structure.check import ModelCheck as ModelCheck, check as check
    from jackettwin.structure.damping import Rayleigh as Rayleigh
    from jackettwin.structure.files import (
        read_structure as read_structure,
        shipped_structures as shipped_structures,
    )
    from jackettwin.structure.jacket import jacket as jacket
    from jackettwin.structure.model import Material as Material, Section as Section, Structure as Structure

door(__name__)
