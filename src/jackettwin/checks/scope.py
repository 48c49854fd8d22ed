"""What of a structure no check covers, said and not left out silently."""

from __future__ import annotations

from collections import defaultdict

from jackettwin.structure import PILES, Structure, few

_CLAUSES = (
    "joints: cans shorter than ISO 19902 14.2 asks, strength relative to the braces (14.3-13), overlapping "
    "(14.4), grouted (14.5) and ring-stiffened (14.6) joints",
    "members: ring stiffeners (13.2.6), junctions of cones (13.6), dented, corroded and grouted members "
    "(13.7 to 13.9), grouted connections (15.1)",
    "actions are taken as given: partial action factors and combinations are the user's (9)",
    "ice (ISO 19906) and earthquakes (ISO 19901-2) are out of scope",
)
"""What no structure is checked for."""


def left_out(structure: Structure) -> tuple[str, ...]:
    """Return a sentence for each kind of thing that the checks of members and joints leave out."""
    by_shape: dict[str, list[str]] = defaultdict(list)
    for beam in structure.beams:
        by_shape[beam.shape].append(beam.name)
    found = [
        f"{few(names)} ({shape}): ISO 19902 checks tubes; check them, and joints with them, by their own code"
        for shape, names in by_shape.items()
    ]
    others = [element.name for element in structure.elements if element.kind in ("cable", "spring")]
    if others:
        found.append(f"{few(others)}: cables and springs have no check")
    if any(member.part == PILES for member in structure.members):
        found.append(
            "joints of piles with legs or sleeves, and the ground's capacity: `jackettwin soil` has it"
        )
    return (*found, *_CLAUSES)
