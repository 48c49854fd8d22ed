"""Signs that turn and sensitivities that grow while a record runs are taken back; sound ones stay."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.records import assess, repair
from jackettwin.records.clocks.channel_delays import Network
from jackettwin.records.clocks.gain_changes import sign_turns


@pytest.mark.parametrize("rows", [[1], [0, 1], [0, 1, 4, 5]])
@pytest.mark.parametrize("start", [3_900, 6_000])
def test_signs_that_turn_are_turned_back(rows: list[int], start: int, tower: SimpleNamespace) -> None:
    record = tower.record(3)
    data = record.data.copy()
    data[rows, start:] *= -1.0
    broken = replace(record, data=data)
    quality = assess(broken)
    turns = quality.clocks.gains
    assert turns
    assert all(turn.start <= start <= turn.stop for turn in turns)
    ready = repair(broken, quality).data
    sense = [
        [np.sign(np.nansum((ready * data)[i, k])) for k in (np.s_[:3000], np.s_[-3000:])] for i in range(8)
    ]
    turned = [i for i, (before, after) in enumerate(sense) if before != after]
    # of x and y each has its own minority; of halves either
    for axis in (range(4), range(4, 8)):
        own, planted = {i for i in turned if i in axis}, {i for i in rows if i in axis}
        assert own == planted or (len(planted) == 2 and own == set(axis) - planted)


@pytest.mark.parametrize("factor", [1.6, 4.0, 0.5])
def test_a_gain_that_grows_is_taken_back(factor: float, tower: SimpleNamespace) -> None:
    record = tower.record(2)
    data = record.data.copy()
    data[2] *= np.linspace(1.0, factor, data.shape[1])
    quality = assess(replace(record, data=data))
    (grows,) = quality.clocks.growing
    assert grows.rows == (2,)
    # a line is no exponential: a quarter of a growth by four
    assert np.exp(grows.rate) == pytest.approx(factor, rel=0.25)


def test_a_turn_that_pairs_tell_in_neighbouring_windows_is_taken_back_once() -> None:
    """Of channel 0 against three others, in ten windows: one pair tells it a window later."""
    pairs = np.stack(np.triu_indices(4, 1), axis=1)
    sign = np.ones((10, 6))
    sign[5:, :2] = -1.0
    sign[6:, 2] = -1.0
    network = Network(4, pairs, np.ones(6, dtype=bool), np.empty((0, 2), dtype=np.intp), 0.1)
    y = np.random.default_rng(1).standard_normal((1, 1000)) * np.ones((4, 1))
    y[0, 520:] *= -1.0
    (turn,) = sign_turns(y, sign, np.ones((10, 6)), network, 100)
    assert turn.rows == (0,)
    assert turn.start <= 520 <= turn.stop
