"""Errors of the parts of a simulation, in the words of its scenario file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from jackettwin.errors import InputError
from jackettwin.simulate.scenario.scenario import Scenario

_KEYS = {
    "Hs": "waves.hs_m",
    "Tp": "waves.tp_s",
    "height": "waves.height_m",
    "period": "waves.period_s",
    "theory": "waves.type",
    "depth": "water.depth_m",
    "flooded": "water.flooded",
}
"""What the sea calls its numbers, and a scenario does."""


@contextmanager
def in_words_of(scenario: Scenario) -> Iterator[None]:
    """Fill file and key of every input error raised inside."""
    try:
        yield
    except InputError as error:
        field = _KEYS.get(error.field or "", error.field)
        raise type(error)(
            error.problem,
            file=error.file or scenario.path,
            field=field,
            value=error.value,
            allowed=error.allowed,
            remedy=error.remedy,
        ) from None
