"""Laws ranked without standard deviations: by cost, equal ones by their number of parameters."""

from types import SimpleNamespace

import pytest

from jackettwin.updating import ranked


def law(name: str, cost: float, parameters: int = 2, *, locked: bool = False) -> SimpleNamespace:
    best = SimpleNamespace(cost=cost, locked_damper=locked)
    problem = SimpleNamespace(parameters=(None,) * parameters, allowance=lambda c: max(4e-8, 1e-3 * c))
    return SimpleNamespace(law=name, best=best, problem=problem, solutions=(best,))


def test_the_cheaper_comes_first_the_simpler_of_equals_and_the_locked_last() -> None:
    given = [
        law("three", 7.59e-6, 3),
        law("locked", 0.0, locked=True),
        law("worse", 2e-5),
        law("two", 7.595e-6, 2),
    ]
    found = ranked(given)  # type: ignore[arg-type]
    assert [(r.place, r.law) for r in found] == [(1, "two"), (1, "three"), (3, "worse"), (4, "locked")]
    assert ranked([]) == ()


@pytest.mark.parametrize("apart", [1e-9, 1e-6])
def test_a_negligible_difference_of_cost_is_none(apart: float) -> None:
    found = ranked([law("a", 1e-7), law("b", 1e-7 + apart)])  # type: ignore[arg-type]
    assert [r.place for r in found] == ([1, 1] if apart < 4e-8 else [1, 2])
