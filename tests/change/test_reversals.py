"""Changes that take back an earlier one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jackettwin.change import repairs
from jackettwin.change.reversals import taken_back

STD = 5e-4


def change(*size: float, kind: str = "frequency", day: int = 1) -> dict[str, Any]:
    """Return the document of an alarm: changes of ln f with a standard deviation of STD."""
    logs = {f"bending_{k}": x for k, x in enumerate(size)}
    sized = {}
    for name, x in logs.items():
        at, low, high = np.expm1([x, x - 1.645 * STD, x + 1.645 * STD]).tolist()
        sized[name] = {"size": at, "interval_90": [low, high], "unit": "-"}
    return {
        "kind": kind, "time_utc": f"2025-03-{day:02d}T00:00:00+00:00", "by_quantity": sized,
        "quantities": [name for name, x in logs.items() if abs(x) > 2.0 * STD],
    }  # fmt: skip


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


def test_a_turn_back_of_a_pair_is_in_degrees() -> None:
    """Turned by −8 and +8.4 degrees, known to half a degree; as shares of themselves they would not fit."""
    one, other = (
        change(1.0, kind="angle") | {"by_quantity": {"bending_0": {
            "size": at, "interval_90": [at - 0.8, at + 0.8], "unit": "deg"
        }}} for at in (-8.0, 8.4)
    )  # fmt: skip
    assert taken_back([one, other]) == (None, 0)


def test_a_quantity_that_was_not_watched_then_takes_back_nothing() -> None:
    assert taken_back([change(-6e-3), change(6e-3, 6e-3)]) == (None, None)


def test_the_finding_names_both_days() -> None:
    on, off = change(-6e-3, -6e-3, day=4), change(6e-3, 6e-3, day=19)
    ((at, finding),) = repairs([on, off])
    assert (at, finding.code, finding.subject) == (
        off["time_utc"],
        "change_taken_back",
        "bending_0, bending_1",
    )
    assert "the change of 2025-03-19 takes back that of 2025-03-04" in str(finding)
    assert repairs([on]) == ()


def test_equal_changes_back_and_forth_are_told_in_99_of_100() -> None:
    """Sizes are drawn with their standard deviation; a sign turned in the sum would find none."""
    rng, n = np.random.default_rng(3), 400
    drawn = rng.normal(size=(n, 2, 4)) * STD + 8e-3 * np.array([-1.0, 1.0])[:, None]
    told = sum(shares([tuple(a), tuple(b)]) == (None, 0) for a, b in drawn)
    assert 0.97 * n < told < n  # binomial with 0.99: 396 ± 2
