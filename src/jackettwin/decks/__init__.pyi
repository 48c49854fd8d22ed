from .blade_files import read_flexible_rotor as read_flexible_rotor, windio_blade as windio_blade
from .formats import (
    StructureChoice as StructureChoice,
    read_structure as read_structure,
    shipped_structures as shipped_structures,
)
from .mode_tables import NodalModes as NodalModes, read_modes as read_modes, write_modes as write_modes
from .openfast import Deck as Deck, DeckRow as DeckRow, read_deck as read_deck, to_float as to_float
from .sacs import is_sacs as is_sacs, sacs_remarks as sacs_remarks
from .structure_changes import AdjustedPlace as AdjustedPlace
from .structure_yaml import RnaSchema as RnaSchema
from .subdyn import DeckDamping as DeckDamping, read_deck_damping as read_deck_damping
from .subdyn_outputs import (
    SECTION_CHANNELS as SECTION_CHANNELS,
    MemberOutput as MemberOutput,
    member_outputs as member_outputs,
)
from .subdyn_writer import write_subdyn as write_subdyn
