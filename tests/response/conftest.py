from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.soil.laws.viscoelastic import Law
from jackettwin.soil.support import Spring, Support, on_translations
from jackettwin.structure import Assembly, Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member, PointMass, Reaction

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"


def monopile_structure(n: int = 6) -> Structure:
    """A 120 m pile of constant section with an eccentric mass on top."""
    nodes = {f"n{k}": (0.0, 0.0, 120.0 * k / n) for k in range(n + 1)}
    tube = Section(7.0, 0.07)
    return Structure(
        "monopile",
        nodes,
        tuple(Member(f"m{k}", f"n{k}", f"n{k + 1}", tube, tube, STEEL) for k in range(n)),
        masses=(PointMass(f"n{n}", 5e5, (-3.0, 0.0, 2.0), (1e8, 2e8, 1.5e8, 0.0, 0.0, 0.0)),),
        reactions=(Reaction("n0"),),
    )


def on_law(structure: Structure, law: Law) -> Support:
    """The law on the feet's translations; on a monopile on all six DOFs, or it would fall over."""
    if len(structure.reactions) > 1:
        return on_translations(structure, law)
    return Support(springs=(Spring("n0", np.diag([1.0, 1.0, 1.0, 400.0, 400.0, 400.0]), law),))


@pytest.fixture(scope="session")
def jacket15() -> Assembly:
    return assemble(read_structure("jacket15"))


@pytest.fixture(scope="session")
def deck() -> Assembly:
    return assemble(read_structure(DECK), subdivide=1)


@pytest.fixture(scope="session")
def monopile() -> Assembly:
    return assemble(monopile_structure())
