"""Entry points of installed packages: distributions as pip leaves them, on the path of a test."""

from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.plugins import plugins, plugins_of_type


def install(site: Path, package: str, entries: str, code: str = "") -> None:
    info = site / f"{package}-1.0.dist-info"
    info.mkdir(parents=True)
    (site / f"{package}.py").write_text(code)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(entries)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(tmp_path)
    plugins.cache_clear()
    return tmp_path


def test_entries_are_found_by_name(site: Path) -> None:
    install(site, "of_one", "[jackettwin.test]\none = of_one:ONE\ntwo = of_one:TWO\n", "ONE, TWO = 1, 2\n")
    assert plugins("jackettwin.test") == {"one": 1, "two": 2}
    assert plugins_of_type("jackettwin.test", int) == {"one": 1, "two": 2}
    assert plugins("jackettwin.other") == {}


def test_what_cannot_be_loaded_names_package_and_entry_point(site: Path) -> None:
    install(site, "broken", "[jackettwin.test]\nodd = broken:ODD\n", "raise OSError('no licence')\n")
    with pytest.raises(InputError, match="test: odd: cannot be loaded from package broken .*no licence"):
        plugins("jackettwin.test")


def test_one_name_of_two_packages_is_refused(site: Path) -> None:
    install(site, "first_one", "[jackettwin.test]\none = first_one:ONE\n", "ONE = 1\n")
    install(site, "second_one", "[jackettwin.test]\none = second_one:ONE\n", "ONE = 2\n")
    with pytest.raises(InputError, match=r"(first_one|second_one) and (first_one|second_one).*uninstall"):
        plugins("jackettwin.test")


def test_an_entry_of_another_type_is_refused(site: Path) -> None:
    install(site, "wrong_one", "[jackettwin.test]\none = wrong_one:ONE\n", "ONE = 'one'\n")
    with pytest.raises(InputError, match=r"test: one: is of the wrong type \(got 'one'\).*builtins.int"):
        plugins_of_type("jackettwin.test", int)
