"""What conditions do to a mode, in their own units."""

import numpy as np
import pytest

from jackettwin.watching import History, start
from jackettwin.watching.condition_effects import slopes


def test_a_planted_effect_is_told_by_unit_of_its_condition(quiet: History) -> None:
    """Both frequencies fall by 1e-4 a kelvin, whose scatter of some kelvins is the regressor's scale."""
    watch = start(quiet)
    (block,) = (one for one in watch.blocks if one.kind == "frequency")
    found = [one["temperature_c"] for one in slopes(block, watch.design)]
    # 640 values of 0.2 % noise and 0.1 % of slow wandering over 6 K: some 3e-5 a kelvin
    assert found == pytest.approx([-1e-4, -1e-4], abs=6e-5)
    assert (np.array(found) < 0.0).all()
