"""Every fault that ``qualify/mutations.py`` plants finds its place; the campaign takes an hour."""

from __future__ import annotations

from pathlib import Path

import pytest
from common.planted_faults import FAULTS, Fault
from mutations import BAR, PACKAGE, ROOT, home


def test_there_are_enough_of_them_in_every_room() -> None:
    assert len(FAULTS) >= 80 and BAR >= 0.92
    rooms = {path.parent.name for path in (ROOT / PACKAGE).glob("*/__init__.pyi")}
    # what only offers or moves numbers has none of its own to get wrong
    assert rooms - {f.room for f in FAULTS} <= {"decks", "files", "oma", "client"}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f"{f.room}: {f.what}")
def test_its_text_stands_once_in_its_room(fault: Fault) -> None:
    place = home(fault, ROOT / PACKAGE)
    changed = place.read_text("utf-8").replace(fault.text, fault.becomes)
    compile(changed, place.name, "exec")
    assert fault.text != fault.becomes and all(Path(ROOT / test).exists() for test in fault.tests)
