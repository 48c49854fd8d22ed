from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gallery import explore
from jackettwin.soil import Parameter
from jackettwin.study import TwinResult


def test_root_locus_is_refined_where_poles_move(targets_only: TwinResult) -> None:
    update = targets_only.updates[0]
    path = explore.locus(update.model, update.best.theta, (1,), ("side_side_1",))
    assert (np.diff(path.values) > 0.0).all()
    # Both ends are undamped springs plus the steel's damping: k alone, and pinned feet.
    held = targets_only.numbered.frequency_hz[0]
    assert abs(path.poles[-1, 0]) / (2.0 * np.pi) == pytest.approx(held, rel=1e-4)  # c of 1e14 is not ∞
    undamped = update.model.undamped_hz(update.best.theta, (1,))[0]
    assert abs(path.poles[0, 0]) / (2.0 * np.pi) == pytest.approx(undamped, rel=1e-4)
    steps = np.abs(np.diff(path.poles[:, 0])) / np.abs(path.poles[:, 0] - path.poles[0, 0]).max()
    assert steps.max() < 0.1


def test_root_locus_needs_no_refinement_when_nothing_moves(targets_only: TwinResult) -> None:
    """A soft dashpot on stiff springs: between its bounds the poles all but stand still."""
    update = targets_only.updates[0]
    model = replace(update.model, parameters=(update.model.parameters[0], Parameter("c", 1.0, 1.01, "N·s/m")))
    path = explore.locus(model, update.best.theta, (1,), ("side_side_1",), n=41)
    assert path.values.size == 41
    assert np.isfinite(path.poles).all()
