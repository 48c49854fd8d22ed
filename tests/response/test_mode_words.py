"""Names of modes as consultants write them."""

from __future__ import annotations

import pytest

from jackettwin.errors import InputError
from jackettwin.response.modes.labels import read_mode_label


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("fore_aft_1", "fore_aft_1"),
        ("1st FA", "fore_aft_1"),
        ("FA 2", "fore_aft_2"),
        ("SS1", "side_side_1"),
        ("2nd Side-Side bending", "side_side_2"),
        ("3rd fore-aft", "fore_aft_3"),
        ("2. SS mode", "side_side_2"),
        ("StS_2", "side_side_2"),
        ("torsion", "torsion_1"),
        ("1st Torsional", "torsion_1"),
        ("T1", "torsion_1"),
        ("heave", "heave_1"),
    ],
)
def test_names(text: str, label: str) -> None:
    assert read_mode_label(text) == label


@pytest.mark.parametrize("text", ["", "1", "bending", "FA SS 1", "fast 1", "FA1b", "1st 2nd FA"])
def test_what_names_no_mode(text: str) -> None:
    with pytest.raises(InputError, match="is not the name of a mode"):
        read_mode_label(text)
