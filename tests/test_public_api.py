"""The names users may rely on; a change here is a change of the public interface."""

import pkgutil
import subprocess
import sys
from importlib import import_module
from types import ModuleType

import pytest

import jackettwin

PACKAGES = {
    "records": "Channel Record assess decimate detrend read_record repair write_record",
    "report": "Plot Section Table Text build_report",
    "structure": "Assembly Material Rayleigh Section Structure assemble check jacket read_structure",
}


@pytest.mark.parametrize("name", jackettwin.__all__)
def test_every_public_name_is_there_and_documented(name: str) -> None:
    assert getattr(jackettwin, name).__doc__


def test_the_list_of_public_names() -> None:
    assert sorted(jackettwin.__all__) == [
        "Channel", "IdentificationSettings", "Observation", "Posterior", "Rayleigh", "Record", "TwinModel",
        "TwinState", "advance", "assemble", "build_report", "build_system", "damped_modes", "empty_state",
        "follow", "identify", "jacket", "observe", "read_record", "read_structure", "read_support",
        "read_twin", "run_twin", "to_arviz", "to_dataframe", "to_xarray", "twin_model", "undamped_modes",
        "write_record",
    ]  # fmt: skip


@pytest.mark.parametrize("package", PACKAGES)
def test_the_names_of_a_package(package: str) -> None:
    module = __import__(f"jackettwin.{package}", fromlist=["__all__"])
    assert set(module.__all__) >= set(PACKAGES[package].split())


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'jackt'"):
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
