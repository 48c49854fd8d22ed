"""Parts of a structure that no check covers, listed so that nothing is left out silently."""

from __future__ import annotations

from collections import defaultdict

from jackettwin.caveats import OUT_OF_SCOPE, Omission
from jackettwin.structure import PILES, Structure, few

_CLAUSES = (
    Omission(
        "stubs of braces; critical joints are not named: `to_brace` is theirs to meet", "ISO 19902 14.3-13"
    ),
    Omission("overlapping, grouted and ring-stiffened joints", "ISO 19902 14.4 to 14.6"),
    Omission("members: ring stiffeners", "ISO 19902 13.2.6"),
    Omission("members: junctions of cones", "ISO 19902 13.6"),
    Omission("dented, corroded and grouted members", "ISO 19902 13.7 to 13.9"),
    Omission("partial action factors: actions as given; --combinations FILE factors them", "ISO 19902 9"),
    *OUT_OF_SCOPE,
)
"""Clauses that no structure is checked for."""


def left_out(structure: Structure) -> tuple[Omission, ...]:
    """Return each kind of thing that the checks of members and joints leave out."""
    by_shape: dict[str, list[str]] = defaultdict(list)
    for beam in structure.beams:
        by_shape[beam.shape].append(beam.name)
    found = [
        Omission(
            f"{few(names)} ({shape}): ISO 19902 checks tubes; check these and their joints by their own code"
        )
        for shape, names in by_shape.items()
    ]
    others = [element.name for element in structure.elements if element.kind in ("cable", "spring")]
    if others:
        found.append(Omission(f"{few(others)}: cables and springs have no check"))
    if any(member.part == PILES for member in structure.members):
        found.append(Omission("the ground's capacity: `jackettwin soil` has it", "ISO 19902 17"))
        found.append(Omission("joints of piles with legs or sleeves", "ISO 19902 15.1"))
    return (*found, *_CLAUSES)
