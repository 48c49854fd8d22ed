"""Draft of a twin from a structure and a record that a client sent."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jackettwin.errors import InputError, located


def draft(structure: str, record: str, most_freedoms: int, memory_bytes: int) -> Any:
    """Return a drafted twin as plain data, or the problem with what was sent.

    Parameters
    ----------
    structure, record : paths, each in a folder of its own
    """
    from jackettwin.decks import read_structure
    from jackettwin.files import null_for_nan
    from jackettwin.records import FileDefaults, read_record
    from jackettwin.report import View, thickness_quantities, view_document
    from jackettwin.service.workers.engine import check_freedoms
    from jackettwin.service.workers.file_access import only_files_in
    from jackettwin.service.workers.memory import at_most
    from jackettwin.study.draft import assembled_as_stated, draft_twin
    from jackettwin.twin import model_of_records

    deck, name = Path(structure), Path(record).name
    try:
        with at_most(memory_bytes):
            with only_files_in(Path(record).parent), located(file=name):
                read, stated = read_record(Path(record)), model_of_records([Path(record)])
            with only_files_in(deck.parent), located(file=deck.name):
                built = read_structure(deck)
                check_freedoms(built, stated.get("subdivide"), most_freedoms)
                assembly = assembled_as_stated(built, stated)
            found = draft_twin(deck.name, assembly, [(name, read)], FileDefaults(), listed=False)
            placed = tuple(place.sensor for place in found.places if not place.lacks)
            drawn = view_document(View(assembly, thickness_quantities(assembly), (), placed))
            return {
                "structure": deck.name,
                "twin": found.text,
                "places": [
                    {
                        "channel": place.sensor.channel,
                        "why": place.why or "as the record states it",
                        "lacks": place.lacks,
                    }
                    for place in found.places
                ],
                "missing": list(found.missing),
                "drawn": null_for_nan(drawn),
            }
    except InputError as error:
        if error.file is not None:
            error.file = Path(error.file).name  # not the server's path
        return error
    except (MemoryError, RecursionError):
        return InputError(
            "evaluating them takes more memory than a worker has",
            field="structure",
            remedy="send a smaller model, or a shorter record",
        )
