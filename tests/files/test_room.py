"""Places that cannot be written to are refused before the work."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.files import atomic_folder, atomic_path, check_room


def test_room_in_a_folder_yet_to_be_made(tmp_path: Path) -> None:
    check_room(tmp_path / "new" / "deep" / "report.html", least_bytes=1)
    assert not (tmp_path / "new").exists()


def test_a_file_in_the_way_and_a_full_disk_are_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="is a file, not a folder"):
        check_room(tmp_path / "file" / "out")
    with pytest.raises(InputError, match="no space left") as refused:
        check_room(tmp_path / "out", least_bytes=10**18)
    assert refused.value.file == tmp_path / "out"


@pytest.mark.parametrize("writer", [atomic_path, atomic_folder])
def test_a_disk_that_fills_up_meanwhile_names_what_was_written(writer, tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space left") as full, writer(tmp_path / "result"):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert full.value.filename == str(tmp_path / "result")
    assert list(tmp_path.iterdir()) == []
