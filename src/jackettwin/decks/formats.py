"""The formats of structures, and the function that reads a structure in any of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from jackettwin.decks.sacs import is_sacs, read_sacs
from jackettwin.decks.structure_changes import AdjustedSchema, SteelSchema, changed_structure
from jackettwin.decks.structure_yaml import RnaSchema, read_yaml_structure
from jackettwin.decks.subdyn import read_subdyn
from jackettwin.decks.tower import TowerSchema
from jackettwin.errors import located, require
from jackettwin.files import Schema, find_file, shipped
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
    read = next((form.read for form in FORMATS if form.fits(path)), None)
    return read_yaml_structure(path, _read) if read is None else read(path)


def _read(source: str, folder: Path | None) -> Structure:
    return read_structure(source, folder=folder)


class StructureChoice(Schema):
    """A structure of a file with overrides; or a foundation of a file, and the tower on it.

    ``steel`` and ``adjusted`` are what ``jackettwin refine`` prints.
    """

    source: str | None = None
    foundation: str | None = None
    tower: TowerSchema | None = None
    rna: RnaSchema | None = None
    steel: dict[str, SteelSchema] = {}
    adjusted: list[AdjustedSchema] = []

    def read(self, folder: Path | None, rna: RnaSchema | None = None) -> Structure:
        """Return the structure with its rotor–nacelle assembly, or with ``rna`` in its place, changed.

        Raises
        ------
        InputError
            If it is not given in just one way, or its file is missing or wrong.
        """
        structure, rna = self._unchanged(folder), rna or self.rna
        structure = structure if rna is None else rna.stand_on(structure, folder=folder)
        return changed_structure(structure, self.steel, self.adjusted)

    def _unchanged(self, folder: Path | None) -> Structure:
        one = (self.source is None) != (self.foundation is None)
        remedy = "source: FILE, or foundation: FILE with tower: {…}"
        require(one, "give a structure in one way", field="structure", remedy=remedy)
        if self.source is not None:
            told = {"field": "structure.tower", "remedy": "give foundation: in the place of source:"}
            require(self.tower is None, "a tower stands on a foundation", **told)
            return read_structure(self.source, folder=folder)
        assert self.foundation is not None
        require(
            self.tower is not None, "required key is missing", field="structure.tower", remedy="add 'tower'"
        )
        assert self.tower is not None
        with located(field="structure"):
            return self.tower.stand_on(read_structure(self.foundation, folder=folder), folder=folder)
