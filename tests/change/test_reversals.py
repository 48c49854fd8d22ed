"""Changes that take back an earlier one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.change.reversals import taken_back
from jackettwin.watching import Change

STD = 5e-4


def change(*size: float, kind: str = "frequency") -> Change:
    m = len(size)
    members = np.abs(size) > 2.0 * STD
    return Change(
        0.0, kind, "any", 0.0, (0.0, 0.0), members, np.array(size), np.full(m, STD), np.zeros((1, m, m)),
        np.zeros((1, m)), np.zeros(1), np.zeros((1, m, 1)), 20.0, (np.array(size) / STD) ** 2,
    )  # fmt: skip


def shares(sizes: Sequence[tuple[float, ...]]) -> tuple[int | None, ...]:
    return taken_back([change(*size) for size in sizes])


def test_a_repair_takes_back_what_it_repairs() -> None:
    """Another damage lies between; the repair is of the first pair's."""
    found = shares([(-5e-3, -5e-3, 0.0), (0.0, 0.0, -6e-3), (4.5e-3, 5.2e-3, 2e-4)])
    assert found == (None, None, 0)


def test_ice_comes_and_goes() -> None:
    on, off = (-4e-3,) * 3, (4.4e-3,) * 3
    assert shares([on, off, on, off]) == (None, 0, None, 2)


def test_half_of_a_change_and_another_mode_take_back_nothing() -> None:
    assert shares([(-6e-3, -6e-3, 0.0), (3e-3, 3e-3, 0.0)]) == (None, None)
    assert shares([(-6e-3, 0.0, 0.0), (0.0, 6e-3, 0.0)]) == (None, None)
    assert shares([(-6e-3, 0.0, 0.0), (-6e-3, 0.0, 0.0)]) == (None, None)


def test_scatter_and_other_kinds_take_back_nothing() -> None:
    one, other = change(-6e-3, -6e-3), change(6e-3, 6e-3)
    assert taken_back([one, change(6e-3, 6e-3, kind="damping")]) == (None, None)
    assert taken_back([change(1.0, kind="scatter"), change(-1.0, kind="scatter")]) == (None, None)
    assert taken_back([one, other]) == (None, 0)


def test_equal_changes_back_and_forth_are_told_in_99_of_100() -> None:
    """Sizes are drawn with their standard deviation; a sign turned in the sum would find none."""
    rng, n = np.random.default_rng(3), 400
    drawn = rng.normal(size=(n, 2, 4)) * STD + 8e-3 * np.array([-1.0, 1.0])[:, None]
    told = sum(shares([tuple(a), tuple(b)]) == (None, 0) for a, b in drawn)
    assert 0.97 * n < told < n  # binomial with 0.99: 396 ± 2
