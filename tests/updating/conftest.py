from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from jackettwin.decks import read_structure
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import Residuals, SupportModel, Target, support_model


@pytest.fixture(scope="session")
def jacket15() -> Assembly:
    return assemble(read_structure("jacket15"))


@pytest.fixture(scope="session")
def steel() -> Rayleigh:
    """The thesis's 1 % at the first mode."""
    return Rayleigh.minimum(0.01, 0.1832)


@pytest.fixture(scope="session")
def models(jacket15: Assembly, steel: Rayleigh) -> dict[str, SupportModel]:
    return {
        name: support_model(jacket15, family=family(name), rayleigh=steel)
        for name in ("kelvin-voigt", "zener", "maxwell-3", "springpot")
    }


@pytest.fixture(scope="session")
def maxwell_3(jacket15: Assembly) -> Callable[..., SupportModel]:
    """Build a model with the default law on 0.55 % steel up to the second bending pair; takes options."""
    steel = Rayleigh.minimum(0.0055, 0.1832)
    return partial(support_model, jacket15, family=family("maxwell-3"), rayleigh=steel, highest_mode=5)


@pytest.fixture(scope="session")
def table_6_1() -> Residuals:
    """Modes 1, 2, 4 and the damping of mode 1, relative residuals as in (8.4)."""
    return Residuals(
        (Target(1, 0.1819, damping_ratio=0.0127), Target(2, 0.1838), Target(4, 0.7362)), relative=True
    )
