from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import fuse
from jackettwin.identification.many_records.convergence import convergence
from jackettwin.report.figures import subspace_mac as figures


def names(found):
    return ["fore_aft_1", *[""] * (len(found.modes) - 1)]


def test_the_matrix_is_symmetric_with_ones_on_its_diagonal(identifications):
    (heat,) = figures.mac_matrix(identifications[0], names(identifications[0])).data
    values = np.array(heat.z)
    np.testing.assert_allclose(np.diag(values), 1.0)
    np.testing.assert_allclose(values, values.T, atol=1e-12)
    assert heat.x[0].startswith("fore-aft")


def test_every_sensor_of_every_mode_has_a_needle(identifications):
    found = identifications[0]
    figure = figures.complexity(found, names(found))
    assert len(figure.data) == 3 * len(found.modes)
    tip = complex(figure.data[1].x[1], figure.data[1].y[1])
    assert tip == pytest.approx(complex(found.modes[0].mode_shape[1]))


def test_intervals_end_at_those_of_all_records(identifications):
    mode = fuse(identifications).modes[0]
    figure = figures.interval_history([("fore_aft_1", convergence(mode))])
    (line,) = figure.data
    assert list(line.x) == [1, 2, 3]
    high = line.y[-1] + line.error_y.array[-1]
    assert high == pytest.approx(100 * mode.damping_ratio_interval_90[1])
