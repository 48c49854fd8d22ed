"""What a watch would find: a longer horizon finds all that a shorter one does."""

from __future__ import annotations

import pytest

from jackettwin.change.smallest_changes import SmallestChange, _with_sooner

SCOUR = SmallestChange("scour", 365.0, 0.28, "m", step=(-0.02,))
SOONER = SmallestChange("scour", 90.0, 0.26, "m", step=(-0.01,))


@pytest.mark.parametrize(
    ("one", "sooner", "size", "step"),
    [
        (SCOUR, SOONER, 0.26, (-0.01,)),
        (SmallestChange("scour", 365.0, None, "m"), SOONER, 0.26, (-0.01,)),
        (SmallestChange("scour", 365.0, 0.2, "m", step=(-0.005,)), SOONER, 0.2, (-0.005,)),
        (SCOUR, SmallestChange("scour", 90.0, None, "m"), 0.28, (-0.02,)),
        (SCOUR, None, 0.28, (-0.02,)),
    ],
)
def test_what_is_found_sooner_is_found_later(one, sooner, size, step) -> None:
    found = _with_sooner(one, sooner)
    assert (found.days, found.size, found.step) == (one.days, size, step)


def test_braces_found_sooner_are_found_later() -> None:
    later, sooner = (
        SmallestChange("a brace lost", d, None, "-", n, 36) for d, n in ((365.0, 32), (90.0, 34))
    )
    assert _with_sooner(later, sooner).found == 34
