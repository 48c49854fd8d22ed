"""A whole file or nothing."""

import errno
import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.files import atomic_path, write_json


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "out" / "result.json"
    write_json({"a": 1}, target)
    with pytest.raises(RuntimeError), atomic_path(target) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert json.loads(target.read_text()) == {"a": 1}
    assert [p.name for p in target.parent.iterdir()] == ["result.json"]


def test_unknown_is_null_and_never_nan(tmp_path: Path) -> None:
    data = {"x": np.array([1.0, np.nan]), "z": 1 + 2j, "n": np.int64(3), 4: (np.inf, None, True)}
    write_json(data, tmp_path / "r.json")
    text = (tmp_path / "r.json").read_text()
    assert "NaN" not in text and "Infinity" not in text
    assert json.loads(text) == {"x": [1.0, None], "z": [1.0, 2.0], "n": 3, "4": [None, None, True]}


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG])
def test_a_full_disk_names_what_was_being_written(number: int, tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    with pytest.raises(OSError, match="full") as told, atomic_path(target):
        raise OSError(number, "full")
    assert told.value.filename == str(target)
