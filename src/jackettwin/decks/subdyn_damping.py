"""Damping that a SubDyn deck states beside its matrices."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast_tables import Deck, read_deck, to_float
from jackettwin.errors import InputError

_NONE, _RAYLEIGH, _MATRIX = "0", "1", "2"


@dataclass(frozen=True)
class DeckDamping:
    """JDampings, and what GuyanDampMod chooses.

    Attributes
    ----------
    modal : damping ratios of the internal modes; the last counts for all that follow
    alpha, beta : Rayleigh factors of the interface's six coordinates
    interface : (6, 6) damping of the interface [N·s/m, N·s, N·m·s]
    """

    modal: tuple[float, ...]
    alpha: float
    beta: float
    interface: FloatArray

    def ratios(self, number: int) -> FloatArray:
        """Return the damping ratio of the first internal modes."""
        given = self.modal or (0.0,)
        return np.array([given[min(k, len(given) - 1)] for k in range(number)])


def read_deck_damping(path: Path) -> DeckDamping:
    """Read how a SubDyn input file damps its reduced matrices.

    Raises
    ------
    InputError
        If it is none of SubDyn's ways, or incomplete.
    """
    deck = read_deck(path)
    kind = deck.scalar("GuyanDampMod", _NONE)
    if kind not in (_NONE, _RAYLEIGH, _MATRIX):
        raise InputError(
            "unknown damping of the interface", file=path, field="GuyanDampMod", value=kind, allowed="0, 1, 2"
        )
    alpha, beta = _rayleigh(deck) if kind == _RAYLEIGH else (0.0, 0.0)
    return DeckDamping(
        modal=tuple(0.01 * percent for percent in deck.numbers("JDampings")),
        alpha=alpha,
        beta=beta,
        interface=_matrix(deck) if kind == _MATRIX else np.zeros((6, 6)),
    )


def _rayleigh(deck: Deck) -> tuple[float, float]:
    values = deck.numbers("RayleighDamp")
    if len(values) != 2:
        raise InputError(
            "two factors are needed", file=deck.path, field="RayleighDamp", value=list(values), allowed="α, β"
        )
    return values[0], values[1]


def _matrix(deck: Deck) -> FloatArray:
    at = deck.find("GuyanDampSize")
    lines = () if at is None else deck.lines[at + 1 : at + 7]
    rows = [line.replace(",", " ").split()[:6] for line in lines]
    if [len(row) for row in rows] != [6] * 6:
        raise InputError(
            "a 6×6 matrix is needed",
            file=deck.path,
            field="GuyanDampSize",
            remedy="write six rows of six numbers below it",
        )
    return np.array([[to_float(word, deck.path, "Guyan damping matrix") for word in row] for row in rows])
