"""Support laws by name: ours, and those that another package brings."""

import pickle
from collections.abc import Iterator

import numpy as np
import pytest

from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.soil import DEFAULT_LAWS, Family, Law, Parameter, Prony, read_support
from jackettwin.soil.laws import families
from jackettwin.soil.laws.coefficients import BRANCHES, K0, OMEGA0, law_stiffness

PRONY = ("prony-1", "prony-2", "prony-3", "prony-4")


class Rubber(Family):
    """A spring whose name of a parameter has an underscore."""

    name = "rubber"
    words = "a spring of rubber"
    parameters = (Parameter("k_eff", 1e7, 1e12, "N/m", words="effective stiffness"),)

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        return Prony(float(values[0]))

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes."""
        rows = np.zeros((len(values), BRANCHES))
        rows[:, OMEGA0], rows[:, K0] = 1.0, values[:, 0]
        slopes = np.zeros((*rows.shape, 1))
        slopes[:, K0, 0] = values[:, 0]
        return rows, slopes


@pytest.fixture
def rubber(monkeypatch: pytest.MonkeyPatch) -> Iterator[Rubber]:
    law = Rubber()
    monkeypatch.setattr(families, "plugins_of_type", lambda group, kind: {"rubber": law})
    families.families.cache_clear()
    yield law
    families.families.cache_clear()


def test_a_law_of_another_package_is_a_support_by_its_short_form(rubber: Rubber) -> None:
    support = read_support("rubber:k_eff=2e9", read_structure("jacket15"))
    assert {spring.law for spring in support.springs} == {Prony(2e9)}
    assert families.law_parameter("k_eff_horizontal@scoured") == "k_eff"
    assert families.parameter_words("k_eff_horizontal") == "horizontal effective stiffness"
    assert pickle.loads(pickle.dumps(rubber)) is rubber
    with pytest.raises(InputError, match="support.rubber.k_eff: argument is missing; allowed: k_eff="):
        read_support("rubber:", read_structure("jacket15"))


def test_our_laws_come_first_and_the_default_ones_are_ours(rubber: Rubber) -> None:
    assert list(families.families()) == ["kelvin-voigt", "zener", "maxwell-3", "springpot", *PRONY, "rubber"]
    assert set(DEFAULT_LAWS) < set(families.families())


def test_an_unknown_law_names_those_there_are() -> None:
    with pytest.raises(InputError, match="--law: no such law .got 'zenner'.; allowed: kelvin-voigt, zener"):
        families.family("zenner", field="--law")


@pytest.mark.parametrize("name", families.families())
def test_rows_are_those_of_the_law_and_their_slopes_its_derivatives(name: str) -> None:
    """D(s) of the rows is the law's own; slopes by ln θ against central differences."""
    law, f0, s = families.family(name), 0.2, 1.3j
    values = np.array([np.sqrt(p.low * p.high) for p in law.parameters])
    rows, slopes = law.rows(values[None], f0)
    assert law_stiffness(rows[0], s) == pytest.approx(complex(law.build(values, f0).stiffness(s)), rel=1e-12)
    step = 1e-6
    for i in range(values.size):
        up, down = values.copy(), values.copy()
        up[i], down[i] = values[i] * np.exp(step), values[i] * np.exp(-step)
        difference = (law.rows(up[None], f0)[0][0] - law.rows(down[None], f0)[0][0]) / (2.0 * step)
        # truncation is 1e-12, rounding 1e-16/1e-6 of the number itself
        assert (np.abs(slopes[0, :, i] - difference) <= 1e-8 * np.abs(rows[0])).all()
