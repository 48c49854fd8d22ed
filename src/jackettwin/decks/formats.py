"""The formats of structures, and the function that reads a structure in any of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from jackettwin.decks.sacs import is_sacs, read_sacs
from jackettwin.decks.structure_yaml import read_yaml_structure
from jackettwin.decks.subdyn import read_subdyn
from jackettwin.files import find_file, shipped
from jackettwin.structure import Structure


class StructureFormat(NamedTuple):
    """A format: what it is called, whether a path names such a file, and what reads it."""

    name: str
    fits: Callable[[Path], bool]
    read: Callable[[Path], Structure]


FORMATS = (
    StructureFormat("a SubDyn .dat file", lambda path: path.suffix.lower() == ".dat", read_subdyn),
    StructureFormat("a SACS deck (sacinp.*, *.sacs)", is_sacs, read_sacs),
)
"""Formats beside our own; a file of any other name is YAML."""


def shipped_structures() -> tuple[str, ...]:
    """Return the names of the structures that come with the package."""
    return shipped("structures")


def read_structure(source: str | Path, *, folder: Path | None = None) -> Structure:
    """Read a structure: a shipped name, a YAML file, an OpenFAST SubDyn input (``.dat``) or a SACS deck.

    Parameters
    ----------
    source : str or Path
    folder : Path, optional
        What a relative path is relative to.

    Raises
    ------
    InputError
        If the file is missing or anything in it is wrong; the message names file, field and value.
    """
    also = f", {', or '.join(form.name for form in FORMATS)}"
    path = find_file(source, "structures", folder=folder, also=also)
    read = next((form.read for form in FORMATS if form.fits(path)), read_yaml_structure)
    return read(path)
