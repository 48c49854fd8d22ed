"""Laws ranked without standard deviations: by cost, equal ones by their number of parameters."""

from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.updating import ranked
from jackettwin.updating.law_choice import better
from jackettwin.updating.update import best_solution


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


def solution(cost: float, *frequency_hz: float, locked: bool = False) -> SimpleNamespace:
    return SimpleNamespace(cost=cost, locked_damper=locked, frequency_hz=np.array(frequency_hz))


def test_a_solution_without_a_locked_damper_is_the_best_only_near_the_data() -> None:
    """One that is as far off as the undamped structure of the locked one is no way out."""
    locked = solution(1e-9, 0.20, 1.0, locked=True)
    near, far = solution(1e-6, 0.201, 1.04), solution(1e-6, 0.20, 0.85)
    assert best_solution([locked, near]) is near  # type: ignore[list-item]
    assert best_solution([locked, far]) is locked  # type: ignore[list-item]
    assert best_solution([locked, far, near]) is near  # type: ignore[list-item]


def test_of_two_series_a_locked_damper_counts_against_the_one_that_locks_it_alone() -> None:
    free, locked = law("shorter", 1e-3, 3), law("longer", 1e-9, 5, locked=True)
    for one in (free, locked):
        one.problem.weighted = False
    assert not better(locked, free)  # type: ignore[arg-type]
    free.best.locked_damper = True
    assert better(locked, free)  # type: ignore[arg-type]
