"""Rule for a turbine's state of operation, and whether its records may update the supports."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from pydantic import model_validator

from jackettwin.errors import look_up
from jackettwin.files import Schema

UNKNOWN = "unknown"
"""The state of operation of a record that meets no rule."""
AT_WORK = "operating"
"""The state whose records have a rotor that produces power, as scenarios name it."""
Condition = tuple[float | None, float | None] | tuple[str, ...]
"""Requirement on a condition: between two numbers, either of which may be open, or one of some words."""


class OperationRule(Schema):
    """``operation`` of a twin file: states of operation, and those whose records may update the supports.

    Attributes
    ----------
    states : {state: {condition: requirement}}
        The record's state is the first whose conditions all hold. Without states the record states it.
    updates : tuple of str or None
        States whose records may update; records of others are tracked only. With None all may update.
    """

    states: dict[str, dict[str, Condition]] = {}
    updates: tuple[str, ...] | None = None

    @model_validator(mode="after")
    def _known_states(self) -> Self:
        known = dict.fromkeys([*self.states, UNKNOWN])
        for name in self.updates or () if self.states else ():
            look_up(known, name, "state of operation", field="operation.updates")
        return self

    def with_state(self, conditions: Mapping[str, Any]) -> dict[str, Any]:
        """Return conditions with the state of operation that follows from them."""
        if not self.states:
            return dict(conditions)
        fitting = (name for name, wanted in self.states.items() if _all_hold(wanted, conditions))
        return {**conditions, "state": next(fitting, UNKNOWN)}

    def missing(self, conditions: Mapping[str, Any]) -> tuple[str, ...]:
        """Return the conditions that the rule needs and a record does not state."""
        asked = dict.fromkeys(name for wanted in self.states.values() for name in wanted)
        return tuple(name for name in asked if conditions.get(name) is None)

    def may_update(self, operation: str) -> bool:
        """Return whether records of a state of operation may update; its wind speed bin follows a comma."""
        return self.updates is None or operation.partition(", ")[0] in self.updates


def _all_hold(wanted: Mapping[str, Condition], conditions: Mapping[str, Any]) -> bool:
    return all(_holds(condition, conditions.get(name)) for name, condition in wanted.items())


def _holds(condition: Condition, value: Any) -> bool:
    if isinstance(value, bool) or value is None:
        return False
    if isinstance(value, int | float):
        low, high = (limit if isinstance(limit, int | float) else None for limit in (*condition, None)[:2])
        numbers = not any(isinstance(limit, str) for limit in condition)
        return numbers and (low is None or value >= low) and (high is None or value <= high)
    return str(value) in condition
