"""Conditions of a record."""

import pytest

from jackettwin.errors import InputError
from jackettwin.loads.conditions import Conditions, SeaState
from jackettwin.loads.wind import Wind


def test_states_choose_the_shaft() -> None:
    assert Conditions().shaft == "locked"
    assert Conditions(state="idling").shaft == "free"
    with pytest.raises(InputError, match="parked, idling, operating"):
        Conditions(state="stuck")
    with pytest.raises(InputError, match="needs wind"):
        Conditions(state="operating")
    assert Conditions(state="operating", wind=Wind(10.0, 150.0)).wind is not None


def test_a_sea_state_becomes_waves() -> None:
    waves = SeaState(Hs=3.0, Tp=8.0, direction=0.2).waves(depth=72.0, duration=600.0, seed=4)
    assert waves.depth == 72.0
    assert set(waves.direction) == {0.2}
