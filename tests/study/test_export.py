"""NetCDF written row by row reads back whole, whatever the sets and channels are."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import netcdf_file

from jackettwin.files import Streamed
from jackettwin.study.many_records.export import export_modes


def mode(k: int, names: Sequence[str]) -> dict[str, Any]:
    return {
        "status": "not a mode: electrical" if k == 1 else "ok",
        "frequency_hz": k + 0.5,
        "frequency_std_hz": None,
        "damping_ratio": 0.01,
        "damping_ratio_std": 0.001,
        "frequency_interval_90": (k + 0.4, k + 0.6),
        "damping_ratio_interval_90": None,
        "mode_shape": {name: [float(k + i), -1.0] for i, name in enumerate(names)},
    }


def document(names: Sequence[str], n_records: int) -> dict[str, Any]:
    def records() -> Iterator[dict[str, Any]]:
        for i in range(n_records):
            yield {"records": ["r" * (1 + i % 4)], "modes": [mode(k, names) for k in range(3)]}

    return {"modes": [mode(7, names[:1])], "groups": [], "records": Streamed(records)}


@pytest.mark.parametrize("names", [["a"], ["a", "bö", "c"]])
def test_netcdf_holds_every_mode_of_every_set(names: list[str], tmp_path: Path) -> None:
    export_modes(document(names, 5), tmp_path / "m.nc")
    with netcdf_file(str(tmp_path / "m.nc"), mmap=False) as file:
        v = {name: variable[:] for name, variable in file.variables.items()}
        assert file.variables["frequency_hz"].units == b"Hz"
    assert v["frequency_hz"].tolist() == [7.5, *[0.5, 1.5, 2.5] * 5]
    assert np.isnan(v["frequency_std_hz"]).all()
    sets = [b"".join(text).decode().strip() for text in v["set"]]
    assert sets == ["fused", *(name for name in ("r", "rr", "rrr", "rrrr", "r") for _ in range(3))]
    statuses = [b"".join(text).decode().strip() for text in v["status"]]
    assert statuses == ["ok", *["ok", "not a mode: electrical", "ok"] * 5]
    assert [b"".join(text).decode().strip() for text in v["channel_name"]] == names
    assert np.isnan(v["mode_shape_real"][0, 1:]).all()
    assert v["mode_shape_real"][3].tolist() == [2.0 + i for i in range(len(names))]
    assert np.all(v["mode_shape_imag"][1:] == -1.0)


def test_netcdf_without_any_mode(tmp_path: Path) -> None:
    export_modes({"modes": [], "groups": [], "records": []}, tmp_path / "m.nc")
    with netcdf_file(str(tmp_path / "m.nc"), mmap=False) as file:
        assert file.variables["frequency_hz"].shape == (0,)


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_memory_does_not_grow_with_the_records(ending: str, tmp_path: Path) -> None:
    """A table of 80 records is 170 kB in memory at least; what is held is the same for 5 and for 80."""
    names = [f"c{i}" for i in range(40)]
    peaks = []
    for n in (5, 80):
        export_modes(document(names, 2), tmp_path / f"m{ending}")
        tracemalloc.start()
        export_modes(document(names, n), tmp_path / f"m{ending}")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # a quarter of the table's size
    assert peaks[1] < peaks[0] + 40_000
