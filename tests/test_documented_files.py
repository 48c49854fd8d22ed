"""The files that the reference pages show can be read as they stand, and what pages import exists."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

from jackettwin.decks import read_structure
from jackettwin.identification import IdentificationSettings
from jackettwin.response.modes.labels import mode_kinds
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.support import pinned
from jackettwin.structure import assemble

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "structure.md"
EXAMPLE = Path(__file__).parents[1] / "examples" / "three_leg_jacket.yaml"
FILES = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(), re.DOTALL)


def test_the_page_shows_both_forms() -> None:
    assert len(FILES) == 2


@pytest.mark.parametrize("text", FILES, ids=["parametric", "node by node"])
def test_a_structure_as_documented_stands_up(text: str, tmp_path: Path) -> None:
    path = tmp_path / "structure.yaml"
    path.write_text(text)
    structure = read_structure(path)
    assembly = assemble(structure)
    modes = undamped_modes(build_system(assembly, pinned(structure)), 2)
    assert set(mode_kinds(assembly, modes.shapes, modes.frequency_hz)) == {"fore_aft", "side_side"}
    assert (modes.frequency_hz > 0.1).all() and (modes.frequency_hz < 2.0).all()


def test_the_parametric_one_is_the_example(tmp_path: Path) -> None:
    path = tmp_path / "three_leg_jacket.yaml"
    path.write_text(FILES[0])
    assert read_structure(path) == read_structure(EXAMPLE)


def test_every_setting_of_an_identification_is_documented() -> None:
    section = (PAGE.parent / "identify.md").read_text().split("## Settings")[1]
    documented = set(
        re.findall(r"`(\w+)`", "".join(row.split("|")[1] for row in section.splitlines() if "|" in row))
    )
    assert documented - {"picks"} == set(IdentificationSettings.model_fields)


def test_every_python_file_that_a_page_names_exists() -> None:
    root = PAGE.parents[2]
    folders = ("src", "tests", "qualify", "benchmarks", "examples", "scripts")
    there = [path.as_posix() for folder in folders for path in (root / folder).rglob("*.py")]
    for page in (root / "docs").rglob("*.md"):
        for name in re.findall(r"`(?:python )?([a-z_/0-9]+\.py)\b", page.read_text(encoding="utf-8")):
            assert any(f"/{path}".endswith(f"/{name}") for path in there), f"{page.name}: {name}"


@pytest.mark.parametrize(
    "page", sorted((PAGE.parents[2]).glob("docs/[!d]*/*.md")), ids=lambda page: page.stem
)
def test_what_a_page_imports_exists(page: Path) -> None:
    """One imported ``run_twin`` from the package that it had left months before; designs are sketches."""
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    for node in (node for block in blocks for node in ast.walk(ast.parse(block))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("jackettwin"):
            package = import_module(node.module or "")
            assert [one.name for one in node.names if not hasattr(package, one.name)] == []


def test_every_page_is_in_the_contents() -> None:
    docs = PAGE.parents[1]
    listed = set(re.findall(r"(\S+\.md)$", (docs.parent / "mkdocs.yml").read_text(), re.MULTILINE))
    assert listed == {page.relative_to(docs).as_posix() for page in docs.rglob("*.md")}


def test_every_page_of_theory_begins_with_its_question_an_equation_and_a_picture() -> None:
    for page in (PAGE.parents[1] / "theory").glob("*.md"):
        question, *rest = page.read_text(encoding="utf-8").split("\n\n")[1:6]
        assert re.fullmatch(r"\*[^*]+\?\*", question), page.name
        assert any(part.startswith("$$") for part in rest), page.name
        assert any(part.startswith("![") for part in rest), page.name


CAMPAIGNS = Path(__file__).parents[1] / "qualify"


def test_every_campaign_has_a_command_line() -> None:
    """One without took ``--help`` for the name of a folder, or for nothing, and ran for hours."""
    scripts = [path.read_text("utf-8") for path in CAMPAIGNS.glob("*.py")]
    assert len(scripts) > 40
    run = [text for text in scripts if 'if __name__ == "__main__"' in text]
    assert all("arguments(__doc__" in text or "ArgumentParser(" in text for text in run)


def test_a_campaign_takes_values_by_place(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.syspath_prepend(str(CAMPAIGNS))
    arguments = import_module("common.command").arguments
    usual = {"number": 4, "folder": None, "winds": (4.0, 8.0), "make": False}
    monkeypatch.setattr("sys.argv", ["campaign"])
    assert vars(arguments("What.", **usual)) == usual
    monkeypatch.setattr("sys.argv", ["campaign", "7", "out", "12", "--make"])
    assert vars(arguments("What.", **usual)) == {
        "number": 7,
        "folder": Path("out"),
        "winds": [12.0],
        "make": True,
    }
    monkeypatch.setattr("sys.argv", ["campaign", "--help"])
    with pytest.raises(SystemExit, match="0"):
        arguments("What.", **usual)
    assert "What." in capsys.readouterr().out


def test_no_page_links_to_what_the_site_does_not_have() -> None:
    docs = PAGE.parents[1]
    for page in docs.rglob("*.md"):
        for link in re.findall(r"\]\((?!\w+:|#)([^)#\s]+)", page.read_text(encoding="utf-8")):
            target = (page.parent / link).resolve()
            assert target.exists() and target.is_relative_to(docs.resolve()), f"{page.name}: {link}"
