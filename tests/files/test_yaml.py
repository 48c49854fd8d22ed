"""YAML as engineers write it."""

from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.files import read_mapping, read_yaml


def read(folder: Path, text: str) -> dict:
    (folder / "f.yaml").write_text(text)
    return read_yaml(folder / "f.yaml")


def test_numbers_with_exponents_are_numbers(tmp_path: Path) -> None:
    data = read(tmp_path, "a: 2.5e9\nb: 1E3\nc: 3\nd: -1.5e-3\ne: 1_000.5\nf: 2024-01-02x\ng: .5\n")
    assert data == {"a": 2.5e9, "b": 1e3, "c": 3, "d": -1.5e-3, "e": 1000.5, "f": "2024-01-02x", "g": 0.5}
    assert isinstance(data["c"], int)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\na: 2\n", "line 2, column 1: key 'a' is given twice"),
        ("x: {b: 1, b: 2}\n", "key 'b' is given twice"),
        ("x: {t: 0,018}\n", "line 1, column .*decimal comma. write 0.018"),
        ("a: [1, 2\n", "line"),
        ("- 1\n", "must be a mapping"),
        ("", "is empty; start from an example"),
        ("# to be written\n", "is empty"),
        ("a: !!python/object:os.system {}\n", "could not determine a constructor"),
        ("? [1, 2]\n: 3\n", "key is not a word"),
        ("a: " + "[" * 3000 + "]" * 3000, "nested too deeply"),
        ("a: " + "[" * 300_000 + "]" * 300_000, "nested too deeply"),
    ],
)
def test_what_is_no_mapping_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(tmp_path, text)


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
def test_a_list_alone_is_the_value_of_its_key_where_there_is_one(tmp_path: Path, suffix: str) -> None:
    """The page on `--picks` shows a list, which was refused as no mapping."""
    path = tmp_path / f"picks{suffix}"
    path.write_text('[{"order": 35, "frequency_hz": 0.33}]')
    assert read_mapping(path, list_of="picks") == {"picks": [{"order": 35, "frequency_hz": 0.33}]}
    with pytest.raises(InputError, match="must be a mapping"):
        read_mapping(path)
