"""Given kinematics against the theory that they were taken from."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.sea.given_kinematics import PRESSURE, REQUIRED, TravellingKinematics, read_kinematics
from jackettwin.loads.sea.waves import airy_wave

DEPTH, T, RHO = 40.0, 10.0, 1025.0
WAVE = airy_wave(height=4.0, period=T, depth=DEPTH, direction=0.4)


def table(times, heights) -> str:
    """Return the file of WAVE's motion at the origin."""
    points = np.array([[0.0, 0.0, z] for z in heights])
    u, du = WAVE.motion(points, times)
    eta, p = WAVE.elevation(points, times), RHO * WAVE.pressure(points, times)
    along = np.array([np.cos(0.4), np.sin(0.4), 0.0])
    lines = [",".join((*REQUIRED, PRESSURE))]
    for i, t in enumerate(times):
        for j, z in enumerate(heights):
            row = (t, z, eta[i, j], u[i, j] @ along, u[i, j, 2], du[i, j] @ along, du[i, j, 2], p[i, j])
            lines.append(",".join(f"{v:.12g}" for v in row))
    return "\n".join(lines)


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("waves") / "kinematics.csv"
    path.write_text(table(np.linspace(0.0, T, 201), np.linspace(-DEPTH, 2.0, 85)), encoding="utf-8")
    return path


def test_a_wave_comes_back_wherever_it_travels(file: Path) -> None:
    """C = ω/k: the Airy wave itself at other places, to the grid's straight lines (0.05 s, 0.5 m: 2e-4)."""
    c = float(WAVE.omega[0] / WAVE.k[0])
    found = TravellingKinematics(read_kinematics(file), T, c, 0.4, RHO)
    points = np.array([[12.0, -5.0, -8.2], [-30.0, 3.0, -33.3], [0.0, 0.0, -0.4]])
    t = np.linspace(0.0, 2.0 * T, 57)
    for one, other in zip(found.motion(points, t), WAVE.motion(points, t), strict=True):
        np.testing.assert_allclose(one, other, atol=4e-4 * np.abs(other).max())
    np.testing.assert_allclose(found.elevation(points, t), WAVE.elevation(points, t), atol=4e-4 * 2.0)
    pressure = WAVE.pressure(points, t)
    np.testing.assert_allclose(found.pressure(points, t), pressure, atol=4e-4 * np.abs(pressure).max())


def test_order_of_rows_and_columns_is_free(file: Path, tmp_path: Path) -> None:
    header, *rows = file.read_text().splitlines()
    turned = tmp_path / "turned.csv"
    turned.write_text("\n".join(",".join(row.split(",")[::-1]) for row in (header, *rows[::-1])))
    one, other = read_kinematics(file), read_kinematics(turned)
    np.testing.assert_array_equal(one.velocity, other.velocity)
    np.testing.assert_array_equal(one.pressure_pa, other.pressure_pa)


def test_files_that_are_no_kinematics_are_refused(file: Path, tmp_path: Path) -> None:
    header, *rows = file.read_text().splitlines()
    cells = rows[0].split(",")
    first = {
        "not a number": [*cells[:3], "fast", *cells[4:]],
        "no velocity of water": [*cells[:3], "1e4", *cells[4:]],
        "depends on the height": [*cells[:2], "9", *cells[3:]],
        "no acceleration of water .got nan": [*cells[:5], "nan", *cells[6:]],
        "no pressure of water .got nan": [*cells[:7], "nan"],
    }
    wrong = {message: [header, ",".join(row), *rows[1:]] for message, row in first.items()}
    wrong["columns are missing"] = [header.replace("velocity_m_s", "speed"), *rows]
    wrong["do not form a grid"] = [header, *rows[:-1]]
    wrong["no rows"] = [header]
    wrong["a gap after 0 s"] = [header, *rows[:85], *rows[85 * 25 :]]
    for message, lines in wrong.items():
        path = tmp_path / "wrong.csv"
        path.write_text("\n".join(lines))
        with pytest.raises(InputError, match=message) as refused:
            read_kinematics(path)
        assert (refused.value.file, refused.value.field) == (path, "file")


def test_ends_need_a_pressure(file: Path, tmp_path: Path) -> None:
    lines = [",".join(line.split(",")[:-1]) for line in file.read_text().splitlines()]
    path = tmp_path / "without.csv"
    path.write_text("\n".join(lines))
    waves = TravellingKinematics(read_kinematics(path), T, 15.0, 0.0, RHO)
    with pytest.raises(InputError, match="pressure on the ends"):
        waves.pressure(np.zeros((1, 3)), np.zeros(1))
