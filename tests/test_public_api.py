"""The names users may rely on; a change here is a change of the public interface."""

import pkgutil
import re
import subprocess
import sys
from importlib import import_module
from inspect import isfunction
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import jackettwin

PACKAGES = {
    "records": "Channel Record assess decimate detrend read_record repair write_record",
    "report": "PageSection Plot Table TableColumn Text build_report",
    "decks": "read_structure shipped_structures",
    "structure": "Assembly Material Rayleigh Section Structure assemble check jacket",
}
OF_OTHERS = {"None", "Any", "Path", "DataFrame", "DataArray"}
"""What public functions return that is documented elsewhere."""


@pytest.mark.parametrize("name", jackettwin.__all__)
def test_every_public_name_is_there_and_documented(name: str) -> None:
    assert getattr(jackettwin, name).__doc__


def test_the_list_of_public_names() -> None:
    assert sorted(jackettwin.__all__) == [
        "Channel", "IdentificationSettings", "Observation", "Posterior", "Rayleigh", "Record", "TwinModel",
        "TwinState", "advance", "assemble", "build_report", "build_system", "damped_modes", "empty_state",
        "follow", "identify", "jacket", "observe", "read_record", "read_structure", "read_support",
        "read_twin", "run_twin", "state_model",
        "to_arviz", "to_dataframe", "to_xarray", "twin_model", "undamped_modes",
        "write_record",
    ]  # fmt: skip


@pytest.mark.parametrize("package", PACKAGES)
def test_the_names_of_a_package(package: str) -> None:
    module = __import__(f"jackettwin.{package}", fromlist=["__all__"])
    assert set(module.__all__) >= set(PACKAGES[package].split())


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="No jackettwin attribute jackt"):
        _ = jackettwin.jackt


def test_importing_the_package_imports_no_numpy() -> None:
    """The command line limits BLAS to one thread before NumPy is loaded."""
    code = "import sys, jackettwin; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_doors_give_what_they_promise_and_a_function_rather_than_its_module() -> None:
    doors = [m for m in pkgutil.iter_modules(jackettwin.__path__, "jackettwin.") if m.ispkg]
    promised = [(door, name) for m in doors for door in [import_module(m.name)] for name in names_of(door)]
    assert len(promised) > 100
    for door, name in promised:
        assert not isinstance(getattr(door, name), ModuleType), (door, name)


def names_of(package: ModuleType) -> list[str]:
    return list(getattr(package, "__all__", []))


def test_the_api_page_has_every_name_and_what_functions_return() -> None:
    page = (Path(__file__).parent.parent / "docs" / "api" / "index.md").read_text(encoding="utf-8")
    shown = {line.rsplit(".", 1)[-1] for line in page.splitlines() if line.startswith(":::")}
    assert set(jackettwin.__all__) <= shown
    for name in jackettwin.__all__:
        public = getattr(jackettwin, name)
        if isfunction(public):
            returned = set(re.findall(r"\w+", public.__annotations__["return"]))
            assert returned & (shown | OF_OTHERS), f"{name} returns {returned}, which the page does not show"


def test_results_print_as_a_line_or_two_and_not_as_arrays() -> None:
    """A notebook shows the last value of a cell: numbers that name themselves, no dump of samples."""
    structure = jackettwin.read_structure("jacket15")
    assembly = jackettwin.assemble(structure)
    system = jackettwin.build_system(assembly, jackettwin.read_support("pinned", structure))
    t = np.arange(6000) / 20.0
    decay = np.exp(-0.02 * 2.0 * np.pi * t) * np.sin(2.0 * np.pi * t)
    y = np.convolve(np.random.default_rng(1).normal(size=t.size), decay)[: t.size]
    record = jackettwin.Record(y[None], 20.0, (jackettwin.Channel("a"),))
    results = (
        structure, assembly, system, jackettwin.undamped_modes(system, 2),
        jackettwin.damped_modes(system, below_hz=0.3), jackettwin.Rayleigh.minimum(0.01, 0.2), record,
        jackettwin.identify(record), jackettwin.read_twin("thesis_table_6_1"),
    )  # fmt: skip
    for value in results:
        text = repr(value)
        assert len(text) < 400, f"{type(value).__name__}: {text[:200]}"
        assert "array(" not in text and type(value).__name__ in text
