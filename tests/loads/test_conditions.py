"""Conditions of a record."""

from jackettwin.loads.sea.waves import SeaState


def test_a_sea_state_becomes_waves() -> None:
    waves = SeaState(Hs=3.0, Tp=8.0, direction=0.2).waves(depth=72.0, duration=600.0, seed=4)
    assert waves.depth == 72.0
    assert set(waves.direction) == {0.2}
