"""Shipped names and paths."""

from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.files import find_file, shipped


@pytest.mark.parametrize("kind", ["structures", "twins", "foundations", "rotors"])
def test_every_shipped_name_is_a_file(kind: str) -> None:
    assert shipped(kind)
    assert all(find_file(name, kind).is_file() for name in shipped(kind))


def test_a_path_is_relative_to_the_folder_it_is_named_in(tmp_path: Path) -> None:
    assert find_file("a.yaml", "structures", folder=tmp_path) == tmp_path / "a.yaml"


def test_a_near_miss_is_suggested() -> None:
    with pytest.raises(InputError, match="no such structure .got 'jacket51'.*did you mean 'jacket15'"):
        find_file("jacket51", "structures")
