"""The direction of a pair's lower mode: from shapes at sensors, and when there is none."""

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from observations import estimate, observation

from jackettwin.response.sensors import Sensor
from jackettwin.twin import Observation
from jackettwin.twin.exact_sums import plus
from jackettwin.twin.observation import Recognised
from jackettwin.twin.pair_angles import pair_angles
from jackettwin.twin.state import AngleSums

DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def seen(
    angle_deg: float, apart: float = 0.02, std: float = 5e-4, directions: tuple = DIRECTIONS
) -> Observation:
    """Return a record of a pair whose lower mode, side-side, moves in a direction; two heights."""
    sensors = tuple(Sensor(f"{h}{d}", d, height_m=h) for h in (20.0, 80.0) for d in directions)
    way = np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg)), 0.0])
    along = np.array([np.dot(s.direction, way) * float(s.height_m or 0.0) / 80.0 for s in sensors])
    across = np.array([np.dot(s.direction, np.cross([0, 0, 1.0], way)) for s in sensors])
    lower = replace(
        estimate(0.2, 0.01, std), frequency_std_hz=0.2 * std, mode_shape=along.astype(complex) * 1j
    )
    upper = replace(
        estimate(0.2 * (1 + apart), 0.01, std), frequency_std_hz=0.2 * std, mode_shape=across.astype(complex)
    )
    made = observation({1: upper, 2: lower}, datetime(2025, 1, 1, tzinfo=UTC), sensors=sensors)
    labels = (Recognised(1, "fore_aft_1", 1.0), Recognised(2, "side_side_1", 1.0))
    return replace(made, recognised=labels)


@pytest.mark.parametrize("angle", [-60.0, 0.0, 31.0, 89.0])
def test_the_direction_is_that_of_the_lower_mode(angle: float) -> None:
    ((label, (found, std)),) = pair_angles(seen(angle)).items()
    assert label == "side_side_1"
    assert np.degrees(found) == pytest.approx(angle)
    assert std == pytest.approx(
        np.sqrt(2.0) * 5e-4 / 0.02
    )  # perturbation: what is unsure over what lies apart


def test_sensors_may_point_anywhere_horizontal() -> None:
    askew = ((0.6, 0.8, 0.0), (-1.0, 0.0, 0.0))
    assert np.degrees(pair_angles(seen(20.0, directions=askew))["side_side_1"][0]) == pytest.approx(20.0)


def test_a_pair_that_closes_up_has_no_direction() -> None:
    assert pair_angles(seen(20.0, apart=0.002)) == {}


def test_one_direction_shows_none() -> None:
    assert pair_angles(seen(20.0, directions=DIRECTIONS[:1])) == {}


def test_the_shape_s_own_uncertainty_counts() -> None:
    one = seen(20.0)
    upper, lower = one.identification.modes
    unsure = replace(lower, mode_shape_std=np.full(4, 0.1))
    found = replace(one, identification=replace(one.identification, modes=(upper, unsure)))
    # places at 1/4 and 1: 0.1/√(1/16 + 1)
    expected = np.hypot(np.sqrt(2.0) * 5e-4 / 0.02, 0.1 / np.sqrt(17.0 / 16.0))
    assert pair_angles(found)["side_side_1"][1] == pytest.approx(expected)


def test_directions_are_as_good_as_their_opposites() -> None:
    """The mean of 88° and −88° is 90°, weighted by how well they are known."""
    one, other = (AngleSums.of(np.radians(a), 0.1) for a in (88.0, -88.0))
    angle, std = plus(one, other).mean
    assert abs(np.degrees(angle)) == pytest.approx(90.0)
    assert std == pytest.approx(0.1 / np.sqrt(2.0))
    sharper = plus(AngleSums.of(np.radians(88.0), 0.01), other).mean[0]
    assert np.degrees(sharper) == pytest.approx(88.0, abs=0.1)
