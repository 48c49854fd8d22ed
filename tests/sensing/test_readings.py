"""What sensors read of a motion, beside what they are built for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.decks import read_structure
from jackettwin.records import Channel, Record
from jackettwin.response import Sensor
from jackettwin.sensing import readings_of
from jackettwin.structure import assemble, rigid_body_motion


@pytest.mark.parametrize(
    ("direction", "rotation", "read"),
    [
        ((1.0, 0.0, 0.0), 4, -1.0),
        ((0.0, 1.0, 0.0), 3, 1.0),
        ((1.0, 1.0, 0.0), 4, -np.sqrt(0.5)),
        ((0.0, 0.0, 1.0), 4, 0.0),
    ],
)
def test_a_leaning_accelerometer_reads_gravity_against_its_lean(
    direction: tuple[float, float, float], rotation: int, read: float
) -> None:
    """It reads the force that holds its mass, a − g: +1 g upright, and −g θ along an axis that sinks by θ.

    The x axis sinks as the structure turns about +y, and the y axis rises as it turns about +x.
    """
    assembly = assemble(read_structure("jacket15"))
    sensor = Sensor("a", direction, height_m=77.0)
    record = Record(
        np.random.default_rng(1).standard_normal((1, 600)), 20.0, (Channel("a", "acceleration", direction),)
    )
    tilt, upright = (
        readings_of(record, (sensor,), assembly, feel_gravity=feel).tilt[0] for feel in (True, False)
    )
    rigid = rigid_body_motion(assembly)
    assert tilt @ rigid[:, rotation] == pytest.approx(9.80665 * read, abs=1e-9)
    assert_allclose(tilt @ rigid[:, :3], 0.0, atol=1e-9)
    assert not upright.any()
