"""Shapes in UFF: what other programs find at the columns that SDRC's description names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.study.many_records.export import export_modes


def document() -> dict[str, Any]:
    skew = [np.sqrt(0.5), np.sqrt(0.5), 0.0]
    return {
        "channels": {
            "top_x": {"quantity": "acceleration", "height_m": 144.0, "node": None, "direction": [1, 0, 0]},
            "top_d": {"quantity": "acceleration", "height_m": 144.0, "node": None, "direction": skew},
            "low_y": {"quantity": "acceleration", "height_m": 41.0, "node": None, "direction": [0, 2, 0]},
            "gauge": {"quantity": "strain", "height_m": 10.0, "node": None, "direction": [0, 0, 1]},
        },
        "modes": [
            {
                "status": "ok",
                "frequency_hz": 0.3125,
                "damping_ratio": 0.02,
                "mode_shape": {"top_x": [1.0, 0.0], "top_d": [np.sqrt(0.5), 0.5], "low_y": [0.25, -0.125]},
            }
        ],
    }


def blocks(path: Path) -> dict[int, list[str]]:
    """Return the lines of each data set by its number."""
    parts = path.read_text("ascii").split("    -1\n")
    return {int(p.splitlines()[0]): p.splitlines()[1:] for p in parts if p.strip()}


def columns(line: str, width: int = 13) -> list[float]:
    return [float(line[at : at + width]) for at in range(0, len(line), width)]


def test_places_are_nodes_and_readings_their_translations(tmp_path: Path) -> None:
    export_modes(document(), tmp_path / "m.uff")
    found = blocks(tmp_path / "m.uff")
    assert sorted(found) == [15, 55, 164]
    assert [int(line[:10]) for line in found[15]] == [1, 2]
    assert [columns(line[40:])[2] for line in found[15]] == [144.0, 41.0]
    header, mode = found[55][5:8], found[55][8:]
    assert [int(header[0][at : at + 10]) for at in range(0, 60, 10)] == [1, 3, 2, 12, 5, 3]
    pole = complex(*columns(header[2])[:2])
    assert abs(pole) == pytest.approx(2.0 * np.pi * 0.3125, rel=1e-5)  # five digits are written
    assert -pole.real / abs(pole) == pytest.approx(0.02, rel=1e-5)
    assert [int(line) for line in mode[::2]] == [1, 2]
    # √½ (x + y) is read as √½ + 0.5i where x is 1: y is √½ i
    np.testing.assert_allclose(columns(mode[1]), [1.0, 0.0, 0.0, np.sqrt(0.5), 0.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(columns(mode[3]), [0.0, 0.0, 0.25, -0.125, 0.0, 0.0], atol=1e-5)


def test_shapes_without_directions_are_refused(tmp_path: Path) -> None:
    lost = document()
    for about in lost["channels"].values():
        about["direction"] = [0, 0, 0]
    with pytest.raises(InputError, match=r"in which direction.*top_x"):
        export_modes(lost, tmp_path / "m.uff")
