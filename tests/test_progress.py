"""Nothing below the command line prints; long work tells how far it is, and ends when it is not wanted."""

import ast
from pathlib import Path

import numpy as np
import pytest

import jackettwin
from jackettwin.decks import read_structure
from jackettwin.progress import CallbackProgress, Cancelled
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Problem, Residuals, Target, single, support_model, update
from jackettwin.updating.posterior.smc import sample_posterior
from jackettwin.updating.search.solutions import search

PACKAGE = Path(jackettwin.__file__).parent
AT_THE_EDGE = {"cli", "__main__.py"}


def speech(tree: ast.AST) -> list[int]:
    """Return the lines that print, or write to a standard stream."""
    lines = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
            lines.append(node.lineno)
        if isinstance(node, ast.Attribute) and node.attr in ("stdout", "stderr"):
            if isinstance(node.value, ast.Name) and node.value.id == "sys":
                lines.append(node.lineno)
    return lines


def test_nothing_below_the_command_line_prints() -> None:
    assert speech(ast.parse("import sys\nprint(1)\nsys.stderr.write('')")) == [2, 3]
    found = {
        str(file.relative_to(PACKAGE)): lines
        for file in PACKAGE.rglob("*.py")
        if file.relative_to(PACKAGE).parts[0] not in AT_THE_EDGE
        and (lines := speech(ast.parse(file.read_text(encoding="utf-8"))))
    }
    assert found == {}


@pytest.fixture(scope="module")
def problem() -> Problem:
    """The first frequency of a small jacket on Kelvin–Voigt feet."""
    assembly = assemble(read_structure("jacket15"))
    model = support_model(assembly, family=family("kelvin-voigt"), rayleigh=Rayleigh.minimum(0.0055, 0.1832))
    f = 0.99 * model.reference_hz
    return single(model, Residuals((Target(1, f, 1e-3 * f, 0.01, 0.001),), relative=False))


def counting(most: int) -> tuple[list[str], CallbackProgress]:
    """Return what is told, and a progress that ends the work after so many words."""
    heard: list[str] = []

    def hear(what: str) -> None:
        heard.append(what)
        if len(heard) >= most:
            raise Cancelled("not wanted any more")

    return heard, CallbackProgress(hear, hear)


def test_a_search_that_is_not_wanted_ends_at_its_next_start(problem: Problem) -> None:
    heard, progress = counting(3)
    with pytest.raises(Cancelled):
        search(problem, starts=8, progress=progress)
    assert [words.split(" of ")[0] for words in heard] == ["1", "2", "3"]


def test_a_posterior_that_is_not_wanted_ends_within_its_ladder(problem: Problem) -> None:
    heard, progress = counting(5)
    with pytest.raises(Cancelled):
        sample_posterior(problem, particles=24, islands=2, progress=progress)
    assert len(heard) == 5
    assert all("island 1 of 2" in words for words in heard)


def test_who_listens_changes_nothing(problem: Problem) -> None:
    heard: list[str] = []
    told = update(
        problem, starts=4, particles=20, sampled=False, progress=CallbackProgress(inside=heard.append)
    )
    silent = update(problem, starts=4, particles=20, sampled=False)
    np.testing.assert_array_equal(told.best.theta, silent.best.theta)
    assert any("starts" in words for words in heard)
