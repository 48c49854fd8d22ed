"""The answers as one light: whether a foundation, or its twin, needs attention."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from jackettwin.answers import Answers
from jackettwin.report.tables.numbers import listed, words
from jackettwin.report.tables.sentences import MARGIN
from jackettwin.report.tables.sentences_model import objection_sentences

Level = Literal["ok", "look", "act"]


@dataclass(frozen=True)
class Light:
    """Urgency of the answers, with the reason in a few words.

    Attributes
    ----------
    level : {"ok", "look", "act"}
        ``act``: the model cannot reproduce the data, or the rotor may excite a first mode. ``look``: a
        measured mode is not as designed, is damped otherwise than in the model, or was not measured. How
        well the ground is known has no effect.
    words : str
    """

    level: Level
    words: str


def light(a: Answers) -> Light:
    """Return the light of a run's answers."""
    if not a.fits:
        return Light("act", "Not reliable: the model cannot reproduce the data")
    tight = {c.label: c.order for c in a.clearances if c.margin < MARGIN}
    if tight:
        near = listed([f"{words(label)} is near the rotor's {order}" for label, order in tight.items()])
        return Light("act", f"Act: {near}")
    measured = [m for m in a.modes if m.measured_hz is not None and m.fits_frequency]
    if not any(m.label in ("fore_aft_1", "side_side_1") for m in measured):
        return Light("look", "Look: no first bending mode was measured")
    off = [words(m.label) for m in measured if m.near_design is False]
    if off:
        return Light("look", f"Look: {listed(off)} {'is' if len(off) == 1 else 'are'} not as designed")
    if objection_sentences(a):
        return Light("look", "Look: part of the measurements is not explained")
    other = [words(m.label) for m in a.modes if m.damped_as_measured is False]
    if other:
        return Light("look", f"Look: the model damps {listed(other)} otherwise than measured")
    return Light("ok", "In order: no measurement contradicts the model")
