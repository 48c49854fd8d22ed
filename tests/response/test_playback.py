"""Playing a record back finds the motion it was made from."""

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.motion.playback import playback, record_sensors
from jackettwin.response.sensors import observation_matrix
from jackettwin.response.system import build_system
from jackettwin.soil import pinned
from jackettwin.structure import assemble

RATE = 20.0
CHANNELS = tuple(
    Channel(f"a{h}{d}", height_m=h, direction=(1.0, 0.0, 0.0) if d == "x" else (0.0, 1.0, 0.0))
    for h in (144.0, 77.0, 41.0)
    for d in "xy"
)


@pytest.fixture(scope="module")
def jacket():
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    return assembly, undamped_modes(build_system(assembly, pinned(structure)), 6)


def made(assembly, modes, amplitude_m: np.ndarray) -> tuple[Record, np.ndarray]:
    """Return accelerations of modes that swing with given tower-top amplitudes, and q(t)."""
    t = np.arange(6000) / RATE
    q = amplitude_m[:, None] * np.cos(modes.omega[: amplitude_m.size, None] * t) * (t > 150.0)
    a = -(modes.omega[: amplitude_m.size, None] ** 2) * q
    H = observation_matrix(assembly, record_sensors(Record(np.zeros((6, 1)), RATE, CHANNELS)))
    return Record(H @ modes.shapes[:, : amplitude_m.size] @ a, RATE, CHANNELS), q


def test_the_motion_that_made_the_record_comes_back(jacket) -> None:
    """4 %: the band filter rings where the swinging starts, and modes beyond the band leave a trace."""
    assembly, modes = jacket
    record, q = made(assembly, modes, np.array([100.0, 60.0, 0.0, 10.0]))
    found = playback(assembly, modes, record, duration_s=60.0)
    assert found.start_s > 140.0  # the lively half
    first = round(found.start_s * RATE)
    middle = slice(200, 400)
    wanted = q[:, first : first + 1200 : 2].T[middle]
    top = assembly.dofs("tower_top")[:2]
    drawn, exact = found.shapes[top] @ found.q[middle].T, modes.shapes[top][:, :4] @ wanted.T
    np.testing.assert_allclose(drawn, exact, atol=0.04 * np.abs(exact).max())
    assert found.shapes.shape[1] < 6  # sensors on the axis cannot see torsion


def test_gaps_are_bridged_and_places_are_needed(jacket) -> None:
    assembly, modes = jacket
    record, _ = made(assembly, modes, np.array([100.0, 60.0]))
    holed = record.data.copy()
    holed[0, 100:120] = np.nan
    assert np.isfinite(playback(assembly, modes, Record(holed, RATE, CHANNELS)).q).all()
    with pytest.raises(InputError, match="has a position"):
        record_sensors(Record(np.zeros((1, 9)), RATE, (Channel("a", direction=(1.0, 0.0, 0.0)),)))
