"""Changes that are known already: taken back by a repair, or come again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jackettwin.change import finding_of
from jackettwin.change.reversals import (
    EarlierAlarm,
    Recurrence,
    answer_of,
    known_causes,
    known_changes,
    past_of,
)
from jackettwin.change.watch_document import alarm_sentence, chains
from jackettwin.watching import Cause, Change, Diagnosis, diagnose, general_causes
from jackettwin.watching.scatter import STRONGER

STD = 5e-4
KINDS = ["frequency"] * 4
EVERY = np.ones(4, dtype=np.bool_)
ON = np.array([-4e-3, -4e-3, -2e-3, -2e-3])


def past(day: int, size: np.ndarray, answer: Recurrence | None = None, std: float = STD) -> EarlierAlarm:
    return EarlierAlarm(f"2025-03-{day:02d}T00:00:00+00:00", size, np.full(size.size, std), True, answer)


def answered(of: EarlierAlarm, way: str) -> Recurrence:
    return Recurrence(way, of.time_utc)  # type: ignore[arg-type]


def seen(size: np.ndarray, rng: np.random.Generator) -> Change:
    """Return what a watch knows of a change of four frequencies."""
    info = np.eye(4) / STD**2
    size = size + STD * rng.standard_normal(4)
    scatter = np.full((1, 4, len(STRONGER)), -30.0)
    return Change(
        0.0, "frequency", "any", 0.0, (0.0, 0.0), EVERY, size, np.full(4, STD), info[None],
        (info @ size)[None], np.zeros(1), scatter, 9.0, (size / STD) ** 2,
    )  # fmt: skip


def patterns() -> tuple[Cause, ...]:
    return general_causes(
        [("frequency", i) for i in range(4)], ("a", "b", "c", "d"), np.array([0.3, 0.31, 1.1, 1.2])
    )


def told(
    earlier: Sequence[EarlierAlarm], size: np.ndarray, seed: int = 0
) -> tuple[Recurrence | None, Diagnosis]:
    known = known_changes(earlier)
    causes = (*patterns(), *known_causes(known, EVERY))
    found = diagnose(seen(size, np.random.default_rng(seed)), causes, KINDS)
    return answer_of(found.verdicts[:1], known), found


def test_a_repair_takes_back_what_it_repairs() -> None:
    """Another damage lies between, and the repair is of the first: it is nothing else."""
    first, other = past(4, ON), past(9, np.array([0.0, 0.0, 0.0, -6e-3]))
    answer, found = told([first, other], -ON)
    assert answer == answered(first, "takes_back")
    assert found.verdicts[0].cause == "the change of 2025-03-04 taken back"
    assert found.verdicts[0].probability > 0.95
    assert told([first, other], -other.size)[0] == answered(other, "takes_back")


def test_what_comes_and_goes_is_the_first_of_its_kind_again() -> None:
    on = past(1, ON)
    off = past(5, -ON, answered(on, "takes_back"))
    assert told([on, off], ON)[0] == answered(on, "again")
    again = past(9, ON, answered(on, "again"))
    assert told([on, off, again], -ON)[0] == answered(again, "takes_back")
    gone = past(12, -ON, answered(again, "takes_back"))
    assert list(known_changes([on, off, again, gone])) == ["the change of 2025-03-01 again"]
    assert told([on, off, again, gone], -ON)[0] is None  # it is gone, and cannot go once more


@pytest.mark.parametrize("size", [-0.5 * ON, ON, ON[::-1], -ON[::-1]])
def test_half_of_a_change_more_of_it_and_another_mode_take_back_nothing(size: np.ndarray) -> None:
    assert told([past(1, ON)], size)[0] is None


def test_scatter_is_never_taken_back() -> None:
    assert known_changes([replace(past(1, ON), sized=False)]) == {}


def test_changes_back_and_forth_are_as_uncertain_as_stated() -> None:
    """Sizes are drawn with their deviations: nearly all are told, by causes of just these moments."""
    rng = np.random.default_rng(3)
    drawn = [past(1, ON + STD * rng.standard_normal(4)) for _ in range(40)]
    assert sum(told([one], -ON, seed)[0] is not None for seed, one in enumerate(drawn)) >= 36
    (cause,) = known_causes(known_changes([past(1, ON, std=2e-3)]), np.array([True, True, False, True]))
    np.testing.assert_allclose(cause.draws.mean(axis=0), -ON[[0, 1, 3]], rtol=1e-12)
    np.testing.assert_allclose(np.cov(cause.draws.T), 4e-6 * np.eye(3), atol=1e-18)


def document(day: int, size: float, **more: Any) -> dict[str, Any]:
    """Return the document of an alarm of one mode."""
    at, low, high = np.expm1([size, size - 1.645 * STD, size + 1.645 * STD]).tolist()
    time = f"2025-03-{day:02d}T00:00:00+00:00"
    sized = {"size": at, "interval_90": [low, high], "unit": "-"}
    verdict = {"time_utc": time, "cause": "soil", "probability": 0.9, "named": ["soil"]}
    return {
        "kind": "frequency", "time_utc": time, "began_utc": time, "began_interval_90": [time, time],
        "quantities": ["f1"], "by_quantity": {"f1": sized}, "size": at, "size_interval_90": [low, high],
        "verdicts": [verdict], "causes": [verdict], "at_alarm": None, "takes_back_utc": None,
        "again_utc": None, **more,
    }  # fmt: skip


def test_an_alarm_is_read_back_from_its_document() -> None:
    turned = {"f1": {"size": -8.0, "interval_90": [-8.8, -7.2], "unit": "deg"}}
    on = document(1, -6e-3, by_quantity=turned)
    off = document(5, 6e-3, takes_back_utc=on["time_utc"])
    found = past_of(on)
    np.testing.assert_allclose([found.size[0], found.size_std[0]], np.radians([-8.0, 0.8 / 1.645]), rtol=1e-3)
    back = past_of(off)
    np.testing.assert_allclose([back.size[0], back.size_std[0]], [6e-3, STD], rtol=1e-3)
    assert (found.answer, back.answer) == (None, Recurrence("takes_back", on["time_utc"]))


def test_one_story_is_told_of_what_comes_and_goes() -> None:
    on, other = document(1, -6e-3), document(3, -2e-3)
    off = document(5, 6e-3, takes_back_utc=on["time_utc"])
    again = document(9, -6e-3, again_utc=on["time_utc"])
    gone = document(12, 6e-3, takes_back_utc=again["time_utc"])
    assert chains([on, other, off, again, gone]) == [[on, off, again, gone], [other]]
    said = alarm_sentence([on, off, again, gone])
    assert said.endswith(
        "most likely soil (90 %); taken back 2025-03-05 (90 %), again from 2025-03-09 on (90 %), taken back "
        "2025-03-12 (90 %): it comes and goes, like ice or a state of operation without a column."
    )
    assert alarm_sentence([on, off]).endswith("(90 %): as by a repair, or a mass that comes and goes.")
    codes = [finding_of(one).code for one in (on, off, again)]
    assert codes == ["structure_changed", "change_taken_back", "change_again"]
    # a person who was called stays called, whatever it turns out to be
    assert finding_of(off | {"at_alarm": document(5, 6e-3)}).code == "structure_changed"
