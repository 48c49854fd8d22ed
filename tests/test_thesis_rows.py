"""Rows of the page on the thesis on a structure that nothing was made for: those that take no seconds.

``qualify/thesis_rows.py`` runs every row on four structures.
"""

from __future__ import annotations

from pathlib import Path

from common.thesis_case import DECKS
from common.thesis_walk import prepared, rows
from thesis_rows import CHECKS, PUBLISHED, walk

QUICK = {3, 6, 7, 12, 15, 17, 26, 30, 32, 33, 34, 35, 36, 39, 43, 44, 48, 54, 60}


def test_every_row_has_a_check_or_is_a_published_number() -> None:
    assert {row.number for row in rows()} == set(CHECKS) | PUBLISHED
    assert not set(CHECKS) & PUBLISHED


def test_rows_on_a_tower_on_a_subdyn_deck(tmp_path: Path) -> None:
    done = list(walk(prepared(DECKS / "deck_and_tower.yaml", tmp_path), QUICK))
    assert [f"{one.row.number} ({one.row.what}): {one.words}" for one in done if not one.good] == []
    assert {one.row.number for one in done} == QUICK
