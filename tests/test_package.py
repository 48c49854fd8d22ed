"""What ``pip install`` takes along."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "jackettwin"


def test_every_data_file_is_installed() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    taken = {path for pattern in settings["package-data"]["jackettwin"] for path in PACKAGE.glob(pattern)}
    there = {p for p in PACKAGE.rglob("*.*") if p.suffix != ".py" and "__pycache__" not in p.parts}
    assert there - taken == set()


def test_lock_files_name_no_registry() -> None:
    for name in ("requirements.lock", "requirements-dev.lock"):
        text = (ROOT / name).read_text()
        assert "://" not in text and "--index" not in text
