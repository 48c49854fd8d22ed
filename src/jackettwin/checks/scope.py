"""What of a structure no check covers, said and not left out silently."""

from __future__ import annotations

from collections import defaultdict

from jackettwin.structure import PILES, Structure, few


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
    return tuple(found)
