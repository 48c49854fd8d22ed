"""A pile as it acts at its head: matrices of six coordinates, and of its motions beside these."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.arrays import FloatArray
from jackettwin.soil.laws.viscoelastic import Law


@dataclass(frozen=True)
class InnerPile:
    """Further coordinates of a pile beside those of its head, which follow it by static shapes.

    Each matrix is (6 + m, 6 + m), the head's coordinates first; what is between these is in the head's own.
    """

    steel: FloatArray
    soil: FloatArray
    mass: FloatArray
    dashpots: FloatArray


@dataclass(frozen=True)
class PileHead:
    """A pile lumped at its head: K* ≈ steel + D(s)·soil + s·dashpots + s²·mass, each 6×6."""

    steel: FloatArray
    soil: FloatArray
    mass: FloatArray
    dashpots: FloatArray
    inner: InnerPile
    """What it does beside following its head."""
    law: Law
