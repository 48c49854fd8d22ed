"""States of operation by conditions, and which of them may update the supports."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from tests.support.observations import estimate, observation

from jackettwin.errors import InputError
from jackettwin.study.fit_data import updating
from jackettwin.twin import read_twin
from jackettwin.twin.advance import advance_all
from jackettwin.twin.exact_sums import average
from jackettwin.twin.operation import OperationRule
from jackettwin.twin.state import ALL, TwinState

RULE = OperationRule(
    states={
        "maintenance": {"status": ("service", "maintenance")},
        "parked": {"rotor_speed_rpm": (None, 0.3)},
        "idling": {"rotor_speed_rpm": (0.3, 3.0), "power_kw": (None, 0.0)},
        "operating": {"rotor_speed_rpm": (3.0, None)},
    },
    updates=("parked", "idling"),
)
START = datetime(2025, 3, 1, tzinfo=UTC)
TWIN = (
    "structure: jacket15\noperation:\n  states: {parked: {rotor_speed_rpm: [null, 0.3]}}\n  updates: [%s]\n"
)


@pytest.mark.parametrize(
    ("conditions", "state"),
    [
        ({"rotor_speed_rpm": 0.1}, "parked"),
        ({"rotor_speed_rpm": 0.1, "status": "service"}, "maintenance"),
        ({"rotor_speed_rpm": 1.0, "power_kw": -20.0}, "idling"),
        ({"rotor_speed_rpm": 1.0}, "unknown"),
        ({"rotor_speed_rpm": 7, "state": "parked"}, "operating"),
        ({}, "unknown"),
    ],
)
def test_the_first_state_that_holds_is_the_records(conditions, state) -> None:
    assert RULE.with_state(conditions)["state"] == state


def test_what_is_missing_is_named() -> None:
    assert RULE.missing({"rotor_speed_rpm": 1.0}) == ("status", "power_kw")
    assert OperationRule().missing({}) == ()
    assert OperationRule().with_state({"state": "as said"}) == {"state": "as said"}


def state_of(words: tuple[str, ...]) -> TwinState:
    """A state of records at 0.20 Hz while parked, 0.25 Hz else."""
    seen = [
        observation(
            {1: estimate(0.20 if word == "parked" else 0.25, 0.01)},
            START + timedelta(hours=6 * k),
            name=f"r{k}",
            conditions={"state": word},
        )
        for k, word in enumerate(words)
    ]
    return advance_all(TwinState("model"), seen)[0]


def test_only_those_update_that_may(tmp_path: Path) -> None:
    path = tmp_path / "twin.yaml"
    path.write_text(TWIN % "parked")
    config = read_twin(path, records_follow=True)
    state = state_of(("parked", "operating", "parked", "operating", "operating", "operating", "operating"))
    used = updating(config, state)
    assert average(used.totals[ALL].modes[1]).frequency_hz == pytest.approx(0.20, rel=1e-9)
    assert used.totals[ALL].conditions.records == 2
    assert list(used.days) == ["2025-03-01"]  # on the second day it operated
    assert state.totals[ALL].conditions.records == 7  # all are tracked
    assert used.totals == state_of(("parked", "x", "parked")).of_operations(RULE.may_update).totals


def test_none_that_may_is_said(tmp_path: Path) -> None:
    path = tmp_path / "twin.yaml"
    path.write_text(TWIN % "parked")
    with pytest.raises(InputError, match="no record is in a state"):
        updating(read_twin(path, records_follow=True), state_of(("operating",)))


def test_a_state_that_there_is_not_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "twin.yaml"
    path.write_text(TWIN % "parket")
    with pytest.raises(InputError, match="no such state of operation"):
        read_twin(path, records_follow=True)
