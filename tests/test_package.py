"""What ``pip install`` takes along."""

import re
import tomllib
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

from packaging.specifiers import SpecifierSet

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


def test_locked_packages_run_on_the_oldest_python_that_is_promised() -> None:
    """A lock made with Python 3.11.7 took a package that asks for 3.11.5; Debian 12 has 3.11.2."""
    oldest = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    oldest = oldest.removeprefix(">=") + ".0"
    too_new, seen = {}, 0
    for name in re.findall(r"^([\w.-]+)==", (ROOT / "requirements-dev.lock").read_text(), re.MULTILINE):
        try:
            stated = metadata(name)
        except PackageNotFoundError:  # of another platform
            continue
        seen += 1
        asked = stated["Requires-Python"] if "Requires-Python" in stated else ""
        if oldest not in SpecifierSet(asked):
            too_new[name] = asked
    assert seen > 100 and too_new == {}
