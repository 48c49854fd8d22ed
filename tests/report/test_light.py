"""The light above the answers: green while nothing measured speaks against the model."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.report.test_sentences import ANSWERS, MODE

from jackettwin.answers import Answers, Span
from jackettwin.answers.result import Clearance, FitAnswer
from jackettwin.report import light

NEAR = Clearance("fore_aft_1", "3P", 0.25, 0.38, 0.04)
LESS = replace(
    MODE, label="fore_aft_3", fits_damping=False, measured_damping=Span(0.0124, 0.0109, 0.0141),
    model_damping=Span(0.023, 0.0197, 0.028),
)  # fmt: skip
OFF = replace(MODE, measured_hz=Span(0.16, 0.159, 0.161))


@pytest.mark.parametrize(
    ("answers", "level", "words"),
    [
        (ANSWERS, "ok", "In order: no measurement contradicts the model"),
        (replace(ANSWERS, clearances=(NEAR,)), "act", "Act: fore-aft 1 is near the rotor's 3P"),
        (replace(ANSWERS, modes=(OFF,)), "look", "Look: fore-aft 1 is not as designed"),
        (
            replace(ANSWERS, modes=(MODE, LESS)),
            "look",
            "Look: the model damps fore-aft 3 otherwise than measured",
        ),
        (replace(ANSWERS, modes=()), "look", "Look: no first bending mode was measured"),
        (replace(ANSWERS, modes=(OFF,), clearances=(NEAR,)), "act", "Act: fore-aft 1 is near the rotor's 3P"),
        (
            replace(ANSWERS, fit=FitAnswer(436.0, 4, 1e-90, False, {"side_side_1": -0.05}, 0.03)),
            "act",
            "Not reliable: the model cannot reproduce the data",
        ),
    ],
    ids=["healthy", "rotor", "off", "damping", "unmeasured", "worst-first", "misfit"],
)
def test_the_light_is_that_of_the_worst(answers: Answers, level: str, words: str) -> None:
    found = light(answers)
    assert (found.level, found.words) == (level, words)


def test_what_is_not_known_of_the_ground_turns_no_light() -> None:
    """It is work for the engineer, not a fault of the foundation."""
    unknown = tuple(replace(g, verdict="unidentified") for g in ANSWERS.ground)
    assert light(replace(ANSWERS, ground=unknown)).level == "ok"
