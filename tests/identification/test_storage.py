from __future__ import annotations

import json

import numpy as np
import pytest

from jackettwin.identification import identify
from jackettwin.identification.storage import from_plain, slim, to_plain
from jackettwin.identification.synthetic import simulate


def test_an_identification_comes_back_from_json_as_it_was(tower, rng):
    found = identify(simulate(tower, rng))
    text = json.dumps(to_plain(found))
    back = from_plain(json.loads(text))
    assert json.dumps(to_plain(back)) == text
    assert back.channels == found.channels
    assert back.settings == found.settings
    assert back.rejected == found.rejected
    for a, b in zip(back.modes, found.modes, strict=True):
        assert a.damping_ratio_interval_95 == b.damping_ratio_interval_95
        np.testing.assert_array_equal(a.mode_shape, b.mode_shape)
        np.testing.assert_array_equal(a.log_covariance, b.log_covariance)


def test_a_slim_identification_keeps_modes_and_drops_poles(tower, rng):
    found = identify(simulate(tower, rng))
    light = slim(found)
    assert light.modes is found.modes
    assert len(light.stabilisation.order) == 0
    assert light.spectrum.density.shape == (8, 0)


def test_data_of_something_else_is_refused():
    with pytest.raises(KeyError, match="settings"):
        from_plain({"modes": []})
