"""What a watch would find: a longer horizon finds all that a shorter one does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.change import causes
from jackettwin.change.causes import model_causes
from jackettwin.change.smallest_changes import (
    SmallestChange,
    _with_sooner,
    smallest_changes,
    smallest_documents,
    smallest_sentence,
)
from jackettwin.decks import read_structure
from jackettwin.watching import History, start

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


def test_an_owner_is_told_scour_softening_and_braces_at_every_horizon(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """After a hundred days of two modes a day: two horizons by the records, a year projected from them."""
    monkeypatch.setattr(causes, "_DRAWS", 1)
    labels, f = ("side_side_1", "fore_aft_1", "torsion_1"), np.array([0.1806, 0.1835, 0.571])
    model = model_causes(read_structure("jacket15"), labels, f, np.full(3, 0.01))
    rng, t = np.random.default_rng(4), np.arange(0.0, 100.0, 0.5)
    shape, none = (t.size, 3), np.full((t.size, 3), np.nan)
    baseline = History(
        t, labels, f * np.exp(0.001 * rng.standard_normal(shape)), np.full(shape, 0.001) * f, none, none,
        10.0 + rng.standard_normal((t.size, 1)), ("temperature_c",), np.zeros(t.size, dtype=np.intp),
    )  # fmt: skip
    watch = start(baseline)
    found = smallest_changes(watch, baseline, model)
    names = ("scour at all feet", "soil softening", "a brace lost")
    assert [(one.change, one.days) for one in found] == [(n, d) for d in (30.0, 90.0, 365.0) for n in names]
    assert {one.days for one in found if one.projected} == {365.0}
    month, quarter, year = (found[3 * k : 3 * k + 3] for k in range(3))
    for earlier, later in ((month, quarter), (quarter, year)):
        assert later[0].size is not None and later[1].size is not None
        for one, more in zip(earlier[:2], later[:2], strict=True):
            assert one.size is None or one.size >= more.size
        assert 0 < earlier[2].found <= later[2].found <= later[2].of == 36
    said = smallest_sentence(smallest_documents(found))
    assert "within 365 days (projected from a shorter baseline) scour at all feet by" in said
    assert f"{year[2].found} of 36 braces if lost" in said
    # an effect that may be half as large or half as large again is found with 95 % if half of it nearly is
    unsure = replace(
        model,
        causes=tuple(
            replace(c, draws=np.concatenate([0.5 * c.draws, 1.5 * c.draws]), bend=0.0 * c.bend)
            for c in model.causes
            if c.name == "soil softening"
        ),
    )
    (wider,) = (one for one in smallest_changes(watch, baseline, unsure) if one.days == 90.0)
    assert 1.7 < wider.size / quarter[1].size < 2.0
